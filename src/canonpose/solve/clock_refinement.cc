#include "canonpose/solve/clock_refinement.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "canonpose/base/error.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

/// Frames that are compared, at most.
constexpr int kFrames = 600;
/// Parameters of a view: turn (3) and shift (3) in the camera's frame, log focal length, time offset, drift.
constexpr int kOfView = 9;
constexpr int kOfCamera = 7;
constexpr int kOffset = 7;
constexpr int kDrift = 8;
/// Errors of a detector last for some frames, and all joints of a view may err together: the variance is so many times
/// that of independent errors. Chosen from simulated recordings.
constexpr double kDependence = 60.0;
/// Keeps what keypoints leave open, such as the place of the world, where it is; relative to what they determine best.
constexpr double kDamping = 1e-7;

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// One view of a joint: residuals are `error` + by_joint * joint + by_view * parameters of the view.
struct ViewOfJoint {
  int view = 0;
  double weight = 0.0;
  Eigen::Vector2d error;
  Eigen::Matrix<double, 2, 3> by_joint;
  Eigen::Matrix<double, 2, kOfView> by_view;
};

/// The velocity of a keypoint, per frame; NaN where the frames before and after do not show it.
Eigen::Vector2d VelocityOf(const CaptureObservations& capture, const ClipRange& clip, int frame, int view, int joint) {
  const bool is_inside = frame > clip.first && frame + 1 < clip.first + clip.count;
  if (!is_inside || !capture.Sees(frame - 1, view, joint) || !capture.Sees(frame + 1, view, joint)) {
    return Eigen::Vector2d::Constant(std::nan(""));
  }
  return 0.5 * (capture.At(frame + 1, view, joint) - capture.At(frame - 1, view, joint));
}

