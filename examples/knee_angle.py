#!/usr/bin/env python3
"""knee_angle.py DATA.h5 [FIGURE.png]: finds the 3D poses of a recording and plots how far its people bend their knees.

DATA.h5 is a dataset of `canonpose import`, or already solved by `canonpose solve`. Needs python3-matplotlib.
"""
import sys

import matplotlib.pyplot as plt

import canonpose

data = canonpose.read_dataset(sys.argv[1])
is_solved = any(view.solved for sequence in data.sequences.values() for view in sequence.cameras.values())
scenes = canonpose.scenes_of(data) if is_solved else canonpose.solve(data).scenes

figure, axes = plt.subplots(len(scenes), squeeze=False, figsize=(8, 3 * len(scenes)), constrained_layout=True)
for axis, scene in zip(axes[:, 0], scenes):
    for person in scene.people:
        if person.fps:
            person = canonpose.filtered(person, cutoff_hz=min(6, 0.4 * person.fps), longest_gap_seconds=0.2)
        angles = canonpose.analyse(person).angles
        axis.plot(person.time, angles["knee_angle_l"], color="#0072B2", label=f"{person.name} left")
        axis.plot(person.time, angles["knee_angle_r"], color="#D55E00", label=f"{person.name} right")
    axis.set(title=scene.name, xlabel="time (s)", ylabel="knee angle (degrees)")
    axis.legend(frameon=False)
if len(sys.argv) > 2:
    figure.savefig(sys.argv[2], dpi=150)
else:
    plt.show()
