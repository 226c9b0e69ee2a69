// Evaluating predictions of whatever program, given as NumPy archives.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/frame_errors.h"
#include "canonpose/evaluate/report.h"

namespace canonpose {

/// An archive with pose3d (N, J, 3), and joints (J texts) where it has them.
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
  std::vector<std::string> left_out;    ///< joints by name, or by number where the archives do not name them
  FrameRange frames;                    ///< rows of pose3d
  FrameErrors* frame_errors = nullptr;  ///< filled where it is given
};

/// Predictions in any unit against truth in mm, row by row, by the protocol all-frames. Throws Error(kBadInput) where
/// the two do not belong together.
EvaluationReport EvaluateArchives(const std::filesystem::path& predictions, const std::filesystem::path& truth,
                                  const ArchiveOptions& options);

}  // namespace canonpose
