#include "canonpose/data/keypoint_checks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/image_size_check.h"

namespace canonpose {
namespace {

/// Coordinates that never exceed this are fractions of the image, not pixels.
constexpr float kLargestFraction = 2.0F;
/// A keypoint outside the image by this fraction of its size is not just beyond its border.
constexpr float kFarOutside = 0.1F;
/// If this fraction of the keypoints is far outside, the image size is wrong.
constexpr double kManyOutside = 0.02;
/// Of the keypoints' centre, as a fraction of the image: about 0.35 for a video of half the size or with width and
/// height exchanged, up to 0.26 where the size is right but only arms and head are detected.
constexpr double kClearlyOffCentre = 0.3;
/// No detector's confidences exceed this; AlphaPose's, which are maxima of heat maps, reach about 6.
constexpr float kLargestConfidence = 100.0F;
/// Nor does one exceed both this and kOutlierFactor times the value that 99 % of them stay below.
constexpr float kSuspiciousConfidence = 10.0F;
constexpr float kOutlierFactor = 10.0F;

}  // namespace

void RefuseFractions(const KeypointClip& clip) {
  float largest = 0.0F;
  for (const float coordinate : clip.keypoints) {
    if (!std::isnan(coordinate)) largest = std::max(largest, std::abs(coordinate));
  }
  if (largest > kLargestFraction) return;
  ThrowBadInput({clip.path, "", "coordinates in pixels",
                 fmt::format("none above {:.3g}, so fractions of the image", largest),
                 "run the detector again so that it writes pixels (OpenPose: with keypoint_scale 0)"});
}

void CheckImageSize(const KeypointClip& clip, const std::array<int, 2>& size) {
  std::size_t seen = 0;
  std::size_t outside = 0;
  std::array<float, 2> reach{0.0F, 0.0F};
  for (std::size_t i = 0; i + 1 < clip.keypoints.size(); i += 2) {
    if (std::isnan(clip.keypoints[i])) continue;
    ++seen;
    bool is_far = false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const float coordinate = clip.keypoints[i + axis];
      const auto extent = static_cast<float>(size[axis]);
      reach[axis] = std::max(reach[axis], coordinate);
      is_far = is_far || coordinate < -kFarOutside * extent || coordinate > (1.0F + kFarOutside) * extent;
    }
    outside += is_far ? 1 : 0;
  }
  if (static_cast<double>(outside) <= kManyOutside * static_cast<double>(seen)) {
    const std::vector<OtherImageSize> others = OtherImageSizes(clip.keypoints, size, kClearlyOffCentre);
    if (others.empty()) return;
    LogWarning(
        "{}: the keypoints lie as in images of {}x{} pixels, not {}x{}: check `image_size`, which is that of the video "
        "that the detector was given",
        clip.name, others.front().size[0], others.front().size[1], size[0], size[1]);
    return;
  }
  LogWarning(
      "{}: {:.0f} % of the keypoints lie far outside an image of {}x{} pixels (they reach {:.0f}, {:.0f}); check "
      "`image_size`{}",
      clip.name, 100.0 * static_cast<double>(outside) / static_cast<double>(seen), size[0], size[1], reach[0], reach[1],
      size[0] != size[1] ? ", width comes first" : "");
}

void RefuseAbsurdConfidences(const DetectedCamera& camera) {
  std::vector<float> seen;
  float largest = 0.0F;
  std::string place;
  for (const DetectedFrame& frame : camera.frames) {
    for (std::size_t p = 0; p < frame.people.size(); ++p) {
      const std::vector<float>& confidence = frame.people[p].confidence;
      for (std::size_t k = 0; k < confidence.size(); ++k) {
        if (confidence[k] > 0.0F) seen.push_back(confidence[k]);
        if (!(confidence[k] > largest)) continue;
        largest = confidence[k];
        if (largest > kSuspiciousConfidence)
          place = fmt::format("frame {} ({}), person {}, keypoint {}", frame.number, frame.image, p, k);
      }
    }
  }
  if (largest <= kSuspiciousConfidence) return;
  const auto rank = seen.begin() + static_cast<std::ptrdiff_t>((seen.size() - 1) * 99 / 100);
  std::nth_element(seen.begin(), rank, seen.end());
  if (largest <= kLargestConfidence && largest <= kOutlierFactor * *rank) return;
  ThrowBadInput({camera.path, place,
                 fmt::format("a confidence like the others, 99 % of which are at most {:.3g}, and never above {:.0f}",
                             *rank, kLargestConfidence),
                 fmt::format("{:.6g}", largest), "correct or remove that detection, or run the detector again"});
}

void RefuseIdenticalClips(const std::vector<KeypointClip>& clips) {
  const auto is_same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t i = 0; i < clips.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!std::equal(clips[i].keypoints.begin(), clips[i].keypoints.end(), clips[k].keypoints.begin(),
                      clips[k].keypoints.end(), is_same))
        continue;
      ThrowBadInput({clips[i].path, "", fmt::format("camera {} to have its own keypoints", clips[i].name),
                     fmt::format("those of camera {} ({}) in every frame", clips[k].name, clips[k].path),
                     "give every camera once, with its own detections"});
    }
  }
}

}  // namespace canonpose
