// The errors of every single pose, for looking at the worst ones or computing other statistics.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/evaluate/metrics.h"

namespace canonpose {

/// The source of a pose.
struct PoseSource {
  std::string sequence;
  std::string camera = {};
  std::int64_t frame = 0;   ///< of the sequence in its file, counted from 0
  std::string action = {};  ///< empty where unknown
};

class FrameErrors {
 public:
  /// Throws Error(kInvalidArgument) where `path` ends in neither .csv nor .npz.
  static void RequireFormat(const std::filesystem::path& path);

  /// The number of poses.
  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  /// Adds a pose whose outcome is kEvaluated.
  void Add(const PoseSource& source, const PoseErrors& errors, bool mirrored);

  /// Writes one row per pose, in the order in which they were added. The file appears as a whole. Throws
  /// Error(kBadInput).
  ///
  /// .csv: sequence, camera, frame, action, n_mpjpe_mm, p_mpjpe_mm, largest_aligned_mm, mirrored (0 or 1), with four
  /// decimals. .npz: the same as arrays (N), and also joints (J), n_error_mm and p_error_mm (N, J): each joint's
  /// distance after the scale adjustment and after similarity alignment, NaN where unknown or left out.
  void Write(const std::filesystem::path& path, const std::vector<std::string>& joints) const;

 private:
  struct Row {
    PoseSource source;
    PoseMeans means;
    bool mirrored = false;
  };
  [[nodiscard]] std::string AsCsv() const;
  void WriteNpz(const std::filesystem::path& path, const std::vector<std::string>& joints) const;

  std::vector<Row> rows_;
  std::vector<float> scaled_mm_;   // (N, J)
  std::vector<float> aligned_mm_;  // (N, J)
};

}  // namespace canonpose
