// Evaluates predictions of any program, given as NumPy archives.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/frame_errors.h"
#include "canonpose/evaluate/report.h"

namespace canonpose {

/// An archive with pose3d (N, J, 3), and optionally joints (J texts).
struct PoseArchive {
  int frame_count = 0;
  int joint_count = 0;
  std::vector<float> poses;         ///< (N, J, 3)
  std::vector<std::string> joints;  ///< (J) or empty
};

/// Throws Error(kBadInput) where pose3d is missing or has another shape.
PoseArchive ReadPoseArchive(const std::filesystem::path& path);

struct ArchiveOptions {
  std::optional<int> root;              ///< default: that of the built-in skeleton with these joints, otherwise 0
  std::vector<std::string> left_out;    ///< joints by name, or by number if the archives have no names
  FrameRange frames;                    ///< rows of pose3d
  FrameErrors* frame_errors = nullptr;  ///< filled if it is not null
};

/// Compares predictions in any unit with truth in mm, row by row, with the protocol all-frames. Truth in metres or
/// centimetres is read as such, which is reported; a warning says where one rotation of all predictions makes them fit.
/// Throws Error(kBadInput) where the two do not match.
EvaluationReport EvaluateArchives(const std::filesystem::path& predictions, const std::filesystem::path& truth,
                                  const ArchiveOptions& options);

}  // namespace canonpose
