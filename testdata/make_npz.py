#!/usr/bin/env python3
"""Makes npz/*.npz: archives as NumPy itself writes them, with types that the reader takes and types that it refuses."""
import pathlib

import numpy as np

folder = pathlib.Path(__file__).parent / "npz"
folder.mkdir(exist_ok=True)
values = np.arange(6).reshape(2, 3)
arrays = {
    "f4": values.astype("<f4"),
    "f8": values.astype("<f8"),
    "i4": values.astype("<i4"),
    "i8": values.astype("<i8"),
    "fortran": np.asfortranarray(values.astype("<f4")),
    "text": np.array(["Hip", "Fuß"]),
    "bytes": np.array([b"Hip", b"Foot"]),
    "scalar": np.array("mm"),
    "objects": np.array([{"a": 1}, None], dtype=object),
    "big_endian": values.astype(">f4"),
    "half": values.astype("<f2"),
    "records": np.zeros(2, dtype=[("x", "<f4"), ("y", "<f4")]),
}
np.savez(folder / "numpy.npz", **arrays)
np.savez_compressed(folder / "numpy_compressed.npz", **arrays)
