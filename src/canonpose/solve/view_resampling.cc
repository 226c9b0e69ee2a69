#include "canonpose/solve/view_resampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "canonpose/base/error.h"
#include "canonpose/geometry/interpolation.h"

namespace canonpose {
namespace {

/// A time this near a frame is that frame's.
constexpr double kSameFrame = 1e-6;

/// A time between two frames of a view: `share` of the way from `before` to the next one.
struct Between {
  int before = 0;
  double share = 0.0;  ///< 0: the frame itself
};

Between PlaceOf(double frame) {
  const double nearest = std::round(frame);
  if (std::abs(frame - nearest) < kSameFrame) return {static_cast<int>(nearest), 0.0};
  const double before = std::floor(frame);
  return {static_cast<int>(before), frame - before};
}

class Resampler {
 public:
  Resampler(const CaptureObservations& recorded, const ClipRange& clip, int view)
      : recorded_(recorded), clip_(clip), view_(view) {}

  /// Sets what the view shows in frame `to` of `capture`, which shows nothing yet, to what it shows at a time of its
  /// own.
  void Put(double own_frame, int to, CaptureObservations& capture) const;

 private:
  [[nodiscard]] bool Exists(int t) const { return t >= 0 && t < clip_.count; }
  [[nodiscard]] bool Sees(int t, int joint) const { return Exists(t) && recorded_.Sees(clip_.first + t, view_, joint); }
  [[nodiscard]] std::size_t Index(int t, int joint) const { return recorded_.Index(clip_.first + t, view_, joint); }
  void PutJoint(const Between& place, int joint, std::size_t to, CaptureObservations& capture) const;
  void PutStart(const Between& place, int to, CaptureObservations& capture) const;

  const CaptureObservations& recorded_;
  const ClipRange& clip_;
  int view_;
};

void Resampler::PutJoint(const Between& place, int joint, std::size_t to, CaptureObservations& capture) const {
  if (!Sees(place.before, joint)) return;
  const std::size_t first = Index(place.before, joint);
  if (place.share == 0.0) {
    capture.confidence[to] = recorded_.confidence[first];
    for (std::size_t axis = 0; axis < 2; ++axis) capture.xy[2 * to + axis] = recorded_.xy[2 * first + axis];
    return;
  }
  if (!Sees(place.before + 1, joint)) return;
  const bool has_outer = Sees(place.before - 1, joint) && Sees(place.before + 2, joint);
  const std::array<double, 4> weights = has_outer ? CubicWeights(place.share) : LinearWeights(place.share);
  std::array<double, 2> point = {0.0, 0.0};
  for (int k = 0; k < 4; ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    if (weight == 0.0) continue;
    const std::size_t from = Index(place.before - 1 + k, joint);
    for (std::size_t axis = 0; axis < 2; ++axis) point[axis] += weight * recorded_.xy[2 * from + axis];
  }
  const std::size_t second = Index(place.before + 1, joint);
  capture.confidence[to] = static_cast<float>((1.0 - place.share) * recorded_.confidence[first] +
                                              place.share * recorded_.confidence[second]);
  for (std::size_t axis = 0; axis < 2; ++axis) capture.xy[2 * to + axis] = static_cast<float>(point[axis]);
}

void Resampler::PutStart(const Between& place, int to, CaptureObservations& capture) const {
  const auto has_start = [&](int t) { return Exists(t) && recorded_.HasStart(clip_.first + t, view_); };
  if (!has_start(place.before) || (place.share > 0.0 && !has_start(place.before + 1))) return;
  const std::size_t values = 3 * static_cast<std::size_t>(capture.joint_count());
  const float* first = &recorded_.start[3 * Index(place.before, 0)];
  float* target = &capture.start[3 * capture.Index(to, view_, 0)];
  if (place.share == 0.0) {
    std::copy_n(first, values, target);
    return;
  }
  const float* second = &recorded_.start[3 * Index(place.before + 1, 0)];
  double squares = 0.0;
  for (std::size_t i = 0; i < values; ++i) {
    target[i] = static_cast<float>((1.0 - place.share) * first[i] + place.share * second[i]);
    squares += static_cast<double>(target[i]) * target[i];
  }
  // Start poses have unit norm.
  for (std::size_t i = 0; i < values && squares > 0.0; ++i) target[i] /= static_cast<float>(std::sqrt(squares));
}

void Resampler::Put(double own_frame, int to, CaptureObservations& capture) const {
  if (!(own_frame > -kSameFrame && own_frame < clip_.count - 1 + kSameFrame)) return;
  const Between place = PlaceOf(own_frame);
  for (int j = 0; j < capture.joint_count(); ++j) PutJoint(place, j, capture.Index(to, view_, j), capture);
  PutStart(place, to, capture);
}

}  // namespace

void ResampleView(const CaptureObservations& recorded, int clip, int view, const TimeMap& time,
                  CaptureObservations& capture) {
  CANONPOSE_CHECK(&recorded != &capture, "resampled in place");
  const ClipRange& range = recorded.clips[static_cast<std::size_t>(clip)];
  DropFrames(view, range.first, range.count, capture);
  const Resampler resampler(recorded, range, view);
  for (int n = 0; n < range.count; ++n) {
    resampler.Put((n - time.offset) / time.rate, range.first + n, capture);
  }
}

void ResampleClip(const CaptureObservations& recorded, int clip, const std::vector<TimeMap>& times,
                  CaptureObservations& capture) {
  for (int v = 0; v < recorded.view_count(); ++v) {
    ResampleView(recorded, clip, v, times[static_cast<std::size_t>(v)], capture);
  }
}

}  // namespace canonpose
