// Shared by the readers of benchmarks: mapping to a skeleton, choosing cameras, checks, and reporting.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

/// A joint layout of a benchmark by name; it must exist.
const Skeleton& BenchmarkLayout(const std::string& name);

/// How the joints of `layout` become those of `skeleton` ("native": the same). Joints of the same name are copies. The
/// neck of MPI-INF-3DHP becomes Human3.6M's thorax, which is at the same height. Throws Error(kBadInput) where joints
/// cannot be made.
LayoutMapping MapBenchmark(const Skeleton& layout, const std::string& skeleton);

/// The paths, where each folder is replaced by the files of this name in it and in its sub-folders, sorted. Throws
/// Error(kBadInput) where a folder has none.
std::vector<std::filesystem::path> FindFiles(const std::string& name, const std::vector<std::filesystem::path>& paths);

/// Builds a dataset with the requested joints from a benchmark's sequences, which have the joints of its files.
class BenchmarkBuilder {
 public:
  /// `usual_skeleton` is the one to map to where the options name none. `truth_layout` may have other joints than
  /// `keypoint_layout`; the truth of a joint that it lacks is unknown. Throws Error(kBadInput).
  BenchmarkBuilder(const BenchmarkOptions& options, const Skeleton& keypoint_layout, const Skeleton& truth_layout,
                   const std::string& usual_skeleton);

  /// Adds a sequence whose keypoints are (T, joints of keypoint_layout, 2), and truth likewise. Keeps only the
  /// requested cameras. `file` is its source, for messages. Throws Error(kBadInput) where there is already a sequence
  /// of that name, or a requested camera does not exist.
  void Add(Sequence sequence, const std::filesystem::path& file);

  /// Returns the dataset and logs what it contains. `confidence_scale` is what confidences were divided by.
  Dataset Finish(double confidence_scale = 1.0);

 private:
  BenchmarkOptions options_;
  LayoutMapping keypoints_;
  LayoutMapping truth_;
  std::set<std::string> names_;
  Dataset dataset_;
};

/// Median distance in pixels between the keypoints of a view and its truth, projected by `camera` (both (T, joints),
/// with the same joints); NaN where there is no joint to compare.
double MedianProjectionError(const CameraView& view, const Camera& camera);

/// Throws Error(kBadInput) at the first value that is not a finite number; the message has its row and joint.
void RequireFinite(const std::vector<double>& values, std::size_t joints, std::size_t axes, const std::string& file,
                   const std::string& place);

/// Makes keypoints with a coordinate or confidence that is NaN missing: both coordinates NaN, confidence 0. `keypoints`
/// is (T, joints, 2), `confidence` (T, joints).
template <typename Confidence>
void MarkMissing(std::vector<double>& keypoints, std::vector<Confidence>& confidence) {
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    if (!std::isnan(keypoints[2 * i]) && !std::isnan(keypoints[2 * i + 1]) && !std::isnan(confidence[i])) continue;
    keypoints[2 * i] = keypoints[2 * i + 1] = std::numeric_limits<double>::quiet_NaN();
    confidence[i] = 0;
  }
}

/// Throws Error(kBadInput) at the first infinite or huge value of (T, joints, axes); NaN is missing.
void RequireFiniteOrMissing(const std::vector<double>& values, std::size_t joints, std::size_t axes,
                            const std::string& file, const std::string& place);

/// Throws Error(kBadInput) where keypoints, (T, joints, 2), are fractions of the image rather than pixels.
void RequirePixels(const std::vector<double>& keypoints, const std::string& file, const std::string& place);

/// Reads an array of numbers from a foreign HDF5 file. Throws Error(kBadInput) where it does not exist, does not
/// consist of numbers, or claims a size that exceeds its file.
h5::Array<double> ReadNumbers(const h5::Group& group, const std::string& name);

std::vector<float> ToFloats(const std::vector<double>& values, double scale = 1.0);

}  // namespace canonpose
