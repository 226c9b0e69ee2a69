#!/usr/bin/env python3
"""Makes benchmarks/: small files in the layouts of the field's benchmarks, written as their makers write them (NumPy's own
pickler, SciPy's MATLAB v5, HDF5), with people, cameras and numbers of our own, and beside them what importing must give.

The people walk in circles, with bones in millimetres; every camera sees them exactly. Needs numpy, scipy and h5py.
"""
import json
import os
import pathlib
import pickle
import shutil

import h5py
import numpy as np
import scipy.io

FOLDER = pathlib.Path(__file__).parent / "benchmarks"

# ------------------------------------------------------------------------------------------------------------ people


def unit(vector):
    return vector / np.linalg.norm(vector, axis=-1, keepdims=True)


def walk(frames, size, phase, centre=(0.0, 0.0), fps=25.0):
    """Joints by name, (frames, 3) mm, world z up: somebody of `size` times 1.75 m who walks in a circle."""
    t = np.arange(frames) / fps
    heading = phase + 0.8 * t
    zero, one = np.zeros(frames), np.ones(frames)
    forward = np.stack([np.cos(heading), np.sin(heading), zero], 1)
    up = np.stack([zero, zero, one], 1)
    right = np.cross(forward, up)
    stride = 2 * np.pi * 0.9 * t + phase

    def at(origin, r=0.0, u=0.0, f=0.0):
        column = lambda x: np.broadcast_to(x, (frames,))[:, None] * size
        return origin + column(r) * right + column(u) * up + column(f) * forward

    j = {}
    middle = np.stack([centre[0] + 900 * np.sin(heading), centre[1] - 900 * np.cos(heading), zero], 1)
    j["pelvis"] = at(middle, u=930 + 15 * np.cos(2 * stride))
    j["spine"] = at(j["pelvis"], u=230, f=25 + 5 * np.sin(stride))
    j["spine2"] = at(j["pelvis"], u=300, f=15)
    j["spine3"] = at(j["pelvis"], u=390, f=5)
    j["spine4"] = at(j["pelvis"], u=450, f=5)
    j["neck"] = at(j["pelvis"], u=500, f=10)
    j["head"] = at(j["neck"], u=105, f=70)
    j["nose"] = at(j["neck"], u=100, f=115)
    j["head_top"] = at(j["neck"], u=230, f=30)
    for side, sign in (("right", 1.0), ("left", -1.0)):
        swing = 0.45 * sign * np.sin(stride)
        bend = 0.25 + 0.35 * (1 - sign * np.cos(stride))
        hip = j[f"{side}_hip"] = at(j["pelvis"], r=sign * 120, u=-20)
        knee = j[f"{side}_knee"] = at(hip, u=-445 * np.cos(swing), f=445 * np.sin(swing))
        ankle = j[f"{side}_ankle"] = at(knee, u=-430 * np.cos(swing - bend), f=430 * np.sin(swing - bend))
        foot = j[f"{side}_foot"] = at(ankle, u=-60, f=110)
        j[f"{side}_toe"] = at(foot, u=-10, f=60)
        j[f"{side}_clavicle"] = at(j["neck"], r=sign * 20, u=-30)
        shoulder = j[f"{side}_shoulder"] = at(j["neck"], r=sign * 175, u=-45)
        arm = -0.5 * sign * np.sin(stride)
        elbow = j[f"{side}_elbow"] = at(shoulder, r=sign * 40, u=-285 * np.cos(arm), f=285 * np.sin(arm))
        wrist = j[f"{side}_wrist"] = at(elbow, r=sign * 5, u=-250 * np.cos(arm + 0.7), f=250 * np.sin(arm + 0.7))
        j[f"{side}_hand"] = at(wrist, u=-60, f=50)
    return j


H36M_17 = ["pelvis", "right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle", "spine", "neck", "nose", "head_top",
           "left_shoulder", "left_elbow", "left_wrist", "right_shoulder", "right_elbow", "right_wrist"]
# In Human3.6M's form for MPI-INF-3DHP the head's centre stands where the nose is.
MPI_AS_H36M = ["head" if name == "nose" else name for name in H36M_17]
H36M_KEPT = [0, 1, 2, 3, 6, 7, 8, 12, 13, 14, 15, 17, 18, 19, 25, 26, 27]
CANONPOSE_16 = ["right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle", "pelvis", "neck", "nose", "head_top",
                "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist"]
