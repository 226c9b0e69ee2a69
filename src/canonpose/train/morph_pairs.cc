#include "canonpose/train/morph_pairs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/geometry/normalisation.h"

namespace canonpose {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The true position of a joint in a frame, pixels; NaN where unknown.
using TruePixel = std::function<Eigen::Vector2d(int frame, int joint)>;

void AddView(const CameraView& view, int frame_count, const Skeleton& skeleton, const TruePixel& true_pixel,
             MorphPairs& pairs) {
  const int joints = skeleton.joint_count();
  NormalisedPose pose;
  std::vector<float> offset(2 * static_cast<std::size_t>(joints));
  for (int t = 0; t < frame_count; ++t) {
    const std::size_t first = static_cast<std::size_t>(t) * static_cast<std::size_t>(joints);
    if (!NormalisePose(&view.keypoints[2 * first], &view.confidence[first], joints, skeleton.root, pose)) continue;
    bool any = false;
    for (int j = 0; j < joints; ++j) {
      const std::size_t i = first + static_cast<std::size_t>(j);
      const Eigen::Vector2d pixel = true_pixel(t, j);
      const bool is_known = view.confidence[i] > 0.0F && pixel.allFinite();
      any = any || is_known;
      for (int axis = 0; axis < 2; ++axis) {
        offset[static_cast<std::size_t>(axis * joints + j)] =
            is_known ? static_cast<float>(pixel[axis] - view.keypoints[2 * i + static_cast<std::size_t>(axis)]) /
                           pose.scale_px
                     : kNaN;
      }
    }
    if (!any) continue;
    pairs.input.insert(pairs.input.end(), pose.keypoints.begin(), pose.keypoints.end());
    pairs.input.insert(pairs.input.end(), pose.confidence.begin(), pose.confidence.end());
    pairs.offset.insert(pairs.offset.end(), offset.begin(), offset.end());
  }
}

Eigen::Vector2d ProjectTruth(const CameraView& view, int frame, std::size_t index) {
  const float* const position = &view.truth.positions()[3 * index];
  return view.CalibrationAt(frame).ProjectFromCamera({position[0], position[1], position[2]});
}

const CameraView& FindCamera(const Sequence& sequence, const std::string& name, const std::string& file) {
  const auto found = std::ranges::find(sequence.cameras, name, &CameraView::name);
  if (found == sequence.cameras.end()) {
    ThrowBadInput({file, sequence.name, fmt::format("camera {}", name), "none of that name",
                   "give the same recording with its true keypoints"});
  }
  return *found;
}

}  // namespace

void AddPairsOfTruth(const Dataset& detected, const std::string& file, MorphPairs& pairs) {
  const auto joints = static_cast<std::size_t>(detected.skeleton.joint_count());
  pairs.joint_count = detected.skeleton.joint_count();
  const std::size_t before = pairs.count();
  for (const Sequence& sequence : detected.sequences) {
    for (const CameraView& view : sequence.cameras) {
      if (view.truth.empty() || view.calibration.empty()) continue;
      const auto true_pixel = [&](int t, int j) {
        return ProjectTruth(view, t, static_cast<std::size_t>(t) * joints + static_cast<std::size_t>(j));
      };
      AddView(view, sequence.frame_count, detected.skeleton, true_pixel, pairs);
    }
  }
  if (pairs.count() == before) {
    ThrowBadInput({file, "", "views with both truth and calibration, which give the true keypoints", "none",
                   "give the true keypoints as a second dataset: `exact` FILE"});
  }
}

void AddPairsOfDatasets(const Dataset& detected, const std::string& detected_file, const Dataset& exact,
                        const std::string& exact_file, MorphPairs& pairs) {
  if (!detected.skeleton.SameJoints(exact.skeleton)) {
    ThrowBadInput({exact_file, "/skeleton", fmt::format("the joints of {}", detected_file), "others",
                   "import both onto the same skeleton"});
  }
  pairs.joint_count = detected.skeleton.joint_count();
  const auto joints = static_cast<std::size_t>(pairs.joint_count);
  for (const Sequence& sequence : detected.sequences) {
    const auto found = std::ranges::find(exact.sequences, sequence.name, &Sequence::name);
    if (found == exact.sequences.end() || found->frame_count != sequence.frame_count) {
      ThrowBadInput({exact_file, sequence.name, fmt::format("{} frames as in {}", sequence.frame_count, detected_file),
                     found == exact.sequences.end() ? "no such sequence" : fmt::format("{}", found->frame_count),
                     "give the same recording with its true keypoints"});
    }
    for (const CameraView& view : sequence.cameras) {
      const CameraView& truth = FindCamera(*found, view.name, exact_file);
      const auto true_pixel = [&](int t, int j) {
        const std::size_t i = static_cast<std::size_t>(t) * joints + static_cast<std::size_t>(j);
        if (!(truth.confidence[i] > 0.0F)) return Eigen::Vector2d::Constant(kNaN).eval();
        return Eigen::Vector2d(truth.keypoints[2 * i], truth.keypoints[2 * i + 1]);
      };
      AddView(view, sequence.frame_count, detected.skeleton, true_pixel, pairs);
    }
  }
}

}  // namespace canonpose
