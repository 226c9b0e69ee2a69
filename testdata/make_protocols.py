#!/usr/bin/env python3
"""Makes protocols/: a small dataset for each benchmark's protocol, with `solved` poses that differ from `truth`, and expected.json: every
figure of every protocol, computed here by NumPy alone from its definition, not from the program.

Frames that a protocol does not evaluate hold poses so wrong that a single one of them, once counted, changes every figure.
"""
import json
import pathlib

import h5py
import numpy as np

FOLDER = pathlib.Path(__file__).parent / "protocols"
RNG = np.random.default_rng(20211)

# name, parent, mirror partner, position of a person who stands upright (mm, camera frame: x right, y down, z forward)
HUMAN = [("Hip", None, "Hip", (0, 0, 0)),
         ("RHip", "Hip", "LHip", (-130, 0, 0)), ("RKnee", "RHip", "LKnee", (-135, 440, 20)), ("RFoot", "RKnee", "LFoot", (-140, 880, 60)),
         ("LHip", "Hip", "RHip", (130, 0, 0)), ("LKnee", "LHip", "RKnee", (135, 440, 10)), ("LFoot", "LKnee", "RFoot", (140, 880, 70)),
         ("Spine", "Hip", "Spine", (0, -240, 10)), ("Thorax", "Spine", "Thorax", (0, -490, 20)), ("Nose", "Thorax", "Nose", (0, -590, -90)),
         ("Head", "Nose", "Head", (0, -690, -20)),
         ("LShoulder", "Thorax", "RShoulder", (150, -470, 20)), ("LElbow", "LShoulder", "RElbow", (210, -200, 30)),
         ("LWrist", "LElbow", "RWrist", (230, 30, -60)),
         ("RShoulder", "Thorax", "LShoulder", (-150, -470, 20)), ("RElbow", "RShoulder", "LElbow", (-210, -200, 40)),
         ("RWrist", "RElbow", "LWrist", (-230, 30, -40))]
# The 17 joints of the test set of MPI-INF-3DHP, in its order.
INF = [("head_top", "head", "head_top", (0, -700, 0)), ("neck", "spine", "neck", (0, -500, 20)),
       ("right_shoulder", "neck", "left_shoulder", (-150, -470, 20)), ("right_elbow", "right_shoulder", "left_elbow", (-210, -200, 40)),
       ("right_wrist", "right_elbow", "left_wrist", (-230, 30, -40)),
       ("left_shoulder", "neck", "right_shoulder", (150, -470, 20)), ("left_elbow", "left_shoulder", "right_elbow", (210, -200, 30)),
       ("left_wrist", "left_elbow", "right_wrist", (230, 30, -60)),
       ("right_hip", "pelvis", "left_hip", (-130, 0, 0)), ("right_knee", "right_hip", "left_knee", (-135, 440, 20)),
       ("right_ankle", "right_knee", "left_ankle", (-140, 880, 60)),
       ("left_hip", "pelvis", "right_hip", (130, 0, 0)), ("left_knee", "left_hip", "right_knee", (135, 440, 10)),
       ("left_ankle", "left_knee", "right_ankle", (140, 880, 70)),
       ("pelvis", None, "pelvis", (0, 0, 0)), ("spine", "pelvis", "spine", (0, -240, 10)), ("head", "neck", "head", (0, -600, -30))]
INF_ACTIVITIES = ["Standing/Walking", "Exercising", "Sitting", "Reaching/Crouching", "On The Floor", "Sports", "Miscellaneous"]


# ------------------------------------------------------------------------------------------------------------------------------ data

