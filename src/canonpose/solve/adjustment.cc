#include "canonpose/solve/adjustment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include "canonpose/base/error.h"
#include "canonpose/solve/ceres_options.h"
#include "canonpose/solve/residuals.h"
#include "canonpose/solve/serial_linear_algebra.h"

namespace canonpose {
namespace {

/// How far the logarithm of a view's image scale may be from the start's.
constexpr double kLogScale = 0.3;

/// Builds the problem term by term; Run() is the outline.
class AdjustmentProblem {
 public:
  AdjustmentProblem(const CaptureObservations& capture, std::span<const int> frames, const AdjustmentOptions& options,
                    CaptureLenses* lenses, RigEstimate& estimate)
      : capture_(capture),
        frames_(frames),
        runs_(RunsOf(capture, frames)),
        options_(options),
        lenses_(lenses),
        estimate_(estimate),
        problem_(ProblemOptions()),
        observation_loss_(options.loss_scale),
        acceleration_loss_(1.5) {}

  AdjustmentSummary Run();

 private:
  void AddObservations();
  void AddBones();
  void AddUnit();
  void AddAccelerations();
  void AddCameraMotion();
  void AddFocalPriors();
  void AddLensPriors();
  void FixWhatIsKnown();
  AdjustmentSummary Solve();
  static ceres::Problem::Options ProblemOptions() {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }
  [[nodiscard]] bool IsSolved(int frame, int joint) const { return estimate_.Joint(frame, joint).allFinite(); }
  double* JointData(int frame, int joint) { return estimate_.Joint(frame, joint).data(); }
  /// Whether frame i is at least the `length`-th of its run.
  [[nodiscard]] bool FollowsRun(std::size_t i, std::size_t length) const {
    return i + 1 >= length && runs_[i] == runs_[i + 1 - length];
  }
  void AddFreeObservation(int frame, int view, int joint, double weight);
  void AddFreeObservations(int frame, int view, double weight);
  void AddKnownObservations(int frame, int joint);
  [[nodiscard]] double ObservationWeight(int frame, int view) const {
    return 1.0 / estimate_.ImageScale(frame, view, capture_.skeleton.root);
  }

