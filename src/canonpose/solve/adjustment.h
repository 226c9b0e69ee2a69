// The bundle adjustment of some frames of a capture: what it minimises and what it holds fixed.
//
// clang-format off
//   E = sum over n, v, j      rho( |x_nvj - project(camera_nv, X_nj)| / (s_nv sigma_nvj) )    what the cameras see
//     + sum over n, bones     ( log(|X_na - X_nb| / L_b) / sigma_bone )^2                     bones keep their lengths
//     + sum over n, j         huber( |X_n-1j - 2 X_nj + X_n+1j| / sigma_acc_j )               motion is smooth
//     + sum over v            ( (log f_v - log f_expected) / sigma_focal )^2                  lenses are ordinary ones
//     + 10^6 ( mean over subjects log(sum over bones L_b) )^2                                 the unit
//   static cameras:
//     + sum over pairs v, w   ( log(f_v / f_w) / sigma_between )^2                            lenses are alike
//   moving cameras, which have focal lengths f_nv:
//     + sum over n, v         ( |w_nv| / sigma_w )^2 + ( |w_nv - w_n-1v| fps / sigma_a )^2    they rotate evenly
//     + sum over n, v         ( log(f_nv / f_n-1v) / sigma_zoom )^2 fps                       and zoom slowly
//     + sum over n, v         ( log(s_nv / s_nv at the start) / sigma_scale )^2               weak, against drift
//   lenses to be found:
//     + sum over lenses, i    ( c_li / sigma_c_i )^2                                          they distort little
//     + sum over pairs l, m   ( (c_li - c_mi) / sigma_cb_i )^2 2 / (lenses - 1)               and alike
// clang-format on
//
// n counts frames, v views, j joints; x are keypoints, X joints. rho is Cauchy's loss, a^2 log(1 + e^2 / a^2), and
// huber Huber's. s_nv is the image scale of a body unit, so that errors count in the body's size; sigma_nvj the scatter
// of the joint at its confidence; w_nv the angular velocity of a camera in rad/s. Where cameras move, the focal lengths
// of all frames together count as much as the one of a static camera. c_l are the two coefficients of a lens (lens.h).
//
// The unknowns are the joints and, unless AdjustmentOptions holds them fixed, the cameras and the bone lengths L_b.
// Smoothness couples a frame to its neighbours, and only a few parameters are shared by all frames, so the normal
// equations are banded with a border: time and memory of Ceres's sparse Cholesky factorisation are proportional to the
// number of frames.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "canonpose/solve/lens.h"
#include "canonpose/solve/noise_model.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// The scatter that the terms are weighted by. Lengths are in body units (rig_estimate.h), angles in radians.
struct AdjustmentScales {
  NoiseModel observation;            ///< error of detected joints
  double bone = 0.03;                ///< relative
  std::vector<double> acceleration;  ///< (J) per frame^2; empty: no smoothness
  double angular_velocity = 0.3;     ///< of a moving camera about each axis; MeasureAngularVelocity() knows better
  double angular_acceleration = 0.1;
  double zoom_per_second = 0.1;  ///< change of the log focal length in one second, growing with the root of time
  double log_focal = 0.7;        ///< of the logarithm of the focal length
  double log_focal_between_cameras = 0.1;  ///< static cameras of a capture are alike
  std::vector<double> expected_log_focal;  ///< (V); empty: 0, an image diagonal
  /// Of RadialLens::at_corner; the second pair is that of differences between lenses of one capture.
  std::array<double, 2> lens{0.15, 0.05};
  std::array<double, 2> lens_between_cameras{0.05, 0.02};
};

/// Of Cauchy's loss, in units of the observation's scatter.
inline constexpr double kLossScale = 2.0;

struct AdjustmentOptions {
  AdjustmentScales scales;
  bool free_cameras = true;
  bool free_bones = true;
  double loss_scale = kLossScale;
  int iterations = 30;
  int fixed_view = -1;  ///< the static camera that is held fixed; -1: none
};

enum class AdjustmentEnding {
  kConverged,       ///< a further step would hardly lower the cost
  kIterationLimit,  ///< stopped early, after AdjustmentOptions::iterations; the estimate is as good as it got
  kFailed,          ///< the estimate is as it was before, and not a solution
};

/// "converged", "stopped early" or "failed".
const char* NameOf(AdjustmentEnding ending);

/// How an adjustment went.
struct [[nodiscard]] AdjustmentSummary {
  AdjustmentEnding ending = AdjustmentEnding::kFailed;
  std::string reason = "not started";  ///< why it ended there, in words, one line
  int iterations = 0;
  /// Half of E at the start and at the end; NaN where it could not be computed.
  double initial_cost = std::numeric_limits<double>::quiet_NaN();
  double final_cost = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool IsUsable() const { return ending != AdjustmentEnding::kFailed; }
};

/// Improves `estimate` at `frames` (ascending), leaving out joints that are NaN and cameras that are not valid.
/// Numerical failures are not thrown but reported in the summary.
AdjustmentSummary Adjust(const CaptureObservations& capture, std::span<const int> frames,
                         const AdjustmentOptions& options, RigEstimate& estimate);

/// The lenses of a capture.
struct CaptureLenses {
  std::vector<RadialLens> lenses;
  std::vector<int> of_view;  ///< (V) index into `lenses`; cameras of one model share theirs
};

/// Adjust() with free cameras, whose lenses are found, too. Keypoints are compared as the cameras recorded them,
/// distorted, so that it does not matter what ObservedCamera::lens they have been undistorted with.
AdjustmentSummary AdjustWithLenses(const CaptureObservations& capture, std::span<const int> frames,
                                   const AdjustmentOptions& options, CaptureLenses& lenses, RigEstimate& estimate);

/// Numbers the runs of consecutive frames of one clip in `frames`: for each element, the number of its run.
std::vector<int> RunsOf(const CaptureObservations& capture, std::span<const int> frames);

}  // namespace canonpose