MPII_16 = ["right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle", "pelvis", "neck", "nose", "head_top",
           "right_wrist", "right_elbow", "right_shoulder", "left_shoulder", "left_elbow", "left_wrist"]
SIDE = ["clavicle", "shoulder", "elbow", "wrist", "hand"]
LEG = ["hip", "knee", "ankle", "foot", "toe"]
MPI_28 = (["spine3", "spine4", "spine2", "spine", "pelvis", "neck", "head", "head_top"] + [f"left_{x}" for x in SIDE] +
          [f"right_{x}" for x in SIDE] + [f"left_{x}" for x in LEG] + [f"right_{x}" for x in LEG])
MPI_17 = [MPI_28[i] for i in (7, 5, 14, 15, 16, 9, 10, 11, 23, 24, 25, 18, 19, 20, 4, 3, 6)]


def stack(joints, names):
    return np.stack([joints[name] for name in names], 1)


# ----------------------------------------------------------------------------------------------------------- cameras


def look(position, target):
    """Rows of the rotation from the world to a camera at `position` that looks at `target`: x right, y down, z forward."""
    z = unit(np.asarray(target, float) - position)
    x = unit(np.cross(z, [0.0, 0.0, 1.0]))
    return np.stack([x, np.cross(z, x), z])


def project(in_camera, K, distortion=(0, 0, 0, 0, 0)):
    """Pixels of points in the camera's frame; k1, k2, p1, p2, k3 as OpenCV has them."""
    k1, k2, p1, p2, k3 = distortion
    x, y = in_camera[..., 0] / in_camera[..., 2], in_camera[..., 1] / in_camera[..., 2]
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.stack([K[0][0] * u + K[0][2], K[1][1] * v + K[1][2]], -1)


def quaternion(R):
    """w, x, y, z of a rotation matrix."""
    w = np.sqrt(max(0.0, 1 + np.trace(R))) / 2
    if w > 1e-6:
        return np.array([w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)])
    raise ValueError("turn the camera a little")


# --------------------------------------------------------------------------------------------------------- Human3.6M


def make_h36m(folder):
    folder.mkdir(parents=True)
    intrinsic, K = [], []
    for i, name in enumerate(["54138969", "55011271", "58860488", "60457274"]):
        focal, centre = [1130.0 + 11 * i, 1128.0 + 9 * i], [505.0 + 3 * i, 497.0 + 4 * i]
        intrinsic.append({"id": name, "center": centre, "focal_length": focal, "radial_distortion": [-0.2 + 0.01 * i, 0.23, -0.004],
                          "tangential_distortion": [-0.0009, 0.0012 * (i - 1)], "res_w": 1000, "res_h": 1002 if i in (0, 3) else 1000,
                          "azimuth": 70})
        K.append([[focal[0], 0, centre[0]], [0, focal[1], centre[1]], [0, 0, 1]])
    extrinsic, positions_2d, positions_3d, expected = {}, {}, {}, {}
    for s, subject in enumerate(["S1", "S9"]):
        extrinsic[subject] = []
        rotations, centres = [], []
        for i in range(4):
            angle = 0.6 + i * np.pi / 2 + 0.05 * s
            centre = np.array([4600 * np.cos(angle), 4600 * np.sin(angle), 1500.0 + 60 * i])
            rotations.append(look(centre, [0, 0, 900.0]))
            centres.append(centre)
            extrinsic[subject].append({"orientation": quaternion(rotations[-1].T).tolist(), "translation": centre.tolist()})
        positions_2d[subject], positions_3d[subject] = {}, {}
        for a, (action, frames) in enumerate([("Walking", 14), ("Walking 1", 12), ("WalkDog 1", 8)]):
            joints = walk(frames, 0.95 + 0.1 * s, s + 2.0 * a)
            world = stack(joints, H36M_17)
            all_32 = np.repeat(world[:, :1], 32, 1) + 7.0  # the joints that are left out are in the way
            all_32[:, H36M_KEPT] = world
            stored = (all_32 / 1000).astype(np.float32)
            if (subject, action) != ("S9", "WalkDog 1"):
                positions_3d[subject][action] = stored
            world = stored[:, H36M_KEPT].astype(float) * 1000
            views = []
            for i, camera in enumerate(intrinsic):
                in_camera = (world - centres[i]) @ rotations[i].T
                pixels = project(in_camera, K[i], camera["radial_distortion"][:2] + camera["tangential_distortion"] +
                                 camera["radial_distortion"][2:])
                key = f"{subject} {action}|{camera['id']}"
                if action == "Walking 1":
                    expected[key + "|keypoints"] = pixels
                    expected[key + "|truth"] = in_camera
                # The detections go on for some frames after the motion capture.
                more = np.repeat(pixels[-1:], 3 if action == "Walking 1" else 0, 0)
                views.append(np.concatenate([pixels, more]).astype(np.float32))
            positions_2d[subject][action] = views
    metadata = {"layout_name": "h36m", "num_joints": 17, "keypoints_symmetry": [[4, 5, 6, 11, 12, 13], [1, 2, 3, 14, 15, 16]]}
    np.savez_compressed(folder / "data_2d_h36m_gt.npz", positions_2d=positions_2d, metadata=metadata)
    np.savez_compressed(folder / "data_3d_h36m.npz", positions_3d=positions_3d)
    (folder / "cameras.json").write_text(json.dumps({"extrinsic": extrinsic, "intrinsic": intrinsic}, indent=1) + "\n")
    np.savez_compressed(folder / "expected.npz", **expected)


