#include "canonpose/data/own_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/data/layout_check.h"
#include "canonpose/data/readers/mediapipe_layout.h"
#include "canonpose/data/readers/skeleton_json.h"
#include "canonpose/skeleton/connect_joints.h"

namespace canonpose {
namespace {

/// Distances are measured in at most so many frames, and in fewer where there are many joints.
constexpr std::size_t kMostFrames = 400;
constexpr std::size_t kMostDistances = 4'000'000;
/// Over frames: what a joint's distance is where it is hardly foreshortened.
constexpr double kUpperQuartile = 0.75;
/// Lists of names in messages are cut off here.
constexpr std::size_t kMostNames = 12;

std::string ListNames(std::vector<std::string> names) {
  const std::size_t left = names.size() > kMostNames ? names.size() - kMostNames : 0;
  names.resize(names.size() - left);
  return fmt::format("{}{}", fmt::join(names, ", "), left > 0 ? fmt::format(" and {} more", left) : "");
}

std::optional<std::size_t> PlaceOf(const std::vector<std::string>& names, const std::string& name) {
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const std::string& other) { return SameName(name, other); });
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

/// Brings a clip that names its joints into the order of `joints`.
void Reorder(KeypointClip& clip, const std::vector<std::string>& joints, const std::string& layout) {
  const std::vector<std::string>& names = clip.layout->joints;
  std::vector<std::size_t> source;
  for (const std::string& joint : joints) {
    const std::optional<std::size_t> index = PlaceOf(names, joint);
    if (!index) {
      ThrowBadInput({clip.path, "", fmt::format("joint {} of {}", joint, layout), "the joints " + ListNames(names),
                     "give all cameras files of one model, and a skeleton whose joints have the names in the files"});
    }
    source.push_back(*index);
  }
  if (names == joints) return;
  const std::size_t frames = clip.frame_numbers.size();
  std::vector<float> keypoints(frames * joints.size() * 2);
  std::vector<float> confidence(frames * joints.size());
  for (std::size_t t = 0; t < frames; ++t) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const std::size_t from = t * names.size() + source[j];
      const std::size_t to = t * joints.size() + j;
      confidence[to] = clip.confidence[from];
      keypoints[2 * to] = clip.keypoints[2 * from];
      keypoints[2 * to + 1] = clip.keypoints[2 * from + 1];
    }
  }
  clip.keypoints = std::move(keypoints);
  clip.confidence = std::move(confidence);
  clip.keypoint_count = static_cast<int>(joints.size());
  clip.layout->joints = joints;
  clip.layout->bones.clear();
}

double UpperQuartile(std::vector<float>& values) {
  if (values.empty()) return NAN;
  const auto at = static_cast<std::ptrdiff_t>(kUpperQuartile * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// Adds the distances between the joints of one frame, relative to the extent of all, to those of each pair.
void AddDistances(const KeypointClip& clip, std::size_t frame, std::vector<std::vector<float>>& distances) {
  const auto count = static_cast<std::size_t>(clip.keypoint_count);
  const float* const points = &clip.keypoints[frame * count * 2];
  const float* const confidence = &clip.confidence[frame * count];
  std::array<float, 2> low{std::numeric_limits<float>::max(), std::numeric_limits<float>::max()};
  std::array<float, 2> high{std::numeric_limits<float>::lowest(), std::numeric_limits<float>::lowest()};
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t axis = 0; axis < 2 && confidence[k] > 0.0F; ++axis) {
      low[axis] = std::min(low[axis], points[2 * k + axis]);
      high[axis] = std::max(high[axis], points[2 * k + axis]);
    }
  }
  const float extent = std::hypot(high[0] - low[0], high[1] - low[1]);
  if (!(extent > 0.0F) || !std::isfinite(extent)) return;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count && confidence[a] > 0.0F; ++b) {
      if (!(confidence[b] > 0.0F)) continue;
      const float distance = std::hypot(points[2 * a] - points[2 * b], points[2 * a + 1] - points[2 * b + 1]);
      distances[a * count + b].push_back(distance / extent);
    }
  }
}

/// (J, J) how far joints are apart, symmetric; NaN where they are never seen together.
std::vector<double> MeasureDistances(const std::vector<KeypointClip>& clips) {
  const auto count = static_cast<std::size_t>(clips.front().keypoint_count);
  std::size_t total = 0;
  for (const KeypointClip& clip : clips) total += clip.frame_numbers.size();
  const std::size_t frames = std::clamp<std::size_t>(kMostDistances / (count * count), 1, kMostFrames);
  const std::size_t stride = std::max<std::size_t>(1, total / frames);
  std::vector<std::vector<float>> distances(count * count);
  for (const KeypointClip& clip : clips) {
    for (std::size_t t = 0; t < clip.frame_numbers.size(); t += stride) AddDistances(clip, t, distances);
  }
  std::vector<double> result(count * count, 0.0);
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      result[a * count + b] = result[b * count + a] = UpperQuartile(distances[a * count + b]);
    }
  }
  return result;
}

