#include "canonpose/solve/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>
#include <Eigen/LU>

#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/noise_model.h"

namespace canonpose {
namespace {

/// k and b of the header, measured by experiments/uncertainty. Moving cameras follow the errors of the keypoints, and
/// of two cameras neither contradicts the other's.
struct Factors {
  double of_triangulated;
  double of_cameras;
};
constexpr Factors kStatic = {0.54, 0.28};
constexpr Factors kMoving = {0.40, 0.48};
constexpr Factors kTwoCameras = {0.50, 0.52};
/// The scatter of a joint of which the views say nothing, since its bones hold it.
constexpr double kHeldByBones = 0.1;
/// Frames that the scatter of keypoints is measured in.
constexpr int kNoiseFrames = 1000;
constexpr int kNoiseRounds = 5;
/// The scatter of the most confident keypoints is at least this share of the typical one. Two views do not show how
/// much of a distance is whose.
constexpr double kMinOfConfident = 0.6;
/// Of the mean square by which a distance is expected to be smaller than the keypoint's error.
constexpr double kMinExpected = 0.02;
/// Two views leave distances in one direction only, and their median is smaller in units of the root mean square than
/// that of distances in two: 0.674 instead of 0.833.
constexpr double kMedianOfTwoViews = 0.833 / 0.674;
constexpr double kDisagreementSeconds = 1.0 / 3.0;
/// What is known of q in advance counts as this many coordinates.
constexpr double kDisagreementPrior = 20.0;

/// A keypoint of a joint, as the adjustment saw it.
struct WeightedView {
  double confidence = 0.0;
  double distance = 0.0;               ///< of the keypoint from the projected joint, body units
  double weight = 0.0;                 ///< CauchyWeight() divided by the square of the scatter
  Eigen::Matrix<double, 2, 3> rows{};  ///< derivative of the projection by the joint
};

/// A joint and the views that see it in a frame.
struct JointViews {
  int joint = 0;
  std::vector<WeightedView> views;
  Eigen::Matrix3d covariance;  ///< the inverse of the information that the weights make

  /// Mean squares of the distances if the keypoints have these variances along an axis. The distance of view v is the
  /// error of v less what the errors of all views u move the joint: e_v - sum over u of M_vu e_u.
  [[nodiscard]] std::vector<double> ExpectedSquares(const std::vector<double>& variances) const;
  /// The mean over three axes of the joint's variance.
  [[nodiscard]] double Variance(const std::vector<double>& variances, double prior) const;
};

std::vector<double> JointViews::ExpectedSquares(const std::vector<double>& variances) const {
  std::vector<double> expected(views.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Eigen::Matrix<double, 2, 3> moved = views[v].rows * covariance;
    double squares = 0.0;
    for (std::size_t u = 0; u < views.size(); ++u) {
      const Eigen::Matrix2d by_u = views[u].weight * moved * views[u].rows.transpose();
      squares += variances[u] * by_u.squaredNorm();
      if (u == v) squares += variances[v] * (2.0 - 2.0 * by_u.trace());
    }
    expected[v] = std::max(squares, kMinExpected * 2.0 * variances[v]);
  }
  return expected;
}

double JointViews::Variance(const std::vector<double>& variances, double prior) const {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Identity() / (prior * prior);
  for (std::size_t v = 0; v < views.size(); ++v) {
    // A distance that is large for its scatter says that this scatter is larger; so views that disagree say little.
    const double variance = variances[v] / CauchyWeight(views[v].distance / std::sqrt(variances[v]));
    scatter += views[v].weight * views[v].weight * variance * views[v].rows.transpose() * views[v].rows;
  }
  return (covariance * scatter * covariance).trace() / 3.0;
}

class UncertaintyMeasurement {
 public:
  UncertaintyMeasurement(const CaptureObservations& capture, const Solution& solution)
      : capture_(capture), solution_(solution), noise_(MeasureKeypoints()) {}

