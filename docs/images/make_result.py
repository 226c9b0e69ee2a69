#!/usr/bin/env python3
"""Draws docs/images/result.png, the picture of docs/solve.md: keypoints of each camera, and what `solve` makes of them.

usage: docs/images/make_result.py FOLDER [--frame N] [--output FILE] [--program FILE]

FOLDER is a recording: one subfolder of OpenPose files per camera and, for the size of the images, calibration.json. The picture
there is frame 46 of the recording `balancing` of the Pose2Sim project (BSD-3). No calibration is used: `solve` finds the cameras.

Needs matplotlib, numpy and h5py (Debian: apt install python3-matplotlib python3-h5py).
"""
import argparse
import pathlib
import subprocess
import tempfile

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Circle, Ellipse, Polygon

PROJECT = pathlib.Path(__file__).resolve().parent.parent.parent
# Okabe and Ito's colours, which colour-blind readers can distinguish.
COLOURS = {"left": "#0072B2", "right": "#D55E00", "middle": "#444444"}
ELEVATION_DEG = 14.0  # of the 3D views above the horizon
TURN_DEG = 45  # from the first 3D view to the second, counterclockwise seen from above
HEAD_RADIUS = 0.02  # in units of the sum of all bone lengths


def solve(program, folder, work):
    """Imports and solves the recording; returns the solved dataset's path."""
    data, solved = work / "data.h5", work / "solved.h5"
    importing = [program, "import", "openpose", folder, "-o", data]
    calibration = folder / "calibration.json"
    if calibration.exists():
        importing += ["--calibration", calibration]
    for command in (importing, [program, "solve", data, "-o", solved, "--threads", "1"]):
        subprocess.run(list(map(str, command)), check=True, stdout=subprocess.DEVNULL)
    return solved


class Recording:
    """The first sequence of a solved dataset. `world` is the frame of the first camera at frame 0."""

    def __init__(self, path):
        with h5py.File(path) as file:
            skeleton = file["skeleton"].attrs
            self.joints = list(skeleton["joints"])
            self.parents, self.partners = skeleton["parents"], skeleton["mirror"]
            sequence = next(iter(file["sequences"].values()))
            self.keypoints, self.rotation, self.centre = {}, {}, {}
            for name, view in sequence["cameras"].items():
                self.keypoints[name] = view["keypoints"][:]  # (T, J, 2)
                if "solved_R" not in view:
                    continue
                rotation, translation = (view[key][:] for key in ("solved_R", "solved_t"))
                self.rotation[name] = rotation  # camera from world
                self.centre[name] = -rotation.T @ translation
                self.in_world = (view["solved"][:] - translation) @ rotation  # (T, J, 3); the same from every camera
        if self.rotation and next(iter(self.rotation.values())).ndim != 2:
            raise SystemExit("error: the cameras of this recording move; the picture is for static ones")

    def bones(self, points):
        """(joint, the joint it hangs from, colour) of every bone of `points` (J, 2 or 3); joints that were not seen are skipped."""
        seen = np.isfinite(points[:, 0])
        for joint, parent in enumerate(self.parents):
            while parent >= 0 and not seen[parent]:
                parent = self.parents[parent]
            if parent < 0 or not seen[joint]:
                continue
            side = {"L": "left", "R": "right"}[self.joints[joint][0]] if self.partners[joint] != joint else "middle"
            yield joint, parent, COLOURS[side]

    def up(self):
        """Which way is up: from feet to chest in the fifth of the frames in which people stand tallest."""
        index = self.joints.index
        trunk = self.in_world[:, index("Thorax")] - (self.in_world[:, index("LFoot")] + self.in_world[:, index("RFoot")]) / 2
        height = np.linalg.norm(trunk, axis=1)
        mean = trunk[height >= np.nanquantile(height, 0.8)].mean(axis=0)
        return mean / np.linalg.norm(mean)


def looking(forward, up):
    """Rows right, down, forward of a camera that looks along `forward`; the same handedness as x right, y down, z forward."""
    forward = forward / np.linalg.norm(forward)
    down = -(up - (up @ forward) * forward)
    down /= np.linalg.norm(down)
    return np.stack([np.cross(down, forward), down, forward])


def draw_skeleton(axes, recording, points, width):
    """`points` (J, 2 or 3) in the picture, x right, y down, and perhaps their depth: bones farther away are drawn first."""
    has_depth = points.shape[1] == 3
    joints = {name: points[i] for i, name in enumerate(recording.joints)}
    has_head = has_depth and "Nose" in joints and "Head" in joints
    for joint, parent, colour in recording.bones(points):
        if has_head and recording.joints[joint] == "Head":
            continue
        order = 3 - points[[joint, parent], 2].mean() if has_depth else 3
        axes.plot(*points[[joint, parent], :2].T, color=colour, linewidth=width, solid_capstyle="round", zorder=order)
    if has_head:
        middle = (joints["Nose"] + joints["Head"]) / 2
        axes.add_patch(Circle(middle[:2], HEAD_RADIUS, color=COLOURS["middle"], zorder=3 - middle[2]))
    if not has_depth:
        axes.scatter(*points.T, s=width * 5, color="white", edgecolor="#222222", linewidth=0.8, zorder=4)


