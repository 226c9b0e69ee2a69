#!/usr/bin/env python3
"""Writes testdata/detections: the same two walking people, seen by two cameras, in every detector format that is read.

Needs nothing but Python; make_detections_hdf5.py adds the HDF5 files. The main person walks to and fro in front; a smaller one stands behind and crosses the image. The order
of the two changes from frame to frame, as it does in detectors' files. Run it anew after changing it; the files are committed.
"""
import csv
import json
import math
import pathlib
import random
import shutil
import struct

FRAMES = 8
EMPTY_FRAME = 5  # nobody is seen in the second camera
MISSING_JOINT = ("LWrist", 2)  # in the first camera
IMAGE_SIZE = (640, 480)
OUT = pathlib.Path(__file__).parent / "detections"

COCO_17 = ("Nose LEye REye LEar REar LShoulder RShoulder LElbow RElbow LWrist RWrist LHip RHip LKnee RKnee LAnkle RAnkle").split()
FEET = "LBigToe LSmallToe LHeel RBigToe RSmallToe RHeel".split()
BODY_25 = (
    "Nose Neck RShoulder RElbow RWrist LShoulder LElbow LWrist MidHip RHip RKnee RAnkle LHip LKnee LAnkle REye LEye REar LEar"
).split() + FEET
BODY_25B = COCO_17 + ["Neck", "HeadTop"] + FEET
COCO_18 = BODY_25[:8] + "RHip RKnee RAnkle LHip LKnee LAnkle REye LEye REar LEar".split()
COCO_23 = COCO_17 + FEET
HALPE_26 = COCO_17 + "HeadTop Neck MidHip LBigToe RBigToe LSmallToe RSmallToe LHeel RHeel".split()
# As a user of DeepLabCut or SLEAP might name COCO's joints.
WORDS = {"L": "left", "R": "right"}
NAMED_17 = ["nose"] + [f"{WORDS[name[0]]} {name[1:].lower()}" for name in COCO_17[1:]]
# MediaPipe's 33 landmarks: ours, or the joint that stands for one we do not make.
MEDIAPIPE_33 = (
    "Nose LEye LEye LEye REye REye REye LEar REar Nose Nose LShoulder RShoulder LElbow RElbow LWrist RWrist "
    "LWrist RWrist LWrist RWrist LWrist RWrist LHip RHip LKnee RKnee LAnkle RAnkle LHeel RHeel LBigToe RBigToe"
).split()
SCORER = "DLC_resnet50_walkJan1shuffle1_100000"


def person_in_world(frame, where, height):
    """Joint name -> x, y, z in metres, y up, walking along x."""
    x0, z0 = where
    swing = 0.5 * math.sin(0.7 * frame)
    joints = {"MidHip": (0, 0.95, 0), "Neck": (0, 1.45, 0), "Nose": (0.10, 1.58, 0), "HeadTop": (0, 1.78, 0)}
    for side, z, sign in (("L", -1, 1), ("R", 1, -1)):
        angle = sign * swing
        joints[side + "Hip"] = (0, 0.95, 0.1 * z)
        knee = (0.45 * math.sin(angle), 0.95 - 0.45 * math.cos(angle), 0.1 * z)
        bend = angle - 0.3
        ankle = (knee[0] + 0.42 * math.sin(bend), knee[1] - 0.42 * math.cos(bend), 0.1 * z)
        joints[side + "Knee"], joints[side + "Ankle"] = knee, ankle
        joints[side + "Heel"] = (ankle[0] - 0.05, ankle[1] - 0.06, ankle[2])
        joints[side + "BigToe"] = (ankle[0] + 0.18, ankle[1] - 0.07, ankle[2] - 0.02 * z)
        joints[side + "SmallToe"] = (ankle[0] + 0.15, ankle[1] - 0.07, ankle[2] + 0.04 * z)
        joints[side + "Shoulder"] = (0, 1.43, 0.19 * z)
        elbow = (-0.28 * math.sin(angle), 1.43 - 0.28 * math.cos(angle), 0.22 * z)
        joints[side + "Elbow"] = elbow
        joints[side + "Wrist"] = (elbow[0] + 0.1, elbow[1] - 0.23, 0.24 * z)
        joints[side + "Eye"] = (0.08, 1.62, 0.03 * z)
        joints[side + "Ear"] = (0.0, 1.61, 0.08 * z)
    return {name: (x0 + height * x, height * y, z0 + height * z) for name, (x, y, z) in joints.items()}


def project(point, azimuth):
    """Pixel of a world point for a camera 5 m away at 1.2 m height, looking at the middle."""
    x, y, z = point
    right = x * math.cos(azimuth) + z * math.sin(azimuth)
    depth = 5.0 - x * math.sin(azimuth) + z * math.cos(azimuth)
    return 320 + 600 * right / depth, 260 - 600 * (y - 1.2) / depth