# ---------------------------------------------------------------------------------------------------------- CanonPose


def make_canonpose(folder):
    folder.mkdir(parents=True)
    rng = np.random.default_rng(3)
    names = ["54138969", "55011271", "58860488", "60457274"]
    subjects, rows, mpii_rows, confidences, expected = [], {n: [] for n in names}, {n: [] for n in names}, {n: [] for n in names}, {}
    for s, (subject, frames) in enumerate([(5, 16), (1, 14)]):
        joints = walk(frames, 1.0 + 0.05 * s, 1.7 * s, fps=8.0)
        subjects += [subject] * frames
        for i, name in enumerate(names):
            angle = 0.5 + i * np.pi / 2
            centre = np.array([4500 * np.cos(angle), 4500 * np.sin(angle), 1600.0])
            for order, into in ((CANONPOSE_16, rows), (MPII_16, mpii_rows)):
                pixels = project((stack(joints, order) - centre) @ look(centre, [0, 0, 950.0]).T, [[1140, 0, 510], [0, 1140, 505], [0, 0, 1]])
                into[name].append(np.concatenate([pixels[..., 0], pixels[..., 1]], 1))
                if into is rows:
                    expected[f"S{subject}|{name}|keypoints"] = pixels.astype("f4")
            confidences[name].append(rng.uniform(0.3, 1.0, (frames, 16)))
    join = lambda parts, dtype: {n: np.concatenate(parts[n]).astype(dtype) for n in names}
    data = {"subjects": subjects, "poses_2d_pred": join(rows, "f8"), "confidences": join(confidences, "f4")}
    for protocol in (2, 5):
        (folder / f"detections_p{protocol}.pickle").write_bytes(pickle.dumps(data, protocol))
    # As other makers write it: whole numbers of NumPy, arrays column by column, confidences of heat maps, which exceed 1.
    other = {"subjects": np.array(subjects), "poses_2d_pred": {n: np.asfortranarray(v) for n, v in data["poses_2d_pred"].items()},
             "confidences": {n: 1.25 * v for n, v in data["confidences"].items()}}
    (folder / "detections_p4.pickle").write_bytes(pickle.dumps(other, 4))
    (folder / "detections_mpii_order.pickle").write_bytes(pickle.dumps({**data, "poses_2d_pred": join(mpii_rows, "f4")}, 4))
    for n in names:
        expected[f"confidence|{n}"] = data["confidences"][n]
    np.savez_compressed(folder / "expected.npz", **expected)


# ------------------------------------------------------------------------------------------------------- MPI-INF-3DHP


def cell(arrays):
    cells = np.empty((len(arrays), 1), dtype=object)
    for i, array in enumerate(arrays):
        cells[i, 0] = array
    return cells


