// Motion capture files: ASF/AMC and BVH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/simulate/landmarks.h"
#include "canonpose/simulate/motion.h"

namespace canonpose {

/// Reads a clip of the Acclaim format. The skeleton is the .asf file in the same folder whose name the clip's begins
/// with ("01_02.amc" -> "01.asf"), or the only one there. The first joint is "root"; the others stand at the start of a
/// bone and bear its name, the ends of the last bones are "<bone>_end". Bones that begin where the root does are joints
/// at no offset. Lengths are (1 / the file's length unit) inches, CMU's convention with its unit 0.45; 120 frames a
/// second. A bone's values are in the order of its dof, its rotations are applied in the order of its axis. The subject
/// is the skeleton file's name. Throws Error(kBadInput).
ArticulatedMotion ReadAcclaim(const std::filesystem::path& amc);

/// Reads a BVH file (y up). `unit_mm` is the length of the file's unit; 0 takes it from the stature (a body between 1.2
/// and 2.3 m in mm, cm, dm, inches, CMU's units or m, by its legs where their joints are known by name, else by the
/// extent of the rest pose) and says so. End sites become joints "<parent>_end", but for those at no distance, which
/// are left out. The root's positions stand in place of its offset; positions of other joints must be their offset to
/// 1.7 mm, 0.1 % of a stature. The subject is the folder's name. Throws Error(kBadInput).
ArticulatedMotion ReadBvh(const std::filesystem::path& path, double unit_mm = 0.0);

/// .amc or .bvh by the file's ending.
ArticulatedMotion ReadMotion(const std::filesystem::path& path);

/// All clips at the paths: files as they are, folders searched through for .amc and .bvh, sorted. Throws
/// Error(kBadInput) where a path does not exist or holds none.
std::vector<std::filesystem::path> FindMotionFiles(const std::vector<std::filesystem::path>& paths);

/// The landmarks of a clip, by the names of its joints: CMU's bones and those of their conversion to BVH, the names of
/// Mixamo, MotionBuilder, Biovision, SMPL, Blender and 3ds Max's Biped, with or without a prefix; or our own where
/// joints are named Thorax, LHip and LWrist, exactly as the landmarks are. Limbs, head and hips must have joints.
///
/// Hip is amid the hips. Spine, Thorax and UpperNeck are points of the line of the spine's joints: Thorax at the height
/// of the shoulders, fixed to the chest; Spine at 47.5 % of that height above the hips, as in Human3.6M. What of the
/// head's and the feet's landmarks has no joint is placed by anthropometry as shares of the stature that the legs tell,
/// in the frame of its segment; for that the rest pose must be a person who looks ahead with soles square to the
/// shanks. CMU's head bones end amid the markers around the forehead, the crown lies 3.5 % of the stature above.
/// `file` is for messages. Throws Error(kBadInput) naming the joints that were not found.
LandmarkTrack MakeLandmarkTrack(const ArticulatedMotion& motion, const std::string& file);

}  // namespace canonpose