def people(camera, frame):
    """[(track id, {joint: (x, y, confidence)})] in changing order; the first id is the main person's."""
    if camera == 1 and frame == EMPTY_FRAME:
        return []
    rng = random.Random(1000 * camera + frame)
    azimuth = (0.3, 1.2)[camera]
    bodies = [
        (1, person_in_world(frame, (0.15 * frame - 0.5, 0.0), 1.0)),
        (2, person_in_world(frame + 3, (0.9 - 0.25 * frame, 3.0), 0.8)),
    ]
    seen = []
    for track, body in bodies:
        joints = {}
        for name, point in body.items():
            x, y = project(point, azimuth)
            confidence = rng.uniform(0.6, 0.95) if track == 1 else rng.uniform(0.3, 0.6)
            joints[name] = (round(x + rng.gauss(0, 0.5), 2), round(y + rng.gauss(0, 0.5), 2), round(confidence, 3))
        if camera == 0 and track == 1 and frame == MISSING_JOINT[1]:
            joints[MISSING_JOINT[0]] = (0, 0, 0)
        seen.append((track, joints))
    return seen[::-1] if frame % 2 else seen


def triples(joints, layout, confidence_factor=1.0):
    return [v for name in layout for v in (joints[name][0], joints[name][1], round(confidence_factor * joints[name][2], 3))]


def write(path, content):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, separators=(",", ":")) + "\n")


def write_openpose(folder, layout):
    for camera in range(2):
        for frame in range(FRAMES):
            entries = [
                {"person_id": [-1], "pose_keypoints_2d": triples(joints, layout), "face_keypoints_2d": []}
                for _, joints in people(camera, frame)
            ]
            name = f"cam{camera + 1}"
            write(OUT / folder / name / f"{name}_{frame:012d}_keypoints.json", {"version": 1.3, "people": entries})


def flat_list(camera, layout, image_id, factor=1.0, with_track=False, extra=0):
    entries = []
    for frame in range(FRAMES):
        for track, joints in people(camera, frame):
            values = triples(joints, layout, factor) + [10.5, 20.5, 0.5] * extra
            entry = {"image_id": image_id(frame), "category_id": 1, "keypoints": values, "score": 1.5}
            if with_track:
                entry["idx"] = track
            entries.append(entry)
    return entries


def write_alphapose():
    for camera, name in enumerate(("left", "right")):
        write(OUT / "alphapose" / f"{name}.json", flat_list(camera, HALPE_26, lambda f: f"frame_{f}.jpg", 4.0, True))
        write(OUT / "alphapose_136" / f"{name}.json", flat_list(camera, HALPE_26, lambda f: f"frame_{f}.jpg", 4.0, True, 110))
        # As AlphaPose does, the neck is the middle of the shoulders.
        opened, cmu = {}, {}
        for frame in range(FRAMES):
            seen = [joints for _, joints in people(camera, frame)]
            for joints in seen:
                a, b = joints["LShoulder"], joints["RShoulder"]
                joints["Neck"] = tuple(round((a[i] + b[i]) / 2, 4) for i in range(3))
            if not seen:
                continue
            opened[f"{frame}.jpg"] = {"version": "AlphaPose v0.3", "people": [{"pose_keypoints_2d": triples(j, COCO_18)} for j in seen]}
            cmu[f"{frame}.jpg"] = {"version": "AlphaPose v0.3", "bodies": [{"joints": triples(j, COCO_18)} for j in seen]}
            write(OUT / "alphapose_sep" / name / "sep-json" / f"{frame}.json", opened[f"{frame}.jpg"])
        write(OUT / "alphapose_open" / name / "alphapose-results.json", opened)
        write(OUT / "alphapose_cmu" / name / "alphapose-results.json", cmu)


def mmpose_instances(camera, frame):
    return [
        {
            "keypoints": [[joints[name][0], joints[name][1]] for name in COCO_17],
            "keypoint_scores": [joints[name][2] for name in COCO_17],
            "bbox": [[1.0, 2.0, 3.0, 4.0]],
            "bbox_score": 0.9,
        }
        for _, joints in people(camera, frame)
    ]


def write_mmpose():
    for camera, name in enumerate(("a", "b")):
        video = [{"frame_id": frame + 1, "instances": mmpose_instances(camera, frame)} for frame in range(FRAMES)]
        write(OUT / "mmpose_video" / f"{name}.json", video)
        write(OUT / "mmpose_demo" / f"{name}.json", {"meta_info": {"dataset_name": "coco"}, "instance_info": video})
        for frame in range(FRAMES):
            write(OUT / "mmpose_images" / name / f"img_{frame + 1:04d}.json", mmpose_instances(camera, frame))


def write_coco():
    for camera, name in enumerate(("a", "b")):
        write(OUT / "coco" / f"{name}.json", flat_list(camera, COCO_17, lambda f: f + 1))


def by_track(camera, frame):
    return dict(people(camera, frame))


