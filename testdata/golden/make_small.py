#!/usr/bin/env python3
"""Makes lifter_losses_small.json: the method's losses, gradients and Adam steps for a small network, in float64.

Uses PyTorch's own layers, autograd and Adam and shares no line with the C++: two implementations that agree. Needs Debian's python3-torch; run as: ./make_small.py > lifter_losses_small.json
"""
import json
import math

import torch
from torch.nn.functional import leaky_relu

torch.set_default_dtype(torch.float64)
JOINTS, WIDTH, VIEWS, ROOT = 5, 12, 3, 2
SUBJECTS = [3, 4, 3, 4, 4, 9]
MASK = (1 << 64) - 1


def splitmix64(x):
    x = (x + 0x9E3779B97F4A7C15) & MASK
    x = ((x ^ (x >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    x = ((x ^ (x >> 27)) * 0x94D049BB133111EB) & MASK
    return x ^ (x >> 31)


def stream(base, count):
    return [(splitmix64(base + k) >> 40) / 2.0**24 - 0.5 for k in range(count)]


def make_parameters():
    shapes = [("upscale", WIDTH, 3 * JOINTS)]
    for block in ["res_common", "res_pose1", "res_pose2", "res_cam1", "res_cam2"]:
        shapes += [(f"{block}.l1", WIDTH, WIDTH), (f"{block}.l2", WIDTH, WIDTH)]
    shapes += [("pose3d", 3 * JOINTS, WIDTH), ("enc_rot", 3, WIDTH)]
    entries, tensors = [], {}
    for name, rows, columns in shapes:
        for kind, shape in [("weight", [rows, columns]), ("bias", [rows])]:
            base = (1000 + len(entries)) << 32
            scale = f"2/sqrt({columns})"
            values = torch.tensor(stream(base, math.prod(shape))) * (2 / math.sqrt(columns))
            tensors[f"{name}.{kind}"] = values.float().double().view(shape).requires_grad_()
            entries.append({"name": f"{name}.{kind}", "shape": shape, "stream_base": base, "scale": scale})
    return entries, tensors


def make_batch():
    rows = len(SUBJECTS) * VIEWS
    points = torch.tensor(stream(7 << 32, rows * 2 * JOINTS)).view(rows, 2, JOINTS)
    points = points - points[:, :, ROOT:ROOT + 1]
    points = points / points.flatten(1).norm(dim=1).view(-1, 1, 1)
    confidences = torch.tensor(stream(8 << 32, rows * JOINTS)).view(rows, JOINTS) * 0.9 + 0.5
    return points.flatten(1), confidences


def permutations():
    result = []
    seed = 0
    for view in range(VIEWS):
        for subject in sorted(set(SUBJECTS)):
            count = SUBJECTS.count(subject)
            if count < 2:
                continue
            seed += 1
            keys = stream(seed << 40, count)
            result.append(sorted(range(count), key=lambda k: keys[k]))
    return result


def forward(p, x):
    def linear(name, v):
        return v @ p[name + ".weight"].T + p[name + ".bias"]

    def block(name, v):
        inner = leaky_relu(linear(name + ".l1", v), 0.01)
        return leaky_relu(v + leaky_relu(linear(name + ".l2", inner), 0.01), 0.01)

    common = block("res_common", linear("upscale", x))
    pose = linear("pose3d", block("res_pose2", block("res_pose1", common)))
    axis_angle = linear("enc_rot", block("res_cam2", block("res_cam1", common)))
    rotations = []
    for w in axis_angle:
        angle = torch.sqrt(torch.clamp((w * w).sum(), min=1e-4))
        a = w / angle
        cross = torch.zeros(3, 3)
        cross = torch.stack([torch.stack([cross[0, 0], -a[2], a[1]]), torch.stack([a[2], cross[0, 0], -a[0]]),
                             torch.stack([-a[1], a[0], cross[0, 0]])])
        rotations.append(torch.eye(3) + torch.sin(angle) * cross + (1 - torch.cos(angle)) * cross @ cross)
    return pose, axis_angle, torch.stack(rotations)


def error(pose_in_camera, target, confidence):
    """Mean over rows of one pose each: (n, 3, J) against (n, 2J) with (n, J)."""
    q = pose_in_camera[:, :2].flatten(1)
    q = q / torch.sqrt((q * q).sum(1, keepdim=True) / (2 * JOINTS))
    w = target / torch.sqrt((target * target).sum(1, keepdim=True) / (2 * JOINTS))
    difference = (w - q).abs().view(-1, 2, JOINTS).sum(1)
    return (difference * confidence).sum() / (len(target) * 2 * JOINTS)


def losses(p, keypoints, confidences, perms):
    pose, _, rotation = forward(p, torch.cat([keypoints, confidences], 1))
    pose = pose.view(-1, 3, JOINTS)
    frames = len(SUBJECTS)
    row = lambda n, v: n * VIEWS + v
    rep = error(rotation @ pose, keypoints, confidences)
    view = 0
    camera = 0
    perms = iter(perms)
    for i in range(VIEWS):
        others = [j for j in range(VIEWS) if j != i]
        source = [row(n, i) for n in range(frames) for _ in others]
        target = [row(n, j) for n in range(frames) for j in others]
        view = view + error(rotation[target] @ pose[source], keypoints[target], confidences[target])
        for subject in sorted(set(SUBJECTS)):
            members = [n for n in range(frames) if SUBJECTS[n] == subject]
            if len(members) < 2:
                continue
            perm = next(perms)
            source, target, relative = [], [], []
            for place, n in enumerate(members):
                other = members[perm[place]]
                for j in others:
                    source.append(row(n, i))
                    target.append(row(n, j))
                    relative.append(rotation[row(other, j)] @ rotation[row(other, i)].T)
            turned = torch.stack(relative) @ (rotation[source] @ pose[source])
            camera = camera + error(turned, keypoints[target], confidences[target])
    return {"rep": rep, "view": view, "camera": camera, "total": rep + view + 0.1 * camera}


def summary(tensors):
    return {name: {"l2": t.norm().item(), "first": t.flatten()[:6].tolist()} for name, t in tensors.items()}


def main():
    entries, p = make_parameters()
    keypoints, confidences = make_batch()
    perms = permutations()
    pose, axis_angle, rotation = forward(p, torch.cat([keypoints, confidences], 1))
    result = {
        "parameters": entries, "subjects": SUBJECTS, "views": VIEWS, "joints": JOINTS,
        "keypoints": keypoints.tolist(), "confidences": confidences.tolist(), "permutations": perms,
        "forward": {"pose": pose.tolist(), "axis_angle": axis_angle.tolist(), "rotation": rotation.tolist()},
    }
    adam = torch.optim.Adam(p.values(), lr=1e-4, weight_decay=1e-5)
    steps = []
    for step in range(4):
        values = losses(p, keypoints, confidences, perms)
        steps.append({name: value.item() for name, value in values.items()})
        adam.zero_grad()
        values["total"].backward()
        if step == 0:
            result["gradients_step0"] = summary({name: t.grad for name, t in p.items()})
        adam.step()
    result["losses_per_step"] = steps
    result["parameters_after_4_steps"] = summary({name: t.detach() for name, t in p.items()})
    print(json.dumps(result))


main()
