// The result of `lift`, and its file formats: .npz and .json for programs, .csv for spreadsheets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace canonpose {

/// T poses of J joints. pose3d is in the camera's frame (x right, y down, z forward), centred on the root; pose3d[t] =
/// rotation[t] * canonical[t]. NaN in frames that could not be lifted.
struct LiftOutput {
  std::vector<float> pose3d;         ///< (T, J, 3)
  std::vector<float> canonical;      ///< (T, J, 3)
  std::vector<float> rotation;       ///< (T, 3, 3) camera_from_canonical
  std::vector<std::string> joints;   ///< (J)
  std::vector<std::int64_t> frames;  ///< (T) numbers of the frames in the input
  std::string units;                 ///< of pose3d and canonical: "mm", or a description
  double fps = 0.0;                  ///< 0 where unknown
};

/// Writes the format of the path's extension: .npz, .csv or .json. Throws Error(kInvalidArgument) for any other
/// extension and Error(kBadInput) where the file cannot be written.
void WriteLiftOutput(const std::filesystem::path& path, const LiftOutput& output);

/// Throws the Error(kInvalidArgument) of WriteLiftOutput(), to be called before any work is done.
void RequireLiftFormat(const std::filesystem::path& path);

/// Arrays pose3d, canonical, rotation, joints, frames, and units as text; fps where it is known.
void WriteLiftNpz(const std::filesystem::path& path, const LiftOutput& output);

/// One row per frame: frame, time in seconds if fps is known, then x, y and z of every joint of pose3d with the unit in
/// the header, "LKnee_x [mm]". NaN is written as an empty cell.
void WriteLiftCsv(const std::filesystem::path& path, const LiftOutput& output);

/// One object with the keys of the archive and nested arrays, null for NaN.
void WriteLiftJson(const std::filesystem::path& path, const LiftOutput& output);

}  // namespace canonpose