def make_3dhp_train(folder):
    expected = {}
    for s, (sequence, frames, dtype) in enumerate([("S1/Seq1", 7, "f4"), ("S2/Seq2", 2, "f8")]):
        (folder / sequence).mkdir(parents=True)
        world = stack(walk(frames, 1.0 + 0.04 * s, 0.4 + s, fps=12.0), MPI_28)
        annot2, annot3, univ, calibration = [], [], [], ["Skeletool Camera Calibration File V1.0"]
        for i in range(14):
            angle = i * 2 * np.pi / 14 + 0.1
            centre = np.array([3800 * np.cos(angle), 3800 * np.sin(angle), 400.0 + 260 * (i % 5)])
            R = look(centre, [0, 0, 900.0])
            K = np.array([[1497.0 + i, 0, 1024.0 + 2 * i], [0, 1496.0 + i, 1050.0 - i], [0, 0, 1]])
            in_camera = ((world - centre) @ R.T).astype(dtype)
            pixels = project(in_camera.astype(float), K).astype(dtype)
            root = in_camera[:, 4:5]
            annot2.append(pixels.reshape(frames, 56))
            annot3.append(in_camera.reshape(frames, 84))
            univ.append((root + 0.92 * (in_camera - root)).astype(dtype).reshape(frames, 84))
            if i in (0, 7):
                key = sequence.replace("/", " ") + f"|{i}"
                kept = [MPI_28.index(name) for name in MPI_AS_H36M]
                expected[key + "|keypoints"] = pixels[:, kept]
                expected[key + "|truth"] = in_camera[:, kept]
                expected[key + "|univ"] = univ[-1].reshape(frames, 28, 3)[:, kept]
            four = np.eye(4)
            four[:3, :3] = K
            moved = np.eye(4)
            moved[:3, :3], moved[:3, 3] = R, -R @ centre
            line = lambda m: " ".join(f"{v:.7g}" if v != 0 else "0" for v in m.ravel())
            calibration += [f"name          {i}", "  sensor      10 10", "  size        2048 2048", "  animated    0",
                            f"  intrinsic   {line(four)} ", f"  extrinsic   {line(moved)} ", "  radial      0"]
        cameras = np.arange(14, dtype=float).reshape(14, 1)
        scipy.io.savemat(folder / sequence / "annot.mat", {"annot2": cell(annot2), "annot3": cell(annot3), "cameras": cameras,
                         "frames": np.arange(frames, dtype=float).reshape(-1, 1), "univ_annot3": cell(univ)}, do_compression=s == 0)
        with open(folder / sequence / "annot.mat", "r+b") as file:  # without the time
            file.write(b"MATLAB 5.0 MAT-file, Platform: GLNXA64, Created by: make_benchmarks.py".ljust(116))
        (folder / sequence / "camera.calibration").write_text("\n".join(calibration) + "\n")
    np.savez_compressed(folder / "expected.npz", **expected)


