#include "canonpose/data/readers/benchmarks/builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/choice.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr float kUnknownValue = std::numeric_limits<float>::quiet_NaN();

/// Maps poses (T, source joints, 3) to (T, target joints, 3): means of the sources. A joint is unknown in all
/// coordinates where one coordinate of one of its sources is.
std::vector<float> MapPoses(const std::vector<float>& poses, const LayoutMapping& mapping) {
  const std::size_t source_count = mapping.source.joints.size();
  const std::size_t frames = poses.size() / (3 * source_count);
  std::vector<float> mapped;
  mapped.reserve(frames * mapping.joints.size() * 3);
  for (std::size_t t = 0; t < frames; ++t) {
    for (const JointSource& joint : mapping.joints) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double sum = joint.sources.empty() ? std::nan("") : 0.0;
        for (const int source : joint.sources) {
          sum += poses[3 * (t * source_count + static_cast<std::size_t>(source)) + axis];
        }
        mapped.push_back(static_cast<float>(sum / static_cast<double>(joint.sources.size())));
      }
      if (std::any_of(mapped.end() - 3, mapped.end(), [](float value) { return std::isnan(value); })) {
        std::fill(mapped.end() - 3, mapped.end(), kUnknownValue);
      }
    }
  }
  return mapped;
}

void MapKeypoints(CameraView& view, const LayoutMapping& mapping) {
  const std::size_t source_count = mapping.source.joints.size();
  const std::size_t target_count = mapping.joints.size();
  const std::size_t frames = view.confidence.size() / source_count;
  std::vector<float> keypoints(frames * target_count * 2, kUnknownValue);
  std::vector<float> confidence(frames * target_count, 0.0F);
  for (std::size_t t = 0; t < frames; ++t) {
    ApplyMapping(mapping, &view.keypoints[2 * t * source_count], &view.confidence[t * source_count],
                 &keypoints[2 * t * target_count], &confidence[t * target_count]);
  }
  view.keypoints = std::move(keypoints);
  view.confidence = std::move(confidence);
}

/// The mapping, with copies only where names are identical, including their case (3DHP's "head" is the centre of the
/// head, Human3.6M's "Head" its top), and with 3DHP's neck as the thorax.
void PreferOwnJoints(LayoutMapping& mapping) {
  for (std::size_t t = 0; t < mapping.joints.size(); ++t) {
    const std::string& joint = mapping.target.joints[t];
    const std::vector<std::string>& names = mapping.source.joints;
    auto own = std::find(names.begin(), names.end(), joint);
    if (own == names.end() && joint == "Thorax") own = std::find(names.begin(), names.end(), "neck");
    if (own != names.end()) mapping.joints[t].sources = {static_cast<int>(own - names.begin())};
  }
}

const Skeleton& ParseTrainingTarget(const Skeleton& layout, const std::string& skeleton) {
  if (skeleton == "native") return layout;
  const Skeleton* const target = FindSkeleton(skeleton);
  return target == nullptr ? BenchmarkLayout(skeleton) : *target;
}

bool FitsFloat(double value) { return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()); }

[[noreturn]] void RefuseValue(const std::vector<double>& values, std::vector<double>::const_iterator bad,
                              std::size_t joints, std::size_t axes, const std::string& file, const std::string& place) {
  const auto at = static_cast<std::size_t>(bad - values.begin());
  ThrowBadInput({file, fmt::format("{}, row {}, joint {}", place, at / (joints * axes), at / axes % joints),
                 "a coordinate", fmt::format("{}", *bad), "restore the file from a copy or create it again"});
}

void ChooseCameras(Sequence& sequence, const std::vector<std::string>& wanted, const std::string& file) {
  if (wanted.empty()) return;
  std::vector<std::string> names;
  for (const CameraView& view : sequence.cameras) names.push_back(view.name);
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    ThrowBadInput({file, sequence.name, fmt::format("camera {}, as `cameras` says", name),
                   fmt::format("{}", fmt::join(names, ", ")), "choose from these cameras"});
  }
  KeepCameras(sequence, wanted);
}

std::string Count(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

}  // namespace

const Skeleton& BenchmarkLayout(const std::string& name) {
  const std::vector<Skeleton>& layouts = BenchmarkSkeletons();
  const auto found = std::find_if(layouts.begin(), layouts.end(), [&](const Skeleton& s) { return s.name == name; });
  const Skeleton* const layout = found == layouts.end() ? FindSkeleton(name) : &*found;
  CANONPOSE_CHECK(layout != nullptr, "{}", name);
  return *layout;
}

LayoutMapping MapBenchmark(const Skeleton& layout, const std::string& skeleton) {
  LayoutMapping mapping = MapAvailableJoints(layout, ParseTrainingTarget(layout, skeleton));
  PreferOwnJoints(mapping);
  const bool is_whole = std::none_of(mapping.joints.begin(), mapping.joints.end(),
                                     [](const JointSource& joint) { return joint.sources.empty(); });
  return is_whole ? mapping : MapLayout(layout, mapping.target);  // throws, and names what is missing
}

std::vector<fs::path> FindFiles(const std::string& name, const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
      if (entry->path().filename() == name) files.push_back(entry->path());
    }
    if (error) ThrowBadInput({path.string(), "", "a folder that can be read", error.message(), "check the path"});
    if (files.size() == before) {
      ThrowBadInput({path.string(), "", fmt::format("files {} in this folder", name), "none", "check the path"});
    }
    std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
  }
  return files;
}

