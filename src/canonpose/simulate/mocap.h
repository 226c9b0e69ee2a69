// Motion capture files: ASF/AMC and BVH.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/simulate/landmarks.h"
#include "canonpose/simulate/motion.h"

namespace canonpose {

/// Reads a clip of the Acclaim format. The skeleton is the .asf file in the same folder whose name the clip's begins
/// with ("01_02.amc" -> "01.asf"), or the only one there. Joints are named after the bone that begins at them, the ends
/// of the last bones "<bone>_end". Lengths are (1 / 0.45) inches by CMU's convention (1 / the file's length unit), 120
/// frames a second. The subject is the skeleton file's name. Throws Error(kBadInput).
ArticulatedMotion ReadAcclaim(const std::filesystem::path& amc);

/// Reads a BVH file (y up). `unit_mm` is the length of the file's unit; 0 takes it from the stature (a body between 1.2
/// and 2.3 m in mm, cm, dm, inches, CMU's units or m) and says so. End sites become joints "<parent>_end". The subject
/// is the folder's name. Throws Error(kBadInput).
ArticulatedMotion ReadBvh(const std::filesystem::path& path, double unit_mm = 0.0);

/// .amc or .bvh by the file's ending.
ArticulatedMotion ReadMotion(const std::filesystem::path& path);

/// All clips at the paths: files as they are, folders searched through for .amc and .bvh, sorted. Throws
/// Error(kBadInput) where a path does not exist or holds none.
std::vector<std::filesystem::path> FindMotionFiles(const std::vector<std::filesystem::path>& paths);

/// The landmarks of a clip, by the names of its joints (CMU's bones, the names usual in BVH files, our own), whatever
/// of a head's and a foot's landmarks has no joint placed by anthropometry in the frame of its segment. `file` is for
/// messages. Throws Error(kBadInput) naming the joints that were not found.
LandmarkTrack MakeLandmarkTrack(const ArticulatedMotion& motion, const std::string& file);

}  // namespace canonpose