Eigen::Matrix3d CrossProduct(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// The normal equations of the views' parameters, joints eliminated.
struct NormalEquations {
  Matrix squares;   ///< (P, P)
  Vector products;  ///< (P)
  double cost = 0.0;
  double residuals = 0.0;  ///< their number less the joints' coordinates

  explicit NormalEquations(int parameters)
      : squares(Matrix::Zero(parameters, parameters)), products(Vector::Zero(parameters)) {}
  void Add(const std::vector<ViewOfJoint>& sightings);
};

void NormalEquations::Add(const std::vector<ViewOfJoint>& sightings) {
  if (sightings.size() < 2) return;
  Eigen::Matrix3d of_joint = Eigen::Matrix3d::Zero();
  Eigen::Vector3d joint_products = Eigen::Vector3d::Zero();
  for (const ViewOfJoint& s : sightings) {
    of_joint += s.weight * s.by_joint.transpose() * s.by_joint;
    joint_products += s.weight * s.by_joint.transpose() * s.error;
    cost += s.weight * s.error.squaredNorm();
  }
  of_joint += 1e-6 * of_joint.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d inverse = of_joint.inverse();
  cost -= joint_products.dot(inverse * joint_products);
  residuals += 2.0 * static_cast<double>(sightings.size()) - 3.0;
  std::vector<Eigen::Matrix<double, 3, kOfView>> mixed;
  for (const ViewOfJoint& s : sightings) mixed.emplace_back(s.weight * s.by_joint.transpose() * s.by_view);
  for (std::size_t a = 0; a < sightings.size(); ++a) {
    const ViewOfJoint& s = sightings[a];
    const int row = s.view * kOfView;
    squares.block<kOfView, kOfView>(row, row) += s.weight * s.by_view.transpose() * s.by_view;
    products.segment<kOfView>(row) +=
        s.weight * s.by_view.transpose() * s.error - mixed[a].transpose() * (inverse * joint_products);
    for (std::size_t b = 0; b < sightings.size(); ++b) {
      squares.block<kOfView, kOfView>(row, sightings[b].view * kOfView) -= mixed[a].transpose() * inverse * mixed[b];
    }
  }
}

class Step {
 public:
  Step(const CaptureObservations& capture, const Solution& solution, int clip, const ClockStepOptions& options)
      : capture_(capture),
        solution_(solution),
        clip_(capture.clips[static_cast<std::size_t>(clip)]),
        options_(options),
        sums_(capture.view_count() * kOfView) {}
  [[nodiscard]] std::vector<ClockStep> Run(std::span<const int> frames);

 private:
  [[nodiscard]] std::vector<ViewOfJoint> SightingsOf(int frame, int joint) const;
  /// Where cameras move, those of a frame are eliminated.
  void AddFrame(const NormalEquations& frame);
  [[nodiscard]] std::vector<ClockStep> Solved() const;

  const CaptureObservations& capture_;
  const Solution& solution_;
  const ClipRange& clip_;
  const ClockStepOptions& options_;
  NormalEquations sums_;
};

std::vector<ViewOfJoint> Step::SightingsOf(int frame, int joint) const {
  const RigEstimate& estimate = solution_.estimate;
  const Eigen::Vector3d point = TriangulateJoint(capture_, frame, joint, solution_.scales, estimate).point;
  std::vector<ViewOfJoint> sightings;
  if (!point.allFinite()) return sightings;
  const double from_middle = frame - (clip_.first + 0.5 * (clip_.count - 1));
  for (int v = 0; v < capture_.view_count(); ++v) {
    const CameraEstimate& camera = estimate.CameraAt(frame, v);
    if (!camera.valid || !capture_.Sees(frame, v, joint)) continue;
    const Eigen::Vector2d velocity = VelocityOf(capture_, clip_, frame, v, joint);
    const Eigen::Vector3d in_camera = estimate.InCamera(frame, v, point);
    if (!velocity.allFinite() || !(in_camera.z() > 0.0)) continue;
    const double focal = camera.Focal();
    const Eigen::Vector2d keypoint = capture_.At(frame, v, joint);
    ViewOfJoint& s = sightings.emplace_back();
    s.view = v;
    s.error = DisplacementAtDepth(in_camera, focal, keypoint);
    const double scatter =
        solution_.scales.observation.Scatter(joint, capture_.confidence[capture_.Index(frame, v, joint)]);
    s.weight = CauchyWeight(s.error.norm() / scatter) / (scatter * scatter);
    // Derivatives of the projection times a depth that stays: at its own depth the error would vanish with the scene.
    Eigen::Matrix<double, 2, 3> by_place;  // of the joint in the camera's frame
    by_place << 1, 0, -in_camera.x() / in_camera.z(), 0, 1, -in_camera.y() / in_camera.z();
    s.by_joint = by_place * camera.Rotation();
    s.by_view.leftCols<3>() = -by_place * CrossProduct(in_camera);
    s.by_view.middleCols<3>(3) = by_place;
    s.by_view.col(6) = in_camera.head<2>();
    // Were the view's time later by one frame, it would show here what it showed one frame before.
    s.by_view.col(kOffset) = velocity * in_camera.z() / focal;
    s.by_view.col(kDrift) = from_middle * s.by_view.col(kOffset);
  }
  return sightings;
}

void Step::AddFrame(const NormalEquations& frame) {
  const int views = capture_.view_count();
  std::vector<int> cameras;
  std::vector<int> clocks;
  for (int v = 0; v < views; ++v) {
    // The focal length of one frame is not told from its distance.
    for (int k = 0; k < kOfCamera - 1; ++k) cameras.push_back(v * kOfView + k);
    for (const int k : {kOffset, kDrift}) clocks.push_back(v * kOfView + k);
  }
  Matrix of_cameras = frame.squares(cameras, cameras);
  const double largest = of_cameras.diagonal().maxCoeff();
  if (!(largest > 0.0)) return;
  of_cameras.diagonal().array() += 1e-6 * largest;
  const Eigen::LDLT<Matrix> inverse(of_cameras);
  const Matrix mixed = frame.squares(cameras, clocks);
  const Vector camera_products = frame.products(cameras);
  const Matrix explained = inverse.solve(mixed);
  sums_.squares(clocks, clocks) += frame.squares(clocks, clocks) - mixed.transpose() * explained;
  sums_.products(clocks) += frame.products(clocks) - explained.transpose() * camera_products;
  sums_.cost += frame.cost - camera_products.dot(inverse.solve(camera_products));
  sums_.residuals += std::max(0.0, frame.residuals - static_cast<double>(cameras.size()));
}

std::vector<ClockStep> Step::Solved() const {
  const int views = capture_.view_count();
  std::vector<ClockStep> steps(static_cast<std::size_t>(views));
  std::vector<int> used;
  std::vector<int> moved;
  for (int v = 0; v < views; ++v) {
    const int row = v * kOfView;
    if (capture_.static_cameras) {
      for (int k = 0; k < kOfCamera; ++k) used.push_back(row + k);
    }
    if (options_.fixed[static_cast<std::size_t>(v)] || !(sums_.squares(row + kOffset, row + kOffset) > 0.0)) continue;
    moved.push_back(v);
    used.push_back(row + kOffset);
    used.push_back(row + kDrift);
  }
  if (moved.empty() || !(sums_.residuals > 0.0)) return steps;
  Matrix squares = sums_.squares(used, used);
  // Parameters have different units; damping is relative to each.
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    squares(k, k) += kDamping * squares(k, k) + 1e-12;
    if (used[i] % kOfView == kDrift) squares(k, k) += 1.0 / (options_.drift_deviation * options_.drift_deviation);
  }
  const Eigen::LDLT<Matrix> solver(squares);
  const Vector step = -solver.solve(Vector(sums_.products(used)));
  const Matrix covariance = solver.solve(Matrix::Identity(squares.rows(), squares.cols()));
  const double variance = kDependence * std::max(0.0, sums_.cost) / sums_.residuals;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    ClockStep& of_view = steps[static_cast<std::size_t>(used[i] / kOfView)];
    if (used[i] % kOfView == kOffset) {
      of_view.offset = step[k];
      of_view.offset_deviation = std::sqrt(std::max(0.0, variance * covariance(k, k)));
      of_view.known = std::isfinite(step[k]);
    } else if (used[i] % kOfView == kDrift) {
      of_view.drift = step[k];
    }
  }
  return steps;
}

std::vector<ClockStep> Step::Run(std::span<const int> frames) {
  for (const int frame : EvenlySpread(frames, kFrames)) {
    NormalEquations of_frame(capture_.view_count() * kOfView);
    NormalEquations& sums = capture_.static_cameras ? sums_ : of_frame;
    for (int j = 0; j < capture_.joint_count(); ++j) sums.Add(SightingsOf(frame, j));
    if (!capture_.static_cameras) AddFrame(of_frame);
  }
  return Solved();
}

}  // namespace

std::vector<ClockStep> StepClocks(const CaptureObservations& capture, const Solution& solution, int clip,
                                  std::span<const int> frames, const ClockStepOptions& options) {
  CANONPOSE_CHECK(options.fixed.size() == capture.cameras.size(), "{} views", options.fixed.size());
  return Step(capture, solution, clip, options).Run(frames);
}

}  // namespace canonpose
