// What the readers of benchmarks share: mapping to a skeleton, choice of cameras, checks, and the report.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/benchmarks/benchmark.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

/// The benchmark's joint layout by name. Must be there.
const Skeleton& BenchmarkLayout(const std::string& name);

/// How the joints of `layout` become those of `skeleton` ("native": the same). Joints of the same name are copies; the
/// neck of MPI-INF-3DHP, at the height where Human3.6M's thorax is, becomes that. Throws Error(kBadInput) where joints
/// cannot be made.
LayoutMapping MapBenchmark(const Skeleton& layout, const std::string& skeleton);

/// The paths, with the files of this name that lie in a folder, or in folders within it, in its place; by name. Throws
/// Error(kBadInput) where a folder has none.
std::vector<std::filesystem::path> FindFiles(const std::string& name, const std::vector<std::filesystem::path>& paths);

/// Gathers a benchmark's sequences in the joints that its files have into a dataset in those that are wanted.
class BenchmarkBuilder {
 public:
  /// `usual_skeleton` is what to map to where the options name none. `truth_layout` may have other joints than
  /// `keypoint_layout`; a joint of the skeleton that it lacks is unknown. Throws Error(kBadInput).
  BenchmarkBuilder(const BenchmarkOptions& options, const Skeleton& keypoint_layout, const Skeleton& truth_layout,
                   const std::string& usual_skeleton);

  /// A sequence whose keypoints are (T, joints of keypoint_layout, 2), and truth likewise. Keeps the cameras that are
  /// wanted. `file` is where it is from, for messages. Throws Error(kBadInput) where its name was there before, or
  /// where a wanted camera is not there.
  void Add(Sequence sequence, const std::filesystem::path& file);

  /// The dataset; says in the log what it has. `confidence_scale` is what confidences were divided by.
  Dataset Finish(double confidence_scale = 1.0);

 private:
  BenchmarkOptions options_;
  LayoutMapping keypoints_;
  LayoutMapping truth_;
  std::set<std::string> names_;
  Dataset dataset_;
};

/// Median distance in pixels between the keypoints of a view and its truth (both (T, joints), the same joints) in the
/// image of `camera`; NaN where neither is known.
double MedianProjectionError(const CameraView& view, const Camera& camera);

/// Throws Error(kBadInput) at the first value that is no finite number; `row` and `joint` of it are told.
void RequireFinite(const std::vector<double>& values, std::size_t joints, std::size_t axes, const std::string& file,
                   const std::string& place);

/// Throws Error(kBadInput) where keypoints, (T, joints, 2), are fractions of the image rather than pixels.
void RequirePixels(const std::vector<double>& keypoints, const std::string& file, const std::string& place);

/// Numbers of an HDF5 file of others. Throws Error(kBadInput) where it is not there, is no numbers, or claims a size
/// that its file cannot hold.
h5::Array<double> ReadNumbers(const h5::Group& group, const std::string& name);

std::vector<float> ToFloats(const std::vector<double>& values, double scale = 1.0);

}  // namespace canonpose
