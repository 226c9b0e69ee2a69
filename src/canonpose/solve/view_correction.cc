#include "canonpose/solve/view_correction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace canonpose {
namespace {

/// The observations of one frame of a view.
struct FrameObservations {
  std::vector<float> xy;          ///< (J, 2)
  std::vector<float> confidence;  ///< (J)
  std::vector<float> start;       ///< (J, 3)
};

FrameObservations Take(const CaptureObservations& capture, int frame, int view) {
  const std::size_t i = capture.Index(frame, view, 0);
  const auto joints = static_cast<std::ptrdiff_t>(capture.joint_count());
  const auto copy = [&](const std::vector<float>& values, std::ptrdiff_t width) {
    const auto begin = values.begin() + width * static_cast<std::ptrdiff_t>(i);
    return std::vector<float>(begin, begin + width * joints);
  };
  return {copy(capture.xy, 2), copy(capture.confidence, 1), copy(capture.start, 3)};
}

void Put(const FrameObservations& from, const ViewReading& reading, int frame, int view, CaptureObservations& capture) {
  for (int j = 0; j < capture.joint_count(); ++j) {
    const auto source = static_cast<std::size_t>(
        reading.sides_are_exchanged ? capture.skeleton.mirror[static_cast<std::size_t>(j)] : j);
    const std::size_t to = capture.Index(frame, view, j);
    const Eigen::Vector2d keypoint = reading.Read({from.xy[2 * source], from.xy[2 * source + 1]});
    capture.xy[2 * to] = static_cast<float>(keypoint.x());
    capture.xy[2 * to + 1] = static_cast<float>(keypoint.y());
    capture.confidence[to] = from.confidence[source];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = from.start[3 * source + axis];
      capture.start[3 * to + axis] = axis == 0 && reading.is_mirrored ? -value : value;
    }
  }
}

std::string DescribeTime(const TimeMap& time, double fps) {
  if (time.rate < 0.0) return "runs backwards";
  if (time.rate == 1.0) {
    return fmt::format("started {:.0f} frames ({:.2f} s) {} the others", std::abs(time.offset),
                       std::abs(time.offset) / fps, time.offset > 0.0 ? "after" : "before");
  }
  return fmt::format("has {:.3g} times the frame rate of the others", 1.0 / time.rate);
}

}  // namespace

void DropFrames(int view, int first, int count, CaptureObservations& capture) {
  for (int n = first; n < first + count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      const std::size_t i = capture.Index(n, view, j);
      capture.confidence[i] = 0.0F;
      std::fill_n(&capture.xy[2 * i], 2, std::numeric_limits<float>::quiet_NaN());
      std::fill_n(&capture.start[3 * i], 3, std::numeric_limits<float>::quiet_NaN());
    }
  }
}

double ViewCorrection::TimeOf(double t) const {
  const double time = reading.time.At(t) + offset_frames;
  for (const BadStretch& stretch : bad) {
    if (t < stretch.first || t >= stretch.first + stretch.count) continue;
    return stretch.fault == StretchFault::kTimeJump ? time + stretch.jump_frames
                                                    : std::numeric_limits<double>::quiet_NaN();
  }
  return time;
}

void ApplyCorrection(const ViewCorrection& correction, int clip, int view, CaptureObservations& capture) {
  if (correction.IsNone()) return;
  const ClipRange& range = capture.clips[static_cast<std::size_t>(clip)];
  std::vector<FrameObservations> own;
  for (int t = 0; t < range.count; ++t) own.push_back(Take(capture, range.first + t, view));
  DropFrames(view, range.first, range.count, capture);
  for (int t = 0; t < range.count; ++t) {
    const double time = correction.TimeOf(t);
    if (!std::isfinite(time)) continue;
    const auto n = static_cast<int>(std::lround(time));
    // Of a faster view, frames that fall between two of the others are not used.
    if (n < 0 || n >= range.count || std::abs(time - n) > 0.25) continue;
    Put(own[static_cast<std::size_t>(t)], correction.reading, range.first + n, view, capture);
  }
}

void CopyView(const CaptureObservations& from, int view, CaptureObservations& to) {
  to.cameras[static_cast<std::size_t>(view)].lens = from.cameras[static_cast<std::size_t>(view)].lens;
  for (int n = 0; n < from.frame_count; ++n) {
    const std::size_t i = from.Index(n, view, 0);
    const auto joints = static_cast<std::size_t>(from.joint_count());
    std::copy_n(&from.xy[2 * i], 2 * joints, &to.xy[2 * i]);
    std::copy_n(&from.confidence[i], joints, &to.confidence[i]);
    std::copy_n(&from.start[3 * i], 3 * joints, &to.start[3 * i]);
  }
}

std::string Describe(const ViewReading& reading, double fps) {
  std::string text;
  const auto add = [&](const std::string& more) { text += (text.empty() ? "" : " and ") + more; };
  if (reading.is_mirrored) add("is mirrored");
  if (reading.sides_are_exchanged && !reading.is_mirrored) add("has left and right exchanged");
  if (!reading.time.IsIdentity()) add(DescribeTime(reading.time, fps));
  return text;
}

}  // namespace canonpose