std::string DescribeBones(const Skeleton& skeleton) {
  std::vector<std::string> bones;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const int parent = skeleton.parents[j];
    if (parent >= 0) bones.push_back(skeleton.joints[static_cast<std::size_t>(parent)] + "-" + skeleton.joints[j]);
  }
  return ListNames(bones);
}

Skeleton OwnLayout(std::vector<KeypointClip>& clips) {
  const DetectedLayout own = *clips.front().layout;
  for (KeypointClip& clip : clips) {
    if (!clip.layout) {
      ThrowBadInput({clip.path, "", fmt::format("the joints of camera {}, by name", clips.front().name),
                     "keypoints without names", "all cameras must come from one detector"});
    }
    if (clip.layout->joints.size() != own.joints.size()) {
      ThrowBadInput({clip.path, "", fmt::format("{} joints as in camera {}", own.joints.size(), clips.front().name),
                     fmt::format("{} in camera {}", clip.layout->joints.size(), clip.name),
                     "all cameras must come from one detector"});
    }
    Reorder(clip, own.joints, "camera " + clips.front().name);
  }
  if (own.name == MediapipeLayout().name) return MediapipeLayout();
  const bool has_bones = own.bones.size() + 1 >= own.joints.size();
  Skeleton layout =
      ConnectJoints(own.name, own.joints, own.bones, has_bones ? std::vector<double>() : MeasureDistances(clips));
  LogInfo("layout {}: {} joints named in the files; root {}; bones {}: {}", layout.name, layout.joint_count(),
          layout.joints[static_cast<std::size_t>(layout.root)],
          has_bones ? "from the files"
                    : "from the shortest tree through the joints (give `layout` a JSON file of a skeleton for others)",
          DescribeBones(layout));
  return layout;
}

Skeleton GivenLayout(std::vector<KeypointClip>& clips, const std::string& file) {
  const Skeleton layout = ReadSkeletonJson(file);
  for (KeypointClip& clip : clips) {
    if (clip.layout) {
      std::vector<std::string> dropped;
      for (const std::string& joint : clip.layout->joints) {
        if (!PlaceOf(layout.joints, joint)) dropped.push_back(joint);
      }
      Reorder(clip, layout.joints, file);
      if (!dropped.empty()) {
        LogInfo("{}: joints that {} lacks are left out: {}", clip.name, file, ListNames(dropped));
      }
    } else if (clip.keypoint_count != layout.joint_count()) {
      ThrowBadInput({clip.path, "", fmt::format("{} keypoints for the skeleton {}", layout.joint_count(), file),
                     fmt::format("{}", clip.keypoint_count),
                     "describe the joints that the files have, in their order"});
    }
  }
  return layout;
}

}  // namespace

Skeleton LayoutOf(std::vector<KeypointClip>& clips, const std::string& requested, const Skeleton* known) {
  CANONPOSE_CHECK(!clips.empty(), "no clips");
  if (IsSkeletonFile(requested)) return GivenLayout(clips, requested);
  const bool is_builtin = FindSkeleton(requested) != nullptr;
  if (clips.front().layout && !is_builtin) return OwnLayout(clips);
  if (!requested.empty() && !is_builtin && known != nullptr && known->joint_count() == clips.front().keypoint_count) {
    return *known;
  }
  const Skeleton& landmarks = MediapipeLayout();
  if (SameName(requested, landmarks.name) && landmarks.joint_count() == clips.front().keypoint_count) return landmarks;
  return CheckLayout(clips, is_builtin ? requested : "");
}

void RequireLayoutName(const std::string& layout) {
  if (layout.empty() || IsSkeletonFile(layout) || FindSkeleton(layout) != nullptr ||
      SameName(layout, MediapipeLayout().name)) {
    return;
  }
  ThrowInvalidArgument("there is no layout \"{}\"; the layouts are {}, or a JSON file with joints and parents", layout,
                       BuiltinSkeletonNames());
}

int KeypointCountOf(const std::string& layout) {
  if (layout.empty()) return 0;
  if (IsSkeletonFile(layout)) return ReadSkeletonJson(layout).joint_count();
  const Skeleton* const builtin = FindSkeleton(layout);
  return builtin == nullptr ? 0 : builtin->joint_count();
}

}  // namespace canonpose
