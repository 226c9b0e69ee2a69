// How a body moves, in figures that hardly depend on from where it is seen: what clocks of cameras are compared by
// before anything is known of where the cameras are.
//
// There are two kinds. Distances between joints of the start's poses, which a lifter found in each view by itself: they
// do not depend on the view, but the lifter errs. And keypoints relative to the body: under weak perspective two static
// cameras see the same motion along the direction of their epipolar lines' normals, whatever else differs, so that the
// first canonical correlation of their keypoints is 1 where frames belong together. Of both only what changes within
// seconds is kept, since errors of a lifter and differences of perspective are slow.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/observations.h"

namespace canonpose {

/// Of one view in one clip. N samples in time; values that are not known are 0.
struct MotionSignature {
  double samples_per_second = 0.0;
  double frames_per_sample = 1.0;  ///< sample i is the mean of this many frames of the clip, from i times as many on
  Eigen::MatrixXf poses;           ///< (N, pairs of joints)
  Eigen::MatrixXf keypoints;       ///< (N, 2 J) x of all joints, then y
  int first = 0;                   ///< the samples outside of first .. last know nothing
  int last = -1;                   ///< before `first` where the view shows nothing

  [[nodiscard]] int count() const { return static_cast<int>(keypoints.rows()); }
  [[nodiscard]] bool knows_anything() const { return last >= first; }
  [[nodiscard]] double seconds() const { return (last - first + 1) / samples_per_second; }
};

MotionSignature SignatureOf(const CaptureObservations& capture, int clip, int view);

/// The signature as it were if the view's clock ran `rate` times as fast as it does: sample i is at i / rate.
MotionSignature Stretch(const MotionSignature& signature, double rate);

/// How alike the motion of two views is at every lag, in samples: the second view's sample i shows what the first
/// one's sample i + lag does. Values are in robust standard deviations over all lags, so that 0 is chance.
class SimilarityCurve {
 public:
  /// Lags at which the views share less than `min_overlap_seconds` are not compared.
  SimilarityCurve(const MotionSignature& a, const MotionSignature& b, double min_overlap_seconds);

  /// Between lags by linear interpolation; 0 where there is no comparison.
  [[nodiscard]] double At(double lag) const;
  struct Peak {
    double lag = 0.0;
    double value = 0.0;
  };
  /// The highest local maxima, highest first, at least `apart` samples from each other. Lags are those of parabolas
  /// through the maxima.
  [[nodiscard]] std::vector<Peak> Peaks(int count, double apart) const;

 private:
  int first_lag_ = 0;
  std::vector<double> values_;  ///< NaN where not compared
};

}  // namespace canonpose
