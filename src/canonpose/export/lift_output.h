// The files of `lift`: .npz and .json for programs, .csv for spreadsheets, .h5 as a scene.
#pragma once

#include <filesystem>
#include <string>

#include "canonpose/scene/lifted_poses.h"

namespace canonpose {

/// Writes the format of the path's extension: .npz, .csv, .json, or .h5 for a scene (SceneOfLifted()). Throws
/// Error(kInvalidArgument) for any other extension and Error(kBadInput) where the file cannot be written.
void WriteLiftOutput(const std::filesystem::path& path, const LiftedPoses& poses);

/// Throws the Error(kInvalidArgument) of WriteLiftOutput(), to be called before any work is done.
void RequireLiftFormat(const std::filesystem::path& path);

/// The unit of the poses, as the files say it: "mm", "body lengths", or "network units" where each pose has its own.
std::string UnitsInFile(const LiftedPoses& poses);

/// Arrays pose3d (pose_in_camera), confidence (T, J), standard_deviation (T, J), canonical, rotation, joints, frames,
/// and units as text; fps where that of pose_in_camera is known.
void WriteLiftNpz(const std::filesystem::path& path, const LiftedPoses& poses);

/// One row per frame: frame, time in seconds if fps is known, then x, y and z of every joint of pose3d with the unit in
/// the header, "LKnee_x [mm]", then "LKnee_confidence" of every joint, and then its standard deviation, "LKnee_sd
/// [mm]". NaN is written as an empty cell.
void WriteLiftCsv(const std::filesystem::path& path, const LiftedPoses& poses);

/// One object with the keys of the archive and nested arrays, null for NaN.
void WriteLiftJson(const std::filesystem::path& path, const LiftedPoses& poses);

}  // namespace canonpose