  const CaptureObservations& capture_;
  std::span<const int> frames_;
  std::vector<int> runs_;
  const AdjustmentOptions& options_;
  CaptureLenses* lenses_;  ///< null: those that keypoints have been undistorted with
  RigEstimate& estimate_;
  ceres::Problem problem_;
  ceres::CauchyLoss observation_loss_;
  ceres::HuberLoss acceleration_loss_;
  ceres::QuaternionManifold quaternions_;
  bool has_observations_ = false;
};

void AdjustmentProblem::AddFreeObservation(int frame, int view, int joint, double weight) {
  CameraEstimate& camera = estimate_.CameraAt(frame, view);
  const Eigen::Vector2d observed = capture_.At(frame, view, joint);
  if (lenses_ == nullptr) {
    ceres::CostFunction* term = estimate_.static_cameras ? ReprojectionTerm<false>::Create(observed, weight)
                                                         : ReprojectionTerm<true>::Create(observed, weight);
    problem_.AddResidualBlock(term, &observation_loss_, camera.quaternion.data(), camera.placement.data(),
                              &camera.log_focal, JointData(frame, joint));
    return;
  }
  const auto v = static_cast<std::size_t>(view);
  const Eigen::Vector2d recorded = capture_.cameras[v].lens.Distort(observed);
  RadialLens& lens = lenses_->lenses[static_cast<std::size_t>(lenses_->of_view[v])];
  ceres::CostFunction* term = estimate_.static_cameras ? LensReprojectionTerm<false>::Create(recorded, weight)
                                                       : LensReprojectionTerm<true>::Create(recorded, weight);
  problem_.AddResidualBlock(term, &observation_loss_, camera.quaternion.data(), camera.placement.data(),
                            &camera.log_focal, JointData(frame, joint), lens.at_corner.data());
}

void AdjustmentProblem::AddFreeObservations(int frame, int view, double weight) {
  for (int j = 0; j < capture_.joint_count(); ++j) {
    if (!capture_.Sees(frame, view, j) || !IsSolved(frame, j)) continue;
    const double confidence = capture_.confidence[capture_.Index(frame, view, j)];
    AddFreeObservation(frame, view, j, weight / options_.scales.observation.Scatter(j, confidence));
    has_observations_ = true;
  }
}

void AdjustmentProblem::AddKnownObservations(int frame, int joint) {
  if (!IsSolved(frame, joint)) return;
  std::vector<KnownView> views;
  for (int v = 0; v < capture_.view_count(); ++v) {
    const CameraEstimate& camera = estimate_.CameraAt(frame, v);
    if (!camera.valid || !capture_.Sees(frame, v, joint)) continue;
    const double weight =
        ObservationWeight(frame, v) /
        options_.scales.observation.Scatter(joint, capture_.confidence[capture_.Index(frame, v, joint)]);
    if (!(weight > 0.0) || !std::isfinite(weight)) continue;
    views.push_back(
        {camera.Rotation(), estimate_.Translation(frame, v), camera.Focal(), capture_.At(frame, v, joint), weight});
  }
  if (views.empty()) return;
  problem_.AddResidualBlock(new JointInViewsTerm(std::move(views), options_.loss_scale), nullptr,
                            JointData(frame, joint));
  has_observations_ = true;
}

void AdjustmentProblem::AddObservations() {
  for (const int frame : frames_) {
    if (!options_.free_cameras) {
      for (int j = 0; j < capture_.joint_count(); ++j) AddKnownObservations(frame, j);
      continue;
    }
    for (int v = 0; v < capture_.view_count(); ++v) {
      if (!estimate_.CameraAt(frame, v).valid) continue;
      const double weight = ObservationWeight(frame, v);
      if (weight > 0.0 && std::isfinite(weight)) AddFreeObservations(frame, v, weight);
    }
  }
}

void AdjustmentProblem::AddBones() {
  for (const int frame : frames_) {
    std::vector<double>& lengths = estimate_.log_bone_lengths[static_cast<std::size_t>(capture_.ClipOf(frame).subject)];
    for (int j = 0; j < capture_.joint_count(); ++j) {
      const int parent = capture_.skeleton.parents[static_cast<std::size_t>(j)];
      if (parent < 0 || !IsSolved(frame, j) || !IsSolved(frame, parent)) continue;
      if (!std::isfinite(lengths[static_cast<std::size_t>(j)])) continue;
      problem_.AddResidualBlock(BoneTerm::Create(1.0 / options_.scales.bone), nullptr, JointData(frame, j),
                                JointData(frame, parent), &lengths[static_cast<std::size_t>(j)]);
    }
  }
}

void AdjustmentProblem::AddUnit() {
  constexpr double kWeight = 1e3;
  if (!options_.free_bones) return;
  // Of all subjects together: the start makes everybody equally large, and if that had to hold for one of them, who is
  // small would have to make everything else larger.
  std::vector<double*> bones;
  std::vector<int> bones_of_bodies;
  for (std::vector<double>& lengths : estimate_.log_bone_lengths) {
    const std::size_t before = bones.size();
    for (double& length : lengths) {
      if (problem_.HasParameterBlock(&length)) bones.push_back(&length);
    }
    if (bones.size() > before) bones_of_bodies.push_back(static_cast<int>(bones.size() - before));
  }
  if (!bones.empty()) problem_.AddResidualBlock(new UnitTerm(std::move(bones_of_bodies), kWeight), nullptr, bones);
}

void AdjustmentProblem::AddAccelerations() {
  if (options_.scales.acceleration.empty()) return;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!FollowsRun(i, 3)) continue;
    for (int j = 0; j < capture_.joint_count(); ++j) {
      const int last = frames_[i];
      if (!IsSolved(last - 2, j) || !IsSolved(last - 1, j) || !IsSolved(last, j)) continue;
      problem_.AddResidualBlock(new AccelerationTerm(1.0 / options_.scales.acceleration[static_cast<std::size_t>(j)]),
                                &acceleration_loss_, JointData(last - 2, j), JointData(last - 1, j),
                                JointData(last, j));
    }
  }
}