def set_frame(axes, centre, half, title):
    """A square part of the picture, y down."""
    axes.set(xlim=(centre[0] - half, centre[0] + half), ylim=(centre[1] + half, centre[1] - half), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.set_title(title, fontsize=15, color="#222222")


def draw_view(axes, recording, name, frame):
    """What the detector found in one camera."""
    points = recording.keypoints[name][frame]
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    set_frame(axes, (low + high) / 2, 0.6 * max(high - low), name)
    axes.set_facecolor("#f3f3f3")
    for spine in axes.spines.values():
        spine.set_color("#999999")
    draw_skeleton(axes, recording, points, 2.6)


def draw_pose(axes, recording, frame, rotation, up, title):
    """The pose as a camera far away sees it, with its shadow on the ground."""
    pose = recording.in_world[frame]
    floor = np.nanmin(pose @ up) - 0.01
    shadow = pose - np.outer(pose @ up - floor, up)
    points, ground = pose @ rotation.T, shadow @ rotation.T
    middle = np.nanmean(ground, axis=0)
    radius = 0.24
    axes.add_patch(Ellipse(middle[:2], 2 * radius, 2 * radius * np.sin(np.radians(ELEVATION_DEG)), color="#f0f0f0", zorder=0))
    for joint, parent, _ in recording.bones(ground):
        axes.plot(*ground[[joint, parent], :2].T, color="#cccccc", linewidth=5, solid_capstyle="round", zorder=1)
    set_frame(axes, np.array([middle[0], middle[1] - 0.17]), radius + 0.01, title)
    draw_skeleton(axes, recording, points - [0, 0, middle[2]], 6)
    axes.axis("off")


def draw_plan(axes, recording, frame, rotation, title):
    """The person and the cameras from above, with what each camera looks at."""
    pose = recording.in_world[frame] @ rotation.T
    places = {name: (rotation @ centre)[:2] for name, centre in recording.centre.items()}
    everything = np.array([*places.values(), np.nanmean(pose, axis=0)[:2]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    half = 0.68 * max(high - low)
    set_frame(axes, (low + high) / 2 - [0, 0.04 * half], half, title)
    draw_skeleton(axes, recording, pose - [0, 0, np.nanmean(pose[:, 2])], 2.5)
    for name, place in places.items():
        along = (rotation @ recording.rotation[name][2])[:2]
        along /= np.linalg.norm(along)
        across = np.array([-along[1], along[0]])
        reach, size = 0.45 * half, 0.05 * half
        axes.add_patch(Polygon([place, place + reach * (along + 0.25 * across), place + reach * (along - 0.25 * across)], color="#eeeeee", zorder=0))
        corners = [place + size * (a * along + b * across) for a, b in ((-1.6, 0.8), (0, 0.8), (0, -0.8), (-1.6, -0.8))]
        axes.add_patch(Polygon(corners, color="#222222", zorder=2))
        axes.text(*(place - 0.27 * half * along), name, fontsize=13, ha="center", va="center", color="#222222")
    axes.axis("off")


def draw(recording, frame, output):
    cameras = list(recording.keypoints)[:4]
    if frame >= len(recording.in_world):
        raise SystemExit(f"error: --frame {frame}: the recording has {len(recording.in_world)} frames")
    up = recording.up()
    tilt = np.radians(ELEVATION_DEG)

    def from_side(name, turn_deg):
        """The direction of a camera, levelled, turned about the vertical and tilted down."""
        level = recording.rotation[name][2] - (recording.rotation[name][2] @ up) * up
        level /= np.linalg.norm(level)
        turn = np.radians(turn_deg)
        level = np.cos(turn) * level + np.sin(turn) * np.cross(up, level)
        return looking(np.cos(tilt) * level - np.sin(tilt) * up, up)

    figure = plt.figure(figsize=(16, 5.4))
    grid = figure.add_gridspec(2, 5, width_ratios=[0.45, 0.45, 1, 1, 1], wspace=0.08, hspace=0.22, left=0.008, right=0.995, top=0.82, bottom=0.02)
    for i, name in enumerate(cameras):
        draw_view(figure.add_subplot(grid[i // 2, i % 2]), recording, name, frame)
    reference = cameras[min(1, len(cameras) - 1)]
    draw_pose(figure.add_subplot(grid[:, 2]), recording, frame, from_side(reference, 0), up, f"seen from the direction of {reference}")
    draw_pose(figure.add_subplot(grid[:, 3]), recording, frame, from_side(reference, TURN_DEG), up, f"seen from {TURN_DEG}° to the right of {reference}")
    draw_plan(figure.add_subplot(grid[:, 4]), recording, frame, looking(-up, recording.rotation[reference][2]), "cameras and person from above")
    for x, text in ((0.125, "In: 2D keypoints"), (0.63, "Out: 3D pose and cameras, found without calibration")):
        figure.text(x, 0.94, text, ha="center", fontsize=20, color="#222222", weight="bold")
    for x, side in ((0.30, "left"), (0.38, "right")):
        figure.text(x, 0.03, f"{side} side", ha="center", fontsize=14, color=COLOURS[side], weight="bold")
    figure.savefig(output, dpi=100, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--frame", type=int, default=46)
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent / "result.png")
    parser.add_argument("--program", type=pathlib.Path, default=PROJECT / "build" / "canonpose")
    arguments = parser.parse_args()
    if not arguments.program.exists():
        raise SystemExit(f"error: {arguments.program}: expected the program; build it first with ./run-demo")
    with tempfile.TemporaryDirectory() as work:
        recording = Recording(solve(arguments.program, arguments.folder, pathlib.Path(work)))
    draw(recording, arguments.frame, arguments.output)


main()