def write_mat73(path, arrays):
    """MATLAB 7.3: HDF5 with a header of 512 bytes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, array in arrays.items():
            file.create_dataset(name, data=array)
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created by: make_benchmarks.py HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM")


def make_3dhp_test(folder):
    expected = {}
    for s, (name, size) in enumerate([("TS1", (2048, 2048)), ("TS5", (1920, 1080))]):
        (folder / name).mkdir(parents=True)
        frames = 12
        world = stack(walk(frames, 0.97, 2.0 + s, fps=10.0), MPI_17)
        centre = np.array([3500.0, 900.0, 1500.0])
        in_camera = (world - centre) @ look(centre, [0, 0, 950.0]).T
        pixels = project(in_camera, [[1300, 0, size[0] / 2], [0, 1300, size[1] / 2], [0, 0, 1]])
        root = in_camera[:, 14:15]
        univ = root + 0.95 * (in_camera - root)
        valid = np.ones((frames, 1))
        valid[[2, 7]] = 0
        arrays = {"annot2": pixels[:, None], "annot3": in_camera[:, None], "univ_annot3": univ[:, None], "valid_frame": valid,
                  "activity_annotation": np.repeat([1.0, 4.0, 6.0], 4).reshape(-1, 1), "bb_crop": np.zeros((frames, 34))}
        if name == "TS5":  # the same as MATLAB's own order of dimensions has it
            arrays = {key: value.T for key, value in arrays.items()}
        write_mat73(folder / name / "annot_data.mat", arrays)
        kept = [MPI_17.index(joint) for joint in MPI_AS_H36M]
        invalid = valid[:, 0] == 0
        for key, truth in (("annot3", in_camera), ("univ_annot3", univ)):
            truth = truth[:, kept].copy()
            truth[invalid] = np.nan
            expected[f"{name}|{key}"] = truth
        expected[f"{name}|keypoints"] = pixels[:, kept]
    np.savez_compressed(folder / "expected.npz", **expected)


# ------------------------------------------------------------------------------------------------------------ skiers


def make_skipose(folder):
    rng = np.random.default_rng(5)
    expected = {}
    for split, sequences in (("train", [(1, 103, 10), (2, 104, 6)]), ("test", [(3, 7, 7)])):
        (folder / split).mkdir(parents=True)
        rows = {key: [] for key in ("seq", "cam", "frame", "subj", "3D", "2D", "cam_intrinsic", "cam_position", "R_cam_2_world")}
        for subject, sequence, frames in sequences:
            joints = walk(frames, 0.93 + 0.03 * subject, subject, fps=15.0)
            downhill = np.linspace(0, 6000, frames)[:, None] * np.array([1.0, 0.3, -0.4])
            world = stack(joints, H36M_17) + downhill[:, None]
            for cam in range(6):
                centre = np.array([20000.0 * np.cos(cam), 25000.0 * np.sin(cam), 2000.0 + 300 * cam])
                for t in range(frames):
                    if (cam, t % 5) == (2, 3):
                        continue  # not every camera saw every frame
                    R = look(centre, world[t, 0] + rng.normal(0, 150, 3))
                    focal = 11.0 + 0.1 * cam + 0.2 * t / frames
                    K = np.array([[focal, 0, 0.5 + 0.01 * cam], [0, focal, 0.49], [0, 0, 1]])
                    in_camera = (world[t] - centre) @ R.T
                    name = f"S{subject} seq_{sequence:03d}"
                    if cam in (0, 2):
                        key = f"{name}|cam_{cam:02d}|"
                        expected.setdefault(key + "keypoints", np.full((frames, 17, 2), np.nan))[t] = 256 * project(in_camera, K)
                        expected.setdefault(key + "truth", np.full((frames, 17, 3), np.nan))[t] = in_camera
                    values = {"seq": sequence, "cam": cam, "frame": 3 * t + 5, "subj": subject,
                              "3D": ((in_camera - in_camera[:1]) / 1000).ravel(), "2D": project(in_camera, K).ravel(),
                              "cam_intrinsic": K.ravel(), "cam_position": centre / 1000, "R_cam_2_world": R.T.ravel()}
                    for key, value in values.items():
                        rows[key].append(value)
        order = rng.permutation(len(rows["seq"]))
        with h5py.File(folder / split / "labels.h5", "w") as file:
            for key, values in rows.items():
                array = np.array(values)[order]
                file.create_dataset(key, data=array.astype("i4" if array.ndim == 1 else "f8" if key in ("3D", "2D") else "f4"))
    np.savez_compressed(folder / "expected.npz", **expected)


# ------------------------------------------------------------------------------------------------------------ pickles


class Calls:
    """Pickles to a call of any function."""

    def __init__(self, function, *arguments):
        self.call = (function, arguments)

    def __reduce__(self):
        return self.call


def numpy_2(data):
    """The same pickle with the names that NumPy 2 writes; the frame of protocol 4 and 5 grows with them."""
    grown = 0
    for part in (b"multiarray", b"numeric"):
        old, new = b"numpy.core." + part, b"numpy._core." + part
        grown += data.count(old)
        data = data.replace(bytes([0x8C, len(old)]) + old, bytes([0x8C, len(new)]) + new).replace(b"c" + old, b"c" + new)
    at = data.find(b"\x95", 0, 4)
    if at > 0:
        data = data[:at + 1] + (int.from_bytes(data[at + 1:at + 9], "little") + grown).to_bytes(8, "little") + data[at + 9:]
    return data


def make_pickles(folder):
    folder.mkdir(parents=True)
    six = np.arange(6).reshape(2, 3)
    objects = np.empty(2, dtype=object)
    objects[:] = [six.astype("f4"), None]
    shared = [1, 2]
    values = {"none": None, "true": True, "false": False, "small": 7, "negative": -3, "byte": 200, "short": 40000, "int": -2000000000,
              "long": 2**40, "least": -2**63, "real": -0.1, "text": "Fuß 漢\n\\u0041", "empty text": "", "bytes": b"\x00\xff\n", "no bytes": b"",
              "list": [1, [2, 3], []], "tuple": (1, (), (2,), (3, 4, 5, 6)), "shared": [shared, shared], 12: "twelve", "long text": "x" * 300,
              "f4": six.astype("f4"), "f8": six / 2, "f2": six.astype("f2") / 4 - 1, "i1": (six - 3).astype("i1"), "i2": (six - 3).astype("i2"),
              "i8": six - 3, "u1": six.astype("u1") + 250, "u4": six.astype("u4") + 4000000000, "bool": six % 2 == 1,
              "fortran": np.asfortranarray(six.astype("f4")), "strided": np.arange(12.0)[::2].reshape(2, 3), "objects": objects,
              "nothing": np.zeros((0, 3), "f4"), "wrapped": np.array({"a": 1}, dtype=object), "point": np.array(2.5),
              "scalar": np.float32(1.5), "count": np.int64(2**60 + 1), "down": np.int16(-5), "flag": np.bool_(True), "texts": np.array(["a", "b"]),
              "big endian": six.astype(">f4")}
    for protocol in range(6):
        (folder / f"values_p{protocol}.pickle").write_bytes(pickle.dumps(values, protocol))
    for protocol in (2, 5):
        (folder / f"values_numpy2_p{protocol}.pickle").write_bytes(numpy_2(pickle.dumps(values, protocol)))
    for protocol in (0, 2, 5):
        evil = {"poses_2d_pred": six.astype("f4"), "subjects": Calls(os.system, "touch /tmp/canonpose-was-executed")}
        (folder / f"os_system_p{protocol}.pickle").write_bytes(pickle.dumps(evil, protocol))
        (folder / f"eval_p{protocol}.pickle").write_bytes(pickle.dumps([Calls(eval, "print('executed')")], protocol))
    (folder / "numpy_load.pickle").write_bytes(pickle.dumps(Calls(np.load, "x.npy"), 4))
    (folder / "object.pickle").write_bytes(pickle.dumps(pathlib.PurePosixPath("x"), 2))
    endless = [1]
    endless.append(endless)
    (folder / "endless.pickle").write_bytes(pickle.dumps({"a": endless}, 4))
    deep = []
    for _ in range(300):
        deep = [deep]
    (folder / "deep.pickle").write_bytes(pickle.dumps(deep, 4))
    (folder / "set.pickle").write_bytes(pickle.dumps({1, 2}, 4))


# ------------------------------------------------------------------------------------------------- what is refused


def make_wrong(folder):
    """Files with one thing wrong each; the name says what."""
    folder.mkdir(parents=True)
    good_2d = np.load(FOLDER / "h36m/data_2d_h36m_gt.npz", allow_pickle=True)["positions_2d"].item()["S9"]["WalkDog 1"]
    good_3d = np.load(FOLDER / "h36m/data_3d_h36m.npz", allow_pickle=True)["positions_3d"].item()["S9"]["Walking"][:8]
    h36m_2d = lambda name, views, **more: np.savez_compressed(folder / name, positions_2d={"S9": {"WalkDog 1": views}}, **more)
    h36m_3d = lambda name, poses: np.savez_compressed(folder / name, positions_3d={"S9": {"WalkDog 1": poses}})
    broken = [view.copy() for view in good_2d]
    broken[2][3, 5, 1] = np.nan
    h36m_2d("h36m_2d_good.npz", good_2d)
    h36m_2d("h36m_2d_one_array.npz", np.stack(good_2d))
    h36m_2d("h36m_2d_confidences.npz", [np.concatenate([view, np.full(view.shape[:2] + (1,), 0.25, "f4")], 2) for view in good_2d])
    h36m_2d("h36m_2d_16_joints.npz", [view[:, :16] for view in good_2d])
    h36m_2d("h36m_2d_3_cameras.npz", good_2d[:3])
    h36m_2d("h36m_2d_fractions.npz", [view / 1000 for view in good_2d])
    h36m_2d("h36m_2d_nan.npz", broken)
    h36m_2d("h36m_2d_short.npz", [view[:5] for view in good_2d])
    h36m_2d("h36m_2d_layout.npz", good_2d, metadata={"layout_name": "humaneva", "num_joints": 15})
    h36m_3d("h36m_3d_good.npz", good_3d)
    h36m_3d("h36m_3d_mm.npz", good_3d * 1000)
    missing_3d = good_3d.copy()
    missing_3d[2, 8, 1] = np.nan  # the left foot, in one coordinate
    h36m_3d("h36m_3d_nan.npz", missing_3d)
    h36m_3d("h36m_3d_unit.npz", good_3d * 1e6)
    h36m_3d("h36m_3d_17_joints.npz", good_3d[:, H36M_KEPT])
    swapped = good_3d.copy()
    swapped[:, [1, 2, 3, 25, 26, 27, 6, 7, 8, 17, 18, 19]] = good_3d[:, [6, 7, 8, 17, 18, 19, 1, 2, 3, 25, 26, 27]]
    h36m_3d("h36m_3d_swapped.npz", swapped)

    data = pickle.loads((FOLDER / "canonpose/detections_p5.pickle").read_bytes())
    name = "54138969"
    few = {"subjects": data["subjects"][:6], "poses_2d_pred": {name: data["poses_2d_pred"][name][:6]},
           "confidences": {name: data["confidences"][name][:6]}}

    def detections(file, change):
        changed = {"subjects": list(few["subjects"]), "poses_2d_pred": {name: few["poses_2d_pred"][name].copy()},
                   "confidences": {name: few["confidences"][name].copy()}}
        change(changed)
        (folder / file).write_bytes(pickle.dumps(changed, 4))

    def set_value(data, key, index, value):
        data[key][name][index] = value

    detections("detections_no_subjects.pickle", lambda d: d.pop("subjects"))
    detections("detections_17_joints.pickle", lambda d: d["poses_2d_pred"].update({name: np.zeros((6, 34))}))
    detections("detections_rows.pickle", lambda d: d["subjects"].append(5))
    detections("detections_nan.pickle", lambda d: set_value(d, "poses_2d_pred", (4, 17), np.nan))
    detections("detections_negative.pickle", lambda d: set_value(d, "confidences", (4, 5), -0.5))
    detections("detections_camera.pickle", lambda d: d["confidences"].update({"x": d["confidences"].pop(name)}))
    detections("detections_objects.pickle", lambda d: d["poses_2d_pred"].update({name: np.array([None] * 6, dtype=object)}))

    mat = scipy.io.loadmat(FOLDER / "3dhp_train/S2/Seq2/annot.mat")
    two, three = [c[:1].astype("f4") for c in mat["annot2"][:, 0]], [c[:1].astype("f4") for c in mat["annot3"][:, 0]]
    missing = [c.copy() for c in three]
    missing[3][0, 10] = np.nan

    def train(name, **variables):
        scipy.io.savemat(folder / name, variables, do_compression=True)
        with open(folder / name, "r+b") as file:
            file.write(b"MATLAB 5.0 MAT-file, Platform: GLNXA64, Created by: make_benchmarks.py".ljust(116))

    train("train_13_cameras.mat", annot2=cell(two[:13]), annot3=cell(three[:13]))
    train("train_27_joints.mat", annot2=cell([c[:, :54] for c in two]), annot3=cell(three))
    train("train_frames.mat", annot2=cell(two), annot3=cell([np.repeat(c, 2, 0) for c in three]))
    train("train_no_annot3.mat", annot2=cell(two))
    train("train_matrix.mat", annot2=two[0], annot3=cell(three))
    train("train_nan.mat", annot2=cell(two), annot3=cell(missing))
    train("train_metres.mat", annot2=cell(two), annot3=cell([c / 1000 for c in three]))


if __name__ == "__main__":
    shutil.rmtree(FOLDER, ignore_errors=True)
    make_h36m(FOLDER / "h36m")
    make_canonpose(FOLDER / "canonpose")
    make_3dhp_train(FOLDER / "3dhp_train")
    make_3dhp_test(FOLDER / "3dhp_test")
    make_skipose(FOLDER / "skipose")
    make_pickles(FOLDER / "pickles")
    make_wrong(FOLDER / "wrong")
