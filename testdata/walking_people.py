"""People who walk, as made-up motion capture for the scripts beside this one: joints by name, millimetres, z up, exact bone lengths."""
import numpy as np

SIDES = {"left": 1.0, "right": -1.0}


def turn(axis, angle):
    """Rotation matrices (T, 3, 3) about a coordinate axis by angles (T)."""
    c, s, matrices = np.cos(angle), np.sin(angle), np.zeros((len(angle), 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrices[:, axis, axis] = 1
    matrices[:, i, i], matrices[:, j, j], matrices[:, j, i], matrices[:, i, j] = c, c, s, -s
    return matrices


def walk(frames, stature=1750.0, phase=0.0, speed=0.12, radius=800.0):
    """{joint: (frames, 3)} of somebody who walks in a circle of a radius about the origin. x forward, y left in the body's own frame."""
    t = phase + speed * np.arange(frames)
    unit = stature / 1750.0
    heading = turn(2, 0.15 * t + np.pi / 2)
    centre = np.stack([radius * np.cos(0.15 * t), radius * np.sin(0.15 * t), 930 * unit + 15 * np.abs(np.sin(t))], 1)
    joints = {}

    def place(name, parent, offset, rotation):
        start = joints[parent] if parent else centre
        joints[name] = start + np.einsum("tij,j->ti", rotation, unit * np.array(offset, float))

    lean = heading @ turn(1, 0.08 + 0.04 * np.sin(2 * t))
    twist = lean @ turn(2, 0.12 * np.sin(t))
    place("pelvis", None, (0, 0, 0), heading)
    place("spine4", "pelvis", (0, 0, 110), lean)
    place("spine", "spine4", (0, 0, 120), lean)
    place("spine2", "spine", (0, 0, 110), twist)
    place("spine3", "spine2", (0, 0, 90), twist)
    place("neck", "spine3", (0, 0, 60), twist)
    place("nose", "neck", (90, 0, 110), twist)
    place("head", "neck", (20, 0, 110), twist)
    place("head_top", "head", (0, 0, 120), twist)
    for side, sign in SIDES.items():
        swing = sign * np.sin(t)
        place(f"{side}_clavicle", "spine3", (0, 40 * sign, 20), twist)
        place(f"{side}_shoulder", "spine3", (0, 180 * sign, 10), twist)
        upper = twist @ turn(1, 0.5 * swing) @ turn(0, np.full(frames, 0.15 * sign))
        lower = upper @ turn(1, -0.5 - 0.2 * swing)
        place(f"{side}_elbow", f"{side}_shoulder", (0, 0, -290), upper)
        place(f"{side}_wrist", f"{side}_elbow", (0, 0, -250), lower)
        place(f"{side}_hand", f"{side}_wrist", (0, 0, -80), lower)
        place(f"{side}_hip", "pelvis", (0, 120 * sign, 0), heading)
        thigh = heading @ turn(1, -0.45 * swing)
        shank = thigh @ turn(1, 0.35 + 0.35 * np.sin(t + sign * np.pi / 2 + 0.6))
        place(f"{side}_knee", f"{side}_hip", (0, 0, -440), thigh)
        place(f"{side}_ankle", f"{side}_knee", (0, 0, -430), shank)
        place(f"{side}_foot", f"{side}_ankle", (130, 0, -60), shank)
        place(f"{side}_toe", f"{side}_foot", (60, 0, 0), shank)
    return joints


def stack(joints, names):
    """(T, J, 3) of joints by name."""
    return np.stack([joints[name] for name in names], 1)


def look_at(position, target=(0.0, 0.0, 900.0)):
    """Rotation R (3, 3) and translation t (3) with x_camera = R x_world + t: x right, y down, z forward."""
    position, target = np.array(position, float), np.array(target, float)
    forward = (target - position) / np.linalg.norm(target - position)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return rotation, -rotation @ position