def deeplabcut_rows(camera):
    """Header rows and a row per frame, of both people; a joint that is missing is empty."""
    header = [("scorer", "individuals", "bodyparts", "coords")]
    for track in (1, 2):
        for name in NAMED_17:
            header += [(SCORER, f"person{track}", name, coord) for coord in ("x", "y", "likelihood")]
    rows = []
    for frame in range(FRAMES):
        seen = by_track(camera, frame)
        row = [frame]
        for track in (1, 2):
            for name in COCO_17:
                x, y, c = seen[track][name] if track in seen else (0, 0, 0)
                row += [x, y, c] if c > 0 else ["", "", ""]
        rows.append(row)
    return list(zip(*header)), rows


def write_deeplabcut():
    for camera in range(2):
        path = OUT / "deeplabcut" / f"cam{camera + 1}{SCORER}.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        header, rows = deeplabcut_rows(camera)
        with path.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(list(header) + rows)


def landmarks(joints):
    """[(x, y, z, visibility)] as fractions of the image."""
    values = []
    for name in MEDIAPIPE_33:
        x, y, c = joints[name]
        values.append((round(x / IMAGE_SIZE[0], 10), round(y / IMAGE_SIZE[1], 10), -0.25, c))
    return values


def write_mediapipe():
    columns = ["frame"] + [f"{axis}{k}" for k in range(33) for axis in "xyzv"]
    for camera, name in enumerate(("left", "right")):
        path = OUT / "mediapipe_csv" / f"{name}.csv"
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            for frame in range(FRAMES):
                seen = by_track(camera, frame)
                # Scripts write zeros where nobody was found.
                values = landmarks(seen[1]) if seen else [(0, 0, 0, 0)] * 33
                writer.writerow([frame] + [v for point in values for v in point])
        frames = []
        for frame in range(FRAMES):
            people_of_frame = [
                [dict(zip(("x", "y", "z", "visibility"), point)) for point in landmarks(joints)]
                for _, joints in people(camera, frame)
            ]
            frames.append({"frame": frame, "pose_landmarks": people_of_frame})
        write(OUT / "mediapipe_json" / f"{name}.json", frames)


def write_ultralytics():
    width, height = IMAGE_SIZE
    for camera in range(2):
        name = f"cam{camera + 1}"
        results = []
        for frame in range(FRAMES):
            lines, detections = [], []
            for track, joints in people(camera, frame):
                points = [joints[joint] for joint in COCO_17]
                values = [0, 0.5, 0.5, 0.25, 0.75]
                values += [v for x, y, c in points for v in (x / width, y / height, c)] + [0.9, track]
                lines.append(" ".join(f"{v:g}" for v in values))
                xs, ys, cs = zip(*points)
                box = {"x1": 1.5, "y1": 2.5, "x2": 101.5, "y2": 202.5}
                keypoints = {"x": xs, "y": ys, "visible": cs}
                detections.append(
                    {"name": "person", "class": 0, "confidence": 0.9, "box": box, "track_id": track, "keypoints": keypoints}
                )
            results.append(detections)
            # No file where nobody is seen, as the program does it.
            if lines:
                path = OUT / "ultralytics_txt" / name / "labels" / f"{name}_{frame + 1}.txt"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text("\n".join(lines) + "\n")
        write(OUT / "ultralytics_json" / f"{name}.json", results)


def write_freemocap():
    """(cameras, frames, 75 points, 3): pixels and MediaPipe's depth; NaN where nobody is seen."""
    values = []
    for camera in range(2):
        for frame in range(FRAMES):
            seen = by_track(camera, frame)
            for k in range(75):
                if not seen:
                    values += [math.nan] * 3
                elif k < 33:
                    x, y, c = seen[1][MEDIAPIPE_33[k]]
                    values += [x, y, -12.5] if c > 0 else [math.nan] * 3
                else:
                    values += [300.5, 200.5, -10.0]
    header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, %d, 75, 3), }" % FRAMES
    header += " " * (63 - (len(header) + 10) % 64) + "\n"
    path = OUT / "freemocap" / "output_data" / "raw_data" / "mediapipe2dData_numCams_numFrames_numTrackedPoints_pixelXY.npy"
    path.parent.mkdir(parents=True, exist_ok=True)
    content = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode()
    path.write_bytes(content + struct.pack(f"<{len(values)}d", *values))


def write_wholebody():
    for camera, name in enumerate(("a", "b")):
        video = []
        for frame in range(FRAMES):
            instances = []
            for _, joints in people(camera, frame):
                points = [joints[joint] for joint in COCO_23] + [(10.5, 20.5, 0.5)] * 110
                instances.append(
                    {"keypoints": [[x, y] for x, y, _ in points], "keypoint_scores": [c for _, _, c in points], "bbox_score": 0.9}
                )
            video.append({"frame_id": frame + 1, "instances": instances})
        write(OUT / "mmpose_133" / f"{name}.json", video)


def main():
    shutil.rmtree(OUT, ignore_errors=True)
    write_openpose("openpose", BODY_25)
    write_openpose("openpose_25b", BODY_25B)
    write_alphapose()
    write_mmpose()
    write_coco()
    write_deeplabcut()
    write_mediapipe()
    write_ultralytics()
    write_freemocap()
    write_wholebody()


if __name__ == "__main__":
    main()