def random_rotation():
    q, r = np.linalg.qr(RNG.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def make_view(skeleton, frame_count, evaluated):
    """truth and solved (T, J, 3) of one camera; the frames not in `evaluated` are traps."""
    joints = len(skeleton)
    upright = np.array([joint[3] for joint in skeleton], dtype=np.float64)
    truth = np.tile(upright + [0, 0, 4000], (frame_count, 1, 1))
    solved = np.tile(upright[::-1], (frame_count, 1, 1)).copy()  # a trap: joints exchanged
    for t in evaluated:
        truth[t] = (upright + RNG.normal(0, 60, (joints, 3))) @ random_rotation().T + [100 * RNG.normal(), 0, 4000]
        noise_mm = RNG.uniform(5, 120)
        solved[t] = RNG.uniform(0.002, 0.02) * (truth[t] + RNG.normal(0, noise_mm, (joints, 3)))
    return truth, solved


def spoil(truth, solved, frames, root):
    """Of the given frames: one is mirrored in depth, one not solved, one lacks a joint's truth, one nearly all of it."""
    mirrored, missing, partial, unusable = frames
    solved[mirrored, :, 2] *= -1
    solved[missing] = np.nan
    truth[partial, (root + 3) % truth.shape[1]] = np.nan
    truth[unusable, np.arange(truth.shape[1]) % 3 != 0] = np.nan


def timeless(properties):
    """HDF5 notes when a group was made; without that the same data have the same bits."""
    properties.set_obj_track_times(False)
    return properties


def create_group(parent, name):
    return h5py.Group(h5py.h5g.create(parent.id, name.encode(), gcpl=timeless(h5py.h5p.create(h5py.h5p.GROUP_CREATE))))


def create_file(path):
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_libver_bounds(h5py.h5f.LIBVER_LATEST, h5py.h5f.LIBVER_LATEST)
    return h5py.File(h5py.h5f.create(str(path).encode(), fcpl=timeless(h5py.h5p.create(h5py.h5p.FILE_CREATE)), fapl=access))


def write(path, skeleton, sequences):
    """sequences: dictionaries of name, subject, static, actions, action (T) or None, truth_kind or None, cameras {name: (truth, solved)}."""
    names = [joint[0] for joint in skeleton]
    with create_file(path) as file:
        file.attrs["format"] = "canonpose-dataset"
        file.attrs["version"] = 1
        group = create_group(file, "skeleton")
        group.attrs["joints"] = names
        group.attrs["parents"] = [-1 if joint[1] is None else names.index(joint[1]) for joint in skeleton]
        group.attrs["root"] = root_of(skeleton)
        group.attrs["mirror"] = [names.index(joint[2]) for joint in skeleton]
        all_sequences = create_group(file, "sequences")
        for sequence in sequences:
            group = create_group(all_sequences, sequence["name"])
            group.attrs["subject"] = sequence["subject"]
            group.attrs["fps"] = 50.0
            group.attrs["static_cameras"] = sequence["static"]
            if sequence["actions"]:
                group.attrs["actions"] = sequence["actions"]
            if sequence["action"] is not None:
                group.create_dataset("action", data=sequence["action"].astype(np.uint8), compression=9)
            if sequence["truth_kind"]:
                group.attrs["truth_kind"] = sequence["truth_kind"]
            cameras = create_group(group, "cameras")
            for name, (truth, solved) in sequence["cameras"].items():
                camera = create_group(cameras, name)
                camera.attrs["image_size"] = [1000, 1000]
                frames, joints = truth.shape[:2]
                for key, values in [("keypoints", np.full((frames, joints, 2), 500)), ("confidence", np.ones((frames, joints))),
                                    ("truth", truth), ("solved", solved)]:
                    camera.create_dataset(key, data=values.astype(np.float32), chunks=values.shape, compression=9)


def root_of(skeleton):
    return next(i for i, joint in enumerate(skeleton) if joint[1] is None)


def make_h36m():
    # name, subject, frames, actions, the action of each frame
    recorded = [("S1_Walking", "S1", 70, ["Walking"], None), ("S9_Walking_1", "S9", 200, ["Walking 1"], None),
                ("S9_Walking", "S9", 130, ["Walking"], None), ("S9_Eating", "S9", 70, ["Eating 1"], None),
                ("S11_both", "S11", 193, ["Eating", "Sitting"], lambda t: t >= 100), ("S11_Sitting", "S11", 65, ["Sitting"], None)]
    sequences = []
    for name, subject, frames, actions, action in recorded:
        cameras = {}
        for camera in ["54138969", "55011271"]:
            cameras[camera] = make_view(HUMAN, frames, range(0, frames, 64) if subject != "S1" else [])
        if name == "S9_Walking_1":
            spoil(*cameras["54138969"], [0, 64, 128, 192], 0)
        sequences.append({"name": name, "subject": subject, "static": 1, "actions": actions, "truth_kind": None, "cameras": cameras,
                          "action": None if action is None else action(np.arange(frames))})
    return HUMAN, sequences


def make_3dhp():
    sequences = []
    for name, frames in [("TS1", 40), ("TS2", 14)]:
        truth, solved = make_view(INF, frames, range(frames))
        truth[::3] = np.nan  # not a valid frame
        if name == "TS1":
            spoil(truth, solved, [1, 4, 7, 10], root_of(INF))
        sequences.append({"name": name, "subject": name, "static": 1, "actions": INF_ACTIVITIES, "truth_kind": "univ_annot3",
                          "cameras": {"camera": (truth, solved)}, "action": RNG.integers(0, 5, frames)})
    return INF, sequences


def make_skipose():
    sequences = []
    for name, frames in [("test_5", 12), ("test_6", 5)]:
        cameras = {f"cam{c}": make_view(HUMAN, frames, range(frames)) for c in range(3)}
        if name == "test_5":
            spoil(*cameras["cam1"], [2, 3, 5, 8], 0)
        sequences.append({"name": name, "subject": "S5", "static": 0, "actions": [], "action": None, "truth_kind": None, "cameras": cameras})
    return HUMAN, sequences


# --------------------------------------------------------------------------------------------------------------------------- figures

def scaled_errors(P, G):
    """Both centred on the root; (J,) after the best single factor."""
    return np.linalg.norm(P * np.sum(P * G) / np.sum(P * P) - G, axis=1)


def aligned_errors(P, G):
    """(J,) after Procrustes alignment: the rotation from the singular value decomposition, its determinant kept at +1."""
    p, g = P - P.mean(0), G - G.mean(0)
    U, S, Vt = np.linalg.svd(p.T @ g)
    if np.linalg.det(U @ Vt) < 0:
        U[:, -1], S[-1] = -U[:, -1], -S[-1]
    return np.linalg.norm(S.sum() / np.sum(p * p) * p @ (U @ Vt) - g, axis=1)


def pose_errors(predicted, truth, root):
    """scaled (J,), aligned (J,), mirrored of one pose; a word where there are none."""
    known = np.isfinite(truth).all(1)
    if not known[root] or known.sum() < max((len(known) + 1) // 2, 4):
        return "unusable"
    if not np.isfinite(predicted[known]).all():
        return "missing"
    P, G = (predicted - predicted[root])[known], (truth - truth[root])[known]
    scaled, aligned = np.full(len(known), np.nan), np.full(len(known), np.nan)
    scaled[known], aligned[known] = scaled_errors(P, G), aligned_errors(P, G)
    return scaled, aligned, aligned_errors(P * [1, 1, -1], G).mean() < aligned[known].mean()


def figures(poses, counted):
    """poses: (scaled, aligned) of each; counted: the joints of PCK and AUC."""
    scaled, aligned = np.array([pose[0] for pose in poses]), np.array([pose[1] for pose in poses])
    some = scaled[:, counted]
    some = some[np.isfinite(some)]
    largest = np.nanmax(aligned, axis=1)
    return {"n_mpjpe_mm": np.nanmean(scaled), "p_mpjpe_mm": np.nanmean(aligned), "pck150_percent": 100 * np.mean(some < 150),
            "auc_percent": 100 * np.mean([np.mean(some < threshold) for threshold in range(0, 151, 5)]),
            "cps": np.mean(np.clip(300 - largest, 0, None)),
            "cps_curve": np.array([100 * np.mean(largest < threshold) for threshold in range(1, 301)]),
            "pck_curve": np.array([100 * np.mean(some < threshold) for threshold in range(1, 301)]),
            "joints": np.stack([np.nanmean(scaled, axis=0), np.nanmean(aligned, axis=0)], axis=1)}


def mean_of(groups):
    groups = list(groups)
    return {key: np.mean([group[key] for group in groups], axis=0) for key in groups[0]}


def two(values):
    return {"n_mpjpe_mm": values["n_mpjpe_mm"], "p_mpjpe_mm": values["p_mpjpe_mm"]}


def expected(skeleton, sequences, subjects=None, step=1, pck=None, by_action=False):
    names, root = [joint[0] for joint in skeleton], root_of(skeleton)
    poses, outcomes, mirrored = [], {"missing": 0, "unusable": 0}, 0
    for sequence in sequences:
        if subjects and sequence["subject"] not in subjects:
            continue
        for truth, solved in sequence["cameras"].values():
            truth, solved = (values.astype(np.float32).astype(np.float64) for values in (truth, solved))
            for t in range(0, len(truth), step):
                errors = pose_errors(solved[t], truth[t], root)
                if isinstance(errors, str):
                    outcomes[errors] += 1
                    continue
                action = ""
                if sequence["actions"]:
                    action = sequence["actions"][0 if sequence["action"] is None else int(sequence["action"][t])]
                if by_action and action.rpartition(" ")[2].isdigit():
                    action = action.rpartition(" ")[0]
                mirrored += bool(errors[2])
                poses.append((errors[0], errors[1], sequence["name"], action))
    counted = [names.index(name) for name in pck] if pck else range(len(names))
    groups = lambda column: {key: figures([pose for pose in poses if pose[column] == key], counted)
                             for key in sorted({pose[column] for pose in poses} - {""})}
    by_pose, actions = figures(poses, counted), groups(3)
    result = dict(mean_of(actions.values()) if by_action else by_pose)
    joints = result.pop("joints")
    result |= {"frames": len(poses), "missing_predictions": outcomes["missing"], "unusable_truths": outcomes["unusable"],
               "mirrored_percent": 100 * mirrored / len(poses), "cps_curve": list(result["cps_curve"]), "pck_curve": list(result["pck_curve"]),
               "per_sequence": {key: two(values) for key, values in groups(2).items()},
               "per_joint": {name: {"n_mpjpe_mm": row[0], "p_mpjpe_mm": row[1]} for name, row in zip(names, joints)}}
    if actions:
        result["per_action"] = {key: two(values) for key, values in actions.items()}
    if by_action:
        result["by_pose"] = {key: by_pose[key] for key in ["n_mpjpe_mm", "p_mpjpe_mm", "pck150_percent", "auc_percent", "cps"]}
    return result


def rounded(value):
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return round(float(value), 5) if isinstance(value, float) else value


def main():
    FOLDER.mkdir(exist_ok=True)
    data = {"h36m": make_h36m(), "3dhp": make_3dhp(), "skipose": make_skipose()}
    for name, (skeleton, sequences) in data.items():
        write(FOLDER / f"{name}.h5", skeleton, sequences)
    human = expected(*data["h36m"], subjects=["S9", "S11"], step=64, by_action=True)
    inf_joints = [joint[0] for joint in INF if joint[0] not in ("pelvis", "spine", "head")]
    cases = [("h36m.h5", "h36m-1", human), ("h36m.h5", "h36m-2", human), ("h36m.h5", "all-frames", expected(*data["h36m"])),
             ("3dhp.h5", "3dhp", expected(*data["3dhp"], pck=inf_joints)), ("3dhp.h5", "all-frames", expected(*data["3dhp"])),
             ("skipose.h5", "skipose", expected(*data["skipose"])), ("skipose.h5", "all-frames", expected(*data["skipose"]))]
    text = json.dumps([{"file": file, "protocol": protocol, "figures": rounded(figures)} for file, protocol, figures in cases])
    (FOLDER / "expected.json").write_text(text.replace('{"file"', '\n{"file"') + "\n")


if __name__ == "__main__":
    main()
