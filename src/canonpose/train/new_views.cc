#include "canonpose/train/new_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"
#include "canonpose/model/pose_input.h"

namespace canonpose {
namespace {

/// The x axes of two cameras must be 20 degrees apart: tan(10 degrees) squared.
constexpr double kMinSpread = 0.031;
constexpr double kTiltAndRollRad = RadFromDeg(5.0);
constexpr double kLogDistance = 0.15;

/// Root mean square distance of the projected joints from the root, over the joints that have a projection.
double SizeInImage(const std::vector<Eigen::Vector2d>& pixels, int root) {
  double squares = 0.0;
  int known = 0;
  for (const Eigen::Vector2d& pixel : pixels) {
    if (!pixel.allFinite()) continue;
    ++known;
    squares += (pixel - pixels[static_cast<std::size_t>(root)]).squaredNorm();
  }
  return std::sqrt(squares / std::max(1, known));
}

/// Down in a view's camera at a frame; the camera's own y axis where the cameras do not determine it.
Eigen::Vector3d DownInCamera(const Sequence& sequence, const CameraView& view, int t, TrainingTarget target) {
  const auto rotation_of = [&](const CameraView& one) {
    const std::vector<Camera>& cameras = TargetCameras(one, target);
    return cameras[cameras.size() == 1 ? 0 : static_cast<std::size_t>(t)].camera_from_world_rotation;
  };
  std::vector<Eigen::Matrix3d> rotations;
  for (const CameraView& one : sequence.cameras) {
    if (TargetCameras(one, target).empty()) continue;
    const Eigen::Matrix3d rotation = rotation_of(one);
    if (rotation.allFinite()) rotations.push_back(rotation);
  }
  const std::optional<Eigen::Vector3d> down = EstimateDown(rotations);
  return down ? Eigen::Vector3d(rotation_of(view) * *down) : Eigen::Vector3d::UnitY();
}

/// A joint solved from V views has absorbed a part of their errors: about two of its three coordinates are free (bone
/// lengths and smooth motion fix the rest), so that the 2V residuals are smaller than the errors by sqrt(1 - 2 / (2V)).
double ErrorFactor(const Sequence& sequence, std::size_t value) {
  const auto views = std::count_if(sequence.cameras.begin(), sequence.cameras.end(), [&](const CameraView& view) {
    return !view.solved.empty() && std::isfinite(view.solved.positions()[3 * value]) && view.confidence[value] > 0.0F;
  });
  return views < 2 ? 1.0 : std::sqrt(static_cast<double>(views) / static_cast<double>(views - 1));
}

}  // namespace

std::optional<Eigen::Vector3d> EstimateDown(const std::vector<Eigen::Matrix3d>& camera_from_world) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Eigen::Vector3d y_sum = Eigen::Vector3d::Zero();
  for (const Eigen::Matrix3d& rotation : camera_from_world) {
    moments += rotation.row(0).transpose() * rotation.row(0);
    y_sum += rotation.row(1).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);
  const Eigen::Vector3d& spread = solver.eigenvalues();  // ascending
  if (!(spread[1] > kMinSpread * spread[2])) return std::nullopt;
  const Eigen::Vector3d down = solver.eigenvectors().col(0);
  return down.dot(y_sum) < 0.0 ? -down : down;
}

NewViews::NewViews(const std::vector<Dataset>& datasets, const TrainingSet& set, const RowForm& form)
    : set_(set),
      joints_(set.joint_count),
      root_(datasets.front().skeleton.root),
      turns_(form.input.ray != RayForm::kOff),
      down_(static_cast<std::size_t>(set.row_count()), Eigen::Vector3d::UnitY()),
      lens_of_(static_cast<std::size_t>(set.row_count()), -1) {
  const auto values = static_cast<std::size_t>(set.row_count()) * static_cast<std::size_t>(joints_);
  poses_.assign(3 * values, std::numeric_limits<float>::quiet_NaN());
  errors_.assign(2 * values, std::numeric_limits<float>::quiet_NaN());
  for (int row = 0; row < set.row_count(); ++row) AddRow(datasets, form, row);
}