void AdjustmentProblem::AddCameraMotion() {
  if (estimate_.static_cameras || !options_.free_cameras) return;
  const AdjustmentScales& scales = options_.scales;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!FollowsRun(i, 2)) continue;
    const double fps = capture_.ClipOf(frames_[i]).fps;
    for (int v = 0; v < capture_.view_count(); ++v) {
      CameraEstimate& now = estimate_.CameraAt(frames_[i], v);
      CameraEstimate& before = estimate_.CameraAt(frames_[i] - 1, v);
      if (!now.valid || !before.valid) continue;
      problem_.AddResidualBlock(AngularVelocityTerm::Create(fps / scales.angular_velocity), nullptr,
                                before.quaternion.data(), now.quaternion.data());
      problem_.AddResidualBlock(ZoomTerm::Create(std::sqrt(fps) / scales.zoom_per_second), nullptr, &before.log_focal,
                                &now.log_focal);
      if (!FollowsRun(i, 3)) continue;
      CameraEstimate& earlier = estimate_.CameraAt(frames_[i] - 2, v);
      if (!earlier.valid) continue;
      problem_.AddResidualBlock(AngularAccelerationTerm::Create(fps * fps / scales.angular_acceleration), nullptr,
                                earlier.quaternion.data(), before.quaternion.data(), now.quaternion.data());
    }
  }
}

void AdjustmentProblem::AddFocalPriors() {
  if (!options_.free_cameras) return;
  // A static camera has one prior. A moving one has one in each frame, which together weigh as much as that.
  const double weight = estimate_.static_cameras ? 1.0 : 1.0 / std::sqrt(static_cast<double>(frames_.size()));
  const int frame_count = estimate_.static_cameras ? 1 : static_cast<int>(frames_.size());
  for (int i = 0; i < frame_count; ++i) {
    for (int v = 0; v < capture_.view_count(); ++v) {
      CameraEstimate& camera = estimate_.CameraAt(frames_[static_cast<std::size_t>(i)], v);
      if (!camera.valid) continue;
      if (!estimate_.static_cameras && problem_.HasParameterBlock(camera.placement.data())) {
        // Weak, for views that see too little to determine their scale.
        problem_.AddResidualBlock(ScalePriorTerm::Create(camera.placement[2], 1.0 / kLogScale), nullptr,
                                  camera.placement.data());
      }
      const std::vector<double>& expected = options_.scales.expected_log_focal;
      problem_.AddResidualBlock(PriorTerm::Create(expected.empty() ? 0.0 : expected[static_cast<std::size_t>(v)],
                                                  weight / options_.scales.log_focal),
                                nullptr, &camera.log_focal);
    }
  }
  if (!estimate_.static_cameras) return;
  for (int v = 0; v < capture_.view_count(); ++v) {
    for (int w = 0; w < v; ++w) {
      CameraEstimate& a = estimate_.CameraAt(frames_.front(), v);
      CameraEstimate& b = estimate_.CameraAt(frames_.front(), w);
      if (!a.valid || !b.valid) continue;
      problem_.AddResidualBlock(ZoomTerm::Create(1.0 / options_.scales.log_focal_between_cameras), nullptr,
                                &a.log_focal, &b.log_focal);
    }
  }
}

void AdjustmentProblem::AddLensPriors() {
  if (lenses_ == nullptr) return;
  const auto weights = [](const std::array<double, 2>& scatter, double factor) {
    return Eigen::Vector2d(factor / scatter[0], factor / scatter[1]);
  };
  std::vector<double*> found;
  for (RadialLens& lens : lenses_->lenses) {
    if (problem_.HasParameterBlock(lens.at_corner.data())) found.push_back(lens.at_corner.data());
  }
  // However many lenses there are, the differences of each from the others weigh as much as from two.
  const double share = std::sqrt(2.0 / std::max(1.0, static_cast<double>(found.size()) - 1.0));
  for (std::size_t i = 0; i < found.size(); ++i) {
    problem_.AddResidualBlock(LensPriorTerm::Create(weights(options_.scales.lens, 1.0)), nullptr, found[i]);
    for (std::size_t k = 0; k < i; ++k) {
      problem_.AddResidualBlock(LensDifferenceTerm::Create(weights(options_.scales.lens_between_cameras, share)),
                                nullptr, found[i], found[k]);
    }
  }
}