BenchmarkBuilder::BenchmarkBuilder(const BenchmarkOptions& options, const Skeleton& keypoint_layout,
                                   const Skeleton& truth_layout, const std::string& usual_skeleton)
    : options_(options),
      keypoints_(MapBenchmark(keypoint_layout, options.skeleton.empty() ? usual_skeleton : options.skeleton)),
      truth_(MapAvailableJoints(truth_layout, keypoints_.target)) {
  PreferOwnJoints(truth_);
  dataset_.skeleton = keypoints_.target;
  dataset_.source.format = options.format;
  dataset_.source.layout = keypoint_layout.name;
  dataset_.source.mapping = keypoints_.DescribeAll();
}

void BenchmarkBuilder::Add(Sequence sequence, const std::filesystem::path& file) {
  if (!names_.insert(sequence.name).second) {
    ThrowBadInput({file.string(), "", "sequences of different names", fmt::format("{} twice", sequence.name),
                   "give every file once, in the benchmark's original folders"});
  }
  ChooseCameras(sequence, options_.cameras, file.string());
  for (CameraView& view : sequence.cameras) {
    MapKeypoints(view, keypoints_);
    view.truth = TruthPoses(truth_.target, MapPoses(view.truth.positions(), truth_), view.name);
  }
  dataset_.sequences.push_back(std::move(sequence));
}

Dataset BenchmarkBuilder::Finish(double confidence_scale) {
  dataset_.source.confidence_scale = confidence_scale;
  std::set<std::string> subjects;
  std::size_t frames = 0;
  std::set<std::size_t> cameras;
  for (const Sequence& sequence : dataset_.sequences) {
    subjects.insert(sequence.subject);
    frames += static_cast<std::size_t>(sequence.frame_count);
    cameras.insert(sequence.cameras.size());
  }
  LogInfo("{}: {} ({}), {}, {}, {} per sequence", options_.format, Count(subjects.size(), "subject"),
          fmt::join(subjects, ", "), Count(dataset_.sequences.size(), "sequence"), Count(frames, "frame"),
          Count(cameras.empty() ? 0 : *cameras.rbegin(), "camera"));
  LogInfo("{} in the files' layout {}, {} in the dataset's {}", Count(keypoints_.source.joints.size(), "joint"),
          keypoints_.source.name, dataset_.skeleton.joint_count(), dataset_.skeleton.name);
  return std::move(dataset_);
}

double MedianProjectionError(const CameraView& view, const Camera& camera) {
  std::vector<double> distances;
  const std::vector<float>& truth = view.truth.positions();
  for (std::size_t i = 0; i < view.confidence.size() && 3 * i + 2 < truth.size(); ++i) {
    const Eigen::Vector2d pixel = camera.ProjectFromCamera({truth[3 * i], truth[3 * i + 1], truth[3 * i + 2]});
    const double distance = (pixel - Eigen::Vector2d(view.keypoints[2 * i], view.keypoints[2 * i + 1])).norm();
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  return distances.empty() ? std::nan("") : Median(std::move(distances));
}

void RequireFinite(const std::vector<double>& values, std::size_t joints, std::size_t axes, const std::string& file,
                   const std::string& place) {
  const auto bad = std::find_if_not(values.begin(), values.end(), FitsFloat);
  if (bad != values.end()) RefuseValue(values, bad, joints, axes, file, place);
}

void RequireFiniteOrMissing(const std::vector<double>& values, std::size_t joints, std::size_t axes,
                            const std::string& file, const std::string& place) {
  const auto bad = std::find_if_not(values.begin(), values.end(),
                                    [](double value) { return std::isnan(value) || FitsFloat(value); });
  if (bad != values.end()) RefuseValue(values, bad, joints, axes, file, place);
}

void RequirePixels(const std::vector<double>& keypoints, const std::string& file, const std::string& place) {
  constexpr double kLargestFraction = 2.0;
  double largest = 0.0;
  bool has_any = false;
  for (const double value : keypoints) {
    if (std::isnan(value)) continue;
    largest = std::max(largest, std::abs(value));
    has_any = true;
  }
  if (!has_any || largest > kLargestFraction) return;
  ThrowBadInput({file, place, "coordinates in pixels",
                 fmt::format("none above {:.3g}, so fractions of the image", largest),
                 "give the file as it was published, before any normalisation"});
}

h5::Array<double> ReadNumbers(const h5::Group& group, const std::string& name) {
  constexpr std::size_t kBestCompression = 1100;  // by HDF5's filters; deflate reaches 1032
  const std::size_t limit = kBestCompression * std::filesystem::file_size(group.file());
  const std::vector<std::size_t> shape = group.Shape(name);
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (size > 0 && count > limit / size)
      group.Fail(name, "an array that the file can hold", h5::FormatShape(shape), "");
    count *= size;
  }
  return group.Read<double>(name);
}

std::vector<float> ToFloats(const std::vector<double>& values, double scale) {
  std::vector<float> floats;
  floats.reserve(values.size());
  for (const double value : values) floats.push_back(static_cast<float>(scale * value));
  return floats;
}

}  // namespace canonpose
