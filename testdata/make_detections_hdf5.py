#!/usr/bin/env python3
"""Adds the HDF5 files to testdata/detections: DeepLabCut's by pandas, as DeepLabCut writes them, and SLEAP's by h5py.

Needs pandas, PyTables and h5py (Debian: python3-pandas python3-tables python3-h5py). Run it after make_detections.py, which
removes them; the files are committed. SLEAP's has the arrays that its documentation lists.
"""
import warnings

import h5py
import numpy as np
import pandas as pd

from make_detections import COCO_17, FRAMES, NAMED_17, OUT, SCORER, by_track, deeplabcut_rows

# From the nose out, as someone might draw it in SLEAP.
EDGES = [(0, 1), (0, 2), (1, 3), (2, 4), (0, 5), (0, 6), (5, 7), (6, 8), (7, 9), (8, 10), (5, 11), (6, 12), (11, 13), (12, 14),
         (13, 15), (14, 16)]


def write_deeplabcut(folder, form):
    for camera in range(2):
        header, rows = deeplabcut_rows(camera)
        names = [row[0] for row in header]
        columns = pd.MultiIndex.from_tuples(list(zip(*(row[1:] for row in header))), names=names)
        values = [[np.nan if v == "" else v for v in row[1:]] for row in rows]
        frame = pd.DataFrame(values, columns=columns, dtype=float)
        path = OUT / folder / f"cam{camera + 1}{SCORER}.h5"
        path.parent.mkdir(parents=True, exist_ok=True)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # Without an index for searching, which makes the small files large.
            options = {"format": "table", "index": False} if form == "table" else {}
            frame.to_hdf(path, key="df_with_missing", mode="w", **options)


def write_sleap(folder, standard):
    for camera in range(2):
        points = np.full((2, 2, 17, FRAMES), np.nan)
        scores = np.full((2, 17, FRAMES), np.nan)
        for t in range(FRAMES):
            for track, joints in by_track(camera, t).items():
                for k, name in enumerate(COCO_17):
                    x, y, c = joints[name]
                    if c > 0:
                        points[track - 1, :, k, t] = x, y
                        scores[track - 1, k, t] = c
        path = OUT / folder / f"cam{camera + 1}.analysis.h5"
        path.parent.mkdir(parents=True, exist_ok=True)
        with h5py.File(path, "w") as file:
            axes = (3, 0, 2, 1) if standard else (0, 1, 2, 3)
            file.create_dataset("tracks", data=points.transpose(axes), compression="gzip")
            score_axes = (2, 0, 1) if standard else (0, 1, 2)
            file.create_dataset("point_scores", data=scores.transpose(score_axes), compression="gzip")
            file["track_occupancy"] = (~np.isnan(points[:, 0]).all(axis=1)).T.astype(np.uint8)
            if standard:
                text = h5py.string_dtype()
                file.create_dataset("node_names", data=NAMED_17, dtype=text)
                file.create_dataset("track_names", data=["a", "b"], dtype=text)
                file.attrs["preset"] = "standard"
            else:
                file["node_names"] = [np.string_(name) for name in NAMED_17]
                file["track_names"] = [np.string_("a"), np.string_("b")]
                file["edge_inds"] = EDGES
                file["edge_names"] = [[np.string_(NAMED_17[i]) for i in edge] for edge in EDGES]


def main():
    write_deeplabcut("deeplabcut_table", "table")
    write_deeplabcut("deeplabcut_fixed", "fixed")
    write_sleap("sleap", False)
    write_sleap("sleap_standard", True)


if __name__ == "__main__":
    main()
