"""Runs in Blender, for check-in-blender: imports a file and compares the heads of its bones with a table."""
import builtins
import csv
import sys

import bpy
import numpy

LIMIT_M = 0.001

# Blender 3.4's importers are written for an older Python than Debian's: its BVH reader opens files with mode "rU", its glTF reader
# uses numpy.bool. Both are gone since.
_open = builtins.open
builtins.open = lambda file, mode="r", *rest, **named: _open(file, mode.replace("U", ""), *rest, **named)
if "bool" not in vars(numpy):
    numpy.bool = bool


def import_file(path, fps):
    scene = bpy.context.scene
    scene.render.fps = round(fps)
    scene.render.fps_base = round(fps) / fps
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    if path.endswith(".bvh"):
        # Files have centimetres and y up.
        bpy.ops.import_anim.bvh(filepath=path, global_scale=0.01, frame_start=1, use_fps_scale=False,
                                axis_forward="-Z", axis_up="Y", update_scene_fps=False)
    else:
        scene.render.fps_base = 1.0  # its reader ignores it
        bpy.ops.import_scene.gltf(filepath=path)


def main():
    path, table, fps = sys.argv[sys.argv.index("--") + 1:][:3]
    fps = float(fps)
    import_file(path, fps)
    is_bvh = path.endswith(".bvh")
    rate, first = (fps, 1) if is_bvh else (round(fps), 0)
    armatures = {item.name: item for item in bpy.data.objects if item.type == "ARMATURE"}
    print("armatures:", ", ".join(sorted(armatures)))
    largest, count, frame = 0.0, 0, None
    with _open(table) as file:
        rows = sorted(csv.DictReader(file), key=lambda row: float(row["seconds"]))
    for row in rows:
        wanted = first + float(row["seconds"]) * rate
        if wanted != frame:
            frame = wanted
            bpy.context.scene.frame_set(int(frame + 1e-6), subframe=max(0.0, frame - int(frame + 1e-6)))
        # A BVH file has one person, and Blender calls it as the file.
        armature = next(iter(armatures.values())) if is_bvh else armatures[row["person"]]
        bone = armature.pose.bones[row["joint"]]
        position = armature.matrix_world @ bone.head
        distance = sum((position[i] - float(row["xyz"[i]])) ** 2 for i in range(3)) ** 0.5
        if distance > largest:
            largest = distance
            print(f"{row['person']} {row['joint']} at {row['seconds']} s: {1000.0 * distance:.3f} mm")
        count += 1
    print(f"{count} positions, the largest distance is {1000.0 * largest:.4f} mm")
    if count == 0 or not largest <= LIMIT_M:
        sys.exit("positions differ")


main()