void AdjustmentProblem::FixWhatIsKnown() {
  if (options_.free_cameras) {
    for (const int frame : frames_) {
      for (int v = 0; v < capture_.view_count(); ++v) {
        CameraEstimate& camera = estimate_.CameraAt(frame, v);
        if (!problem_.HasParameterBlock(camera.quaternion.data())) continue;
        problem_.SetManifold(camera.quaternion.data(), &quaternions_);
        if (v != options_.fixed_view || !estimate_.static_cameras) continue;
        problem_.SetParameterBlockConstant(camera.quaternion.data());
        problem_.SetParameterBlockConstant(camera.placement.data());
      }
      if (estimate_.static_cameras) break;
    }
  }
  if (!estimate_.static_cameras) {
    // The world of each frame is centred on the root.
    for (const int frame : frames_) {
      double* root = JointData(frame, capture_.skeleton.root);
      if (problem_.HasParameterBlock(root)) problem_.SetParameterBlockConstant(root);
    }
  }
  if (options_.free_bones) return;
  for (std::vector<double>& lengths : estimate_.log_bone_lengths) {
    for (double& length : lengths) {
      if (problem_.HasParameterBlock(&length)) problem_.SetParameterBlockConstant(&length);
    }
  }
}

/// From Ceres's summary; the reason is its message.
AdjustmentSummary Summarise(const ceres::Solver::Summary& found) {
  AdjustmentSummary summary;
  if (found.termination_type == ceres::CONVERGENCE) summary.ending = AdjustmentEnding::kConverged;
  if (found.termination_type == ceres::NO_CONVERGENCE) summary.ending = AdjustmentEnding::kIterationLimit;
  summary.reason = found.message;
  std::ranges::replace(summary.reason, '\n', ' ');
  while (summary.reason.ends_with('.') || summary.reason.ends_with(' ')) summary.reason.pop_back();
  // The first entry is the start.
  summary.iterations = std::max(0, static_cast<int>(found.iterations.size()) - 1);
  if (found.initial_cost >= 0.0) summary.initial_cost = found.initial_cost;  // -1 where it could not be computed
  if (found.final_cost >= 0.0) summary.final_cost = found.final_cost;
  return summary;
}

AdjustmentSummary AdjustmentProblem::Run() {
  AddObservations();
  AddBones();
  AddUnit();
  AddAccelerations();
  AddCameraMotion();
  AddFocalPriors();
  AddLensPriors();
  FixWhatIsKnown();
  return Solve();
}

AdjustmentSummary AdjustmentProblem::Solve() {
  if (!has_observations_) return {.reason = "no camera whose pose is known sees a joint whose position is known"};
  ceres::Solver::Options options = SerialOptions(ceres::SPARSE_NORMAL_CHOLESKY, options_.iterations);
  options.function_tolerance = 1e-5;
  options.parameter_tolerance = 1e-7;
  ceres::Solver::Summary summary;
  const OneOpenMpThread one_thread;
  ceres::Solve(options, &problem_, &summary);
  return Summarise(summary);
}

}  // namespace

std::vector<int> RunsOf(const CaptureObservations& capture, std::span<const int> frames) {
  std::vector<int> runs(frames.size(), 0);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const bool follows = frames[i] == frames[i - 1] + 1 && capture.ClipOf(frames[i]).first != frames[i];
    runs[i] = runs[i - 1] + (follows ? 0 : 1);
  }
  return runs;
}

const char* NameOf(AdjustmentEnding ending) {
  switch (ending) {
    case AdjustmentEnding::kConverged:
      return "converged";
    case AdjustmentEnding::kIterationLimit:
      return "stopped early";
    case AdjustmentEnding::kFailed:
      return "failed";
  }
  return "";
}

AdjustmentSummary Adjust(const CaptureObservations& capture, std::span<const int> frames,
                         const AdjustmentOptions& options, RigEstimate& estimate) {
  return AdjustmentProblem(capture, frames, options, nullptr, estimate).Run();
}

AdjustmentSummary AdjustWithLenses(const CaptureObservations& capture, std::span<const int> frames,
                                   const AdjustmentOptions& options, CaptureLenses& lenses, RigEstimate& estimate) {
  CANONPOSE_CHECK(options.free_cameras && lenses.of_view.size() == capture.cameras.size(), "{}", lenses.of_view.size());
  return AdjustmentProblem(capture, frames, options, &lenses, estimate).Run();
}

}  // namespace canonpose