  [[nodiscard]] std::vector<double> Measure() const;

 private:
  /// Of each joint (F, J).
  struct Fits {
    std::vector<double> variances;  ///< of the triangulated joint; NaN where it is not solved
    std::vector<double> found;      ///< the sum of the squares of its keypoints' distances, in units of their scatter
    std::vector<double> expected;   ///< what that should be
    double usual = 1.0;             ///< found / expected, of all joints together
  };
  [[nodiscard]] Fits MeasureFits() const;
  /// q^2 of the header.
  [[nodiscard]] double SquaredDisagreement(const Fits& fits, const ClipRange& clip, int frame, int joint) const;
  /// The scatter of a joint that the views leave open; of one that no view sees, what its neighbours in time leave.
  [[nodiscard]] double Prior(int joint, bool is_seen) const;
  [[nodiscard]] JointViews ViewsOf(int frame, int joint) const;
  [[nodiscard]] NoiseModel MeasureKeypoints() const;
  [[nodiscard]] static std::vector<double> Variances(const JointViews& joint, const NoiseModel& noise);
  [[nodiscard]] std::size_t Index(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(capture_.joint_count()) +
           static_cast<std::size_t>(joint);
  }

  const CaptureObservations& capture_;
  const Solution& solution_;
  NoiseModel noise_;
};

double UncertaintyMeasurement::Prior(int joint, bool is_seen) const {
  const std::vector<double>& accelerations = solution_.scales.acceleration;
  if (is_seen || accelerations.empty()) return kHeldByBones;
  return std::min(kHeldByBones,
                  3.0 * accelerations[static_cast<std::size_t>(joint)] + 2.0 * solution_.scales.observation.Typical());
}

JointViews UncertaintyMeasurement::ViewsOf(int frame, int joint) const {
  const RigEstimate& estimate = solution_.estimate;
  JointViews found;
  found.joint = joint;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (int v = 0; v < capture_.view_count(); ++v) {
    const CameraEstimate& camera = estimate.CameraAt(frame, v);
    if (!camera.valid || !capture_.Sees(frame, v, joint)) continue;
    const Eigen::Vector3d in_camera = estimate.InCamera(frame, v, joint);
    WeightedView view;
    view.confidence = capture_.confidence[capture_.Index(frame, v, joint)];
    view.distance = (estimate.Project(frame, v, joint) - capture_.At(frame, v, joint)).norm() /
                    estimate.ImageScale(frame, v, capture_.skeleton.root);
    if (!std::isfinite(view.distance)) continue;
    const double scatter = solution_.scales.observation.Scatter(joint, view.confidence);
    view.weight = CauchyWeight(view.distance / scatter) / (scatter * scatter);
    view.rows = ProjectionRows(camera.Rotation(), in_camera);
    information += view.weight * view.rows.transpose() * view.rows;
    found.views.push_back(view);
  }
  const double prior = Prior(joint, !found.views.empty());
  found.covariance = (information + Eigen::Matrix3d::Identity() / (prior * prior)).inverse();
  return found;
}

std::vector<double> UncertaintyMeasurement::Variances(const JointViews& joint, const NoiseModel& noise) {
  std::vector<double> variances;
  for (const WeightedView& view : joint.views) {
    variances.push_back(std::pow(noise.Scatter(joint.joint, view.confidence), 2));
  }
  return variances;
}

NoiseModel UncertaintyMeasurement::MeasureKeypoints() const {
  std::vector<JointViews> joints;
  for (const int frame : EvenlySpread(ConsecutiveFrames(0, capture_.frame_count), kNoiseFrames)) {
    for (int j = 0; j < capture_.joint_count(); ++j) {
      if (solution_.estimate.Joint(frame, j).allFinite()) joints.push_back(ViewsOf(frame, j));
    }
  }
  NoiseModel noise = solution_.scales.observation;
  for (int round = 0; round < kNoiseRounds; ++round) {
    std::vector<KeypointError> errors;
    for (const JointViews& joint : joints) {
      const std::vector<double> variances = Variances(joint, noise);
      const std::vector<double> expected = joint.ExpectedSquares(variances);
      const double of_median = joint.views.size() == 2 ? kMedianOfTwoViews : 1.0;
      for (std::size_t v = 0; v < joint.views.size(); ++v) {
        const WeightedView& view = joint.views[v];
        errors.push_back(
            {joint.joint, view.confidence, of_median * view.distance * std::sqrt(2.0 * variances[v] / expected[v])});
      }
    }
    noise = NoiseModel(std::move(errors), capture_.joint_count(), kMinOfConfident);
  }
  return noise;
}

UncertaintyMeasurement::Fits UncertaintyMeasurement::MeasureFits() const {
  Fits fits{std::vector<double>(Index(capture_.frame_count, 0), std::nan("")), {}, {}, 1.0};
  fits.found.assign(fits.variances.size(), 0.0);
  fits.expected.assign(fits.variances.size(), 0.0);
  double all_found = 0.0;
  double all_expected = 0.0;
  for (int n = 0; n < capture_.frame_count; ++n) {
    for (int j = 0; j < capture_.joint_count(); ++j) {
      if (!solution_.estimate.Joint(n, j).allFinite()) continue;
      const JointViews joint = ViewsOf(n, j);
      const std::vector<double> variances = Variances(joint, noise_);
      const std::vector<double> squares = joint.ExpectedSquares(variances);
      const std::size_t i = Index(n, j);
      fits.variances[i] = joint.Variance(variances, Prior(j, !joint.views.empty()));
      for (std::size_t v = 0; v < joint.views.size(); ++v) {
        const double error = joint.views[v].distance / std::sqrt(variances[v]);
        fits.found[i] += kLossScale * kLossScale * CauchyLoss(error);  // about the square, unless that is large
        fits.expected[i] += squares[v] / variances[v];
      }
      all_found += fits.found[i];
      all_expected += fits.expected[i];
    }
  }
  if (all_expected > 0.0) fits.usual = all_found / all_expected;
  return fits;
}

double UncertaintyMeasurement::SquaredDisagreement(const Fits& fits, const ClipRange& clip, int frame,
                                                   int joint) const {
  const int reach = static_cast<int>(std::lround(kDisagreementSeconds * clip.fps));
  double found = kDisagreementPrior * fits.usual;
  double expected = kDisagreementPrior;
  const int last = std::min(clip.first + clip.count - 1, frame + reach);
  for (int near = std::max(clip.first, frame - reach); near <= last; ++near) {
    found += fits.found[Index(near, joint)];
    expected += fits.expected[Index(near, joint)];
  }
  return found / expected;
}

std::vector<double> UncertaintyMeasurement::Measure() const {
  const Fits fits = MeasureFits();
  std::vector<double> uncertainty(fits.variances.size());
  for (const ClipRange& clip : capture_.clips) {
    for (int n = clip.first; n < clip.first + clip.count; ++n) {
      const bool two_cameras = solution_.estimate.ValidViews(n).size() <= 2;
      const Factors& factors = two_cameras ? kTwoCameras : capture_.static_cameras ? kStatic : kMoving;
      const double of_cameras = factors.of_cameras * noise_.Typical();
      for (int j = 0; j < capture_.joint_count(); ++j) {
        const std::size_t i = Index(n, j);
        const double variance = SquaredDisagreement(fits, clip, n, j) * fits.variances[i];
        uncertainty[i] = std::hypot(factors.of_triangulated * std::sqrt(variance), of_cameras);
      }
    }
  }
  return uncertainty;
}

}  // namespace

std::vector<double> MeasureUncertainty(const CaptureObservations& capture, const Solution& solution) {
  return UncertaintyMeasurement(capture, solution).Measure();
}

}  // namespace canonpose