void NewViews::AddRow(const std::vector<Dataset>& datasets, const RowForm& form, int row) {
  const RowSource& source = set_.sources[static_cast<std::size_t>(row)];
  const Dataset& dataset = datasets[static_cast<std::size_t>(source.dataset)];
  const Sequence& sequence = dataset.sequences[static_cast<std::size_t>(source.sequence)];
  const CameraView& view = sequence.cameras[static_cast<std::size_t>(source.camera)];
  const std::vector<Camera>& cameras = TargetCameras(view, form.target);
  if (cameras.empty()) return;
  Lens lens{cameras[cameras.size() == 1 ? 0 : static_cast<std::size_t>(source.frame)], {}};
  if (!lens.camera.K.allFinite()) return;
  if (turns_) lens.turned = PoseInput(form.input, dataset.skeleton).PinholeOf(view, source.frame);

  const auto joints = static_cast<std::size_t>(joints_);
  const std::size_t first = static_cast<std::size_t>(source.frame) * joints;
  const std::size_t offset = static_cast<std::size_t>(row) * joints;
  std::copy_n(TargetPoses(view, form.target).positions().begin() + static_cast<std::ptrdiff_t>(3 * first), 3 * joints,
              poses_.begin() + static_cast<std::ptrdiff_t>(3 * offset));
  std::vector<Eigen::Vector2d> projected;
  for (int j = 0; j < joints_; ++j) projected.push_back(lens.camera.ProjectFromCamera(Joint(row, j)));
  const double size_px = SizeInImage(projected, root_);
  if (!(size_px > 0.0)) return;
  for (std::size_t j = 0; j < joints; ++j) {
    const double factor = form.target == TrainingTarget::kSolved ? ErrorFactor(sequence, first + j) : 1.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double pixel = projected[j][static_cast<Eigen::Index>(axis)];
      errors_[2 * (offset + j) + axis] =
          static_cast<float>(factor * (view.keypoints[2 * (first + j) + axis] - pixel) / size_px);
    }
  }
  down_[static_cast<std::size_t>(row)] = DownInCamera(sequence, view, source.frame, form.target);
  // A static camera has one lens for all its rows.
  const bool is_new = lenses_.empty() || cameras.size() > 1 || lenses_.back().camera.K != lens.camera.K ||
                      lenses_.back().camera.distortion != lens.camera.distortion ||
                      lenses_.back().turned.focal_px != lens.turned.focal_px ||
                      lenses_.back().turned.principal_point_px != lens.turned.principal_point_px;
  if (is_new) lenses_.push_back(lens);
  lens_of_[static_cast<std::size_t>(row)] = static_cast<int>(lenses_.size()) - 1;
  usable_.push_back(row);
}

Eigen::Vector3d NewViews::Joint(int row, int joint) const {
  const float* values = &poses_[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(joints_) +
                                     static_cast<std::size_t>(joint))];
  return {values[0], values[1], values[2]};
}

NewCamera NewViews::Draw(int set_row, Rng& rng) const {
  using Eigen::AngleAxisd;
  const double yaw = rng.Uniform(0.0, 2.0 * std::numbers::pi);
  const double tilt = kTiltAndRollRad * rng.Normal();
  const double roll = kTiltAndRollRad * rng.Normal();
  NewCamera camera;
  camera.rotation = (AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * AngleAxisd(tilt, Eigen::Vector3d::UnitX()) *
                     AngleAxisd(yaw, down_[static_cast<std::size_t>(set_row)]))
                        .toRotationMatrix();
  camera.distance_factor = std::exp(kLogDistance * rng.Normal());
  camera.place = usable_[rng.Index(usable_.size())];
  return camera;
}

bool NewViews::See(int set_row, const NewCamera& camera, const TrainingRow& row) const {
  if (lens_of_[static_cast<std::size_t>(set_row)] < 0) return false;
  const auto joints = static_cast<std::size_t>(joints_);
  const Lens& lens = lenses_[static_cast<std::size_t>(lens_of_[static_cast<std::size_t>(camera.place)])];
  const Eigen::Vector3d old_root = Joint(set_row, root_);
  const Eigen::Vector3d root = camera.distance_factor * old_root.norm() * Joint(camera.place, root_).normalized();
  thread_local std::vector<float> pose;
  thread_local std::vector<Eigen::Vector2d> projected;
  pose.resize(3 * joints);
  projected.resize(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    const Eigen::Vector3d point = camera.rotation * (Joint(set_row, static_cast<int>(j)) - old_root) + root;
    for (std::size_t axis = 0; axis < 3; ++axis)
      pose[3 * j + axis] = static_cast<float>(point[static_cast<Eigen::Index>(axis)]);
    projected[j] = lens.camera.ProjectFromCamera(point);
  }
  const double size_px = SizeInImage(projected, root_);
  const std::size_t place = static_cast<std::size_t>(camera.place) * joints;
  thread_local std::vector<float> keypoints;
  thread_local std::vector<float> confidence;
  keypoints.resize(2 * joints);
  confidence.resize(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      keypoints[2 * j + axis] =
          static_cast<float>(projected[j][static_cast<Eigen::Index>(axis)] + size_px * errors_[2 * (place + j) + axis]);
    }
    confidence[j] = std::isfinite(keypoints[2 * j]) ? set_.confidence[place + j] : 0.0F;
  }
  thread_local NormalisedPose seen;
  Eigen::Matrix3d turned_from_camera;
  if (!NormalisePoseOnAxis(keypoints.data(), confidence.data(), joints_, root_, lens.turned, seen,
                           turned_from_camera)) {
    return false;
  }
  if (!NormaliseTarget(pose.data(), joints_, root_, turned_from_camera, row.target)) return false;
  std::copy(seen.keypoints.begin(), seen.keypoints.end(), row.keypoints);
  std::copy(seen.confidence.begin(), seen.confidence.end(), row.confidence);
  return true;
}

}  // namespace canonpose
