#!/usr/bin/env python3
"""Writes testdata/detections: the same two walking people, seen by two cameras, in every detector format that is read.

Needs nothing but Python. The main person walks to and fro in front; a smaller one stands behind and crosses the image. The order
of the two changes from frame to frame, as it does in detectors' files. Run it anew after changing it; the files are committed.
"""
import json
import math
import pathlib
import random
import shutil

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
HALPE_26 = COCO_17 + "HeadTop Neck MidHip LBigToe RBigToe LSmallToe RSmallToe LHeel RHeel".split()


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


def main():
    shutil.rmtree(OUT, ignore_errors=True)
    write_openpose("openpose", BODY_25)
    write_openpose("openpose_25b", BODY_25B)
    write_alphapose()
    write_mmpose()
    write_coco()


if __name__ == "__main__":
    main()
