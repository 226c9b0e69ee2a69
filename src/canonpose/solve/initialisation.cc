#include "canonpose/solve/initialisation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "canonpose/base/median.h"

namespace canonpose {
namespace {

/// Weight of the start pose relative to a view of full confidence. Chosen by hand.
constexpr double kPoseWeight = 0.05;
constexpr int kShapeRounds = 3;
constexpr int kSizeRounds = 3;
/// How far a joint is from where the start's poses place it, in units of its bone's length.
constexpr double kStartScatter = 0.3;
/// The start counts in directions in which the views leave a joint more open than this, in units of that and of the
/// scatter of a typical keypoint: at this scatter, two views are about 30 degrees from opposite.
constexpr double kOpenScatter = 0.5;
constexpr double kOpenScatters = 4.0;

double SumOfBones(const Skeleton& skeleton, const Points3d& joints) {
  double sum = 0.0;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.parents[static_cast<std::size_t>(j)];
    if (parent >= 0) sum += (joints.row(j) - joints.row(parent)).norm();
  }
  return sum;
}

/// The mean of the start's poses in the world, (J, 3).
Points3d MeanStart(const CaptureObservations& capture, int frame, std::span<const Eigen::Matrix3d> camera_from_world,
                   const std::vector<int>& views, bool mirrored) {
  Points3d mean = Points3d::Zero(capture.joint_count(), 3);
  for (const int v : views) {
    Points3d pose = capture.StartOf(frame, v);
    if (mirrored) pose.col(2) *= -1.0;
    mean += pose * camera_from_world[static_cast<std::size_t>(v)];  // rows: (R^T p)^T = p^T R
  }
  return mean / static_cast<double>(views.size());
}

/// The scale of a view by least squares: its keypoints relative to the root against the projected joints.
double ImageScaleOf(const CaptureObservations& capture, int frame, int view, const Eigen::Matrix3d& rotation,
                    const Points3d& joints) {
  const Eigen::Vector2d root = capture.At(frame, view, capture.skeleton.root);
  double product = 0.0;
  double squares = 0.0;
  for (int j = 0; j < capture.joint_count(); ++j) {
    if (!capture.Sees(frame, view, j)) continue;
    const double weight = std::pow(capture.confidence[capture.Index(frame, view, j)], 2);
    const Eigen::Vector2d projected = (rotation * joints.row(j).transpose()).head<2>();
    product += weight * projected.dot(capture.At(frame, view, j) - root);
    squares += weight * projected.squaredNorm();
  }
  return squares > 0.0 ? product / squares : 0.0;
}

void RefineShape(const CaptureObservations& capture, int frame, std::span<const Eigen::Matrix3d> camera_from_world,
                 const std::vector<int>& views, const Points3d& prior, FrameShape& shape) {
  for (int j = 0; j < capture.joint_count(); ++j) {
    Eigen::Matrix3d normal = kPoseWeight * Eigen::Matrix3d::Identity();
    Eigen::Vector3d right = kPoseWeight * prior.row(j).transpose();
    for (const int v : views) {
      if (!capture.Sees(frame, v, j)) continue;
      const double weight = std::pow(capture.confidence[capture.Index(frame, v, j)], 2);
      const Eigen::Matrix<double, 2, 3> rows = camera_from_world[static_cast<std::size_t>(v)].topRows<2>();
      const Eigen::Vector2d seen = (capture.At(frame, v, j) - capture.At(frame, v, capture.skeleton.root)) /
                                   shape.scales[static_cast<std::size_t>(v)];
      normal += weight * rows.transpose() * rows;
      right += weight * rows.transpose() * seen;
    }
    shape.joints.row(j) = (normal.inverse() * right).transpose();
  }
  shape.joints.rowwise() -= shape.joints.row(capture.skeleton.root).eval();
}

/// The root in the camera's frame.
Eigen::Vector3d RootInCamera(const CaptureObservations& capture, int frame, int view, double focal, double scale) {
  const Eigen::Vector2d root = capture.At(frame, view, capture.skeleton.root);
  return {root.x() / scale, root.y() / scale, focal / scale};
}

Eigen::Vector3d MedianPoint(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d median;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    median[axis] = Median(values);
  }
  return median;
}

/// Finds the translations of static cameras one after the other, next always the camera that shares most frames with
/// those already found. Returns the root's position in the world in each of `frames`; NaN where no camera gives it.
std::vector<Eigen::Vector3d> ChainTranslations(const CaptureObservations& capture, std::span<const int> frames,
                                               std::span<const Eigen::Matrix3d> camera_from_world,
                                               const std::vector<FrameShape>& shapes, RigEstimate& estimate) {
  const auto views = static_cast<std::size_t>(capture.view_count());
  std::vector<Eigen::Vector3d> root(frames.size());
  for (CameraEstimate& camera : estimate.cameras) camera.valid = false;
  const auto place_roots = [&] {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int count = 0;
      for (std::size_t v = 0; v < views; ++v) {
        if (!estimate.cameras[v].valid || shapes[i].scales[v] <= 0.0) continue;
        const Eigen::Vector3d in_camera =
            RootInCamera(capture, frames[i], static_cast<int>(v), estimate.cameras[v].Focal(), shapes[i].scales[v]);
        sum +=
            camera_from_world[v].transpose() * (in_camera - Eigen::Vector3d::Map(estimate.cameras[v].placement.data()));
        ++count;
      }
      root[i] = count > 0 ? Eigen::Vector3d(sum / count) : Eigen::Vector3d::Constant(std::nan(""));
    }
  };
  for (std::size_t known = 0; known < views; ++known) {
    place_roots();
    std::vector<Eigen::Vector3d> best;
    std::size_t next = views;
    for (std::size_t v = 0; v < views; ++v) {
      if (estimate.cameras[v].valid || !camera_from_world[v].allFinite()) continue;
      std::vector<Eigen::Vector3d> translations;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!(shapes[i].scales[v] > 0.0)) continue;
        const Eigen::Vector3d in_camera =
            RootInCamera(capture, frames[i], static_cast<int>(v), estimate.cameras[v].Focal(), shapes[i].scales[v]);
        if (known == 0) {
          translations.emplace_back(Eigen::Vector3d::Zero());  // the first camera is the world
        } else if (root[i].allFinite()) {
          translations.emplace_back(in_camera - camera_from_world[v] * root[i]);
        }
      }
      if (translations.size() <= best.size()) continue;
      best = std::move(translations);
      next = v;
    }
    if (next == views) break;
    Eigen::Vector3d::Map(estimate.cameras[next].placement.data()) = MedianPoint(best);
    estimate.cameras[next].valid = true;
  }
  place_roots();
  return root;
}

/// How large the subjects are in comparison (S), 1 in the mean: placed by two cameras, the root of somebody who is
/// taken for too large is too far from both. Is all ones where the cameras do not tell.
std::vector<double> CompareSizes(const CaptureObservations& capture, std::span<const int> frames,
                                 std::span<const Eigen::Matrix3d> camera_from_world,
                                 const std::vector<FrameShape>& shapes, const RigEstimate& estimate) {
  std::vector<std::vector<double>> found(capture.subjects.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    // Of the cameras that see somebody: the root from the camera, and the origin from there, in the world's axes.
    std::vector<Eigen::Vector3d> roots;
    std::vector<Eigen::Vector3d> origins;
    for (std::size_t v = 0; v < estimate.cameras.size(); ++v) {
      const CameraEstimate& camera = estimate.cameras[v];
      const double scale = shapes[i].scales[v];
      if (!camera.valid || !(scale > 0.0)) continue;
      const Eigen::Matrix3d world_from_camera = camera_from_world[v].transpose();
      roots.emplace_back(world_from_camera *
                         RootInCamera(capture, frames[i], static_cast<int>(v), camera.Focal(), scale));
      origins.emplace_back(world_from_camera * Eigen::Vector3d::Map(camera.placement.data()));
    }
    // Two cameras agree on the root where size * (root - other root) = origin - other origin.
    double product = 0.0;
    double squares = 0.0;
    for (std::size_t a = 0; a < roots.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const Eigen::Vector3d difference = roots[a] - roots[b];
        product += difference.dot(origins[a] - origins[b]);
        squares += difference.squaredNorm();
      }
    }
    const auto subject = static_cast<std::size_t>(capture.ClipOf(frames[i]).subject);
    if (product > 0.0) found[subject].push_back(product / squares);
  }
  std::vector<double> sizes;
  double sum = 0.0;
  for (std::vector<double>& ratios : found) {
    sizes.push_back(ratios.empty() ? 1.0 : std::clamp(Median(std::move(ratios)), 0.5, 2.0));
    sum += sizes.back();
  }
  for (double& size : sizes) size *= static_cast<double>(sizes.size()) / sum;
  return sizes;
}

/// The joints of a skeleton, each after its parent.
std::vector<int> FromTheRoot(const Skeleton& skeleton) {
  std::vector<int> order = {skeleton.root};
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      if (skeleton.parents[static_cast<std::size_t>(j)] == order[i]) order.push_back(j);
    }
  }
  return order;
}

/// Where a joint is if its bone has its length and the direction that the start's poses give; NaN where unknown.
class StartDirections {
 public:
  StartDirections(const CaptureObservations& capture, int frame, bool mirrored, const RigEstimate& estimate)
      : capture_(capture),
        frame_(frame),
        estimate_(estimate),
        lengths_(estimate.log_bone_lengths[static_cast<std::size_t>(capture.ClipOf(frame).subject)]) {
    std::vector<int> views;
    std::vector<Eigen::Matrix3d> rotations(static_cast<std::size_t>(capture.view_count()));
    for (int v = 0; v < capture.view_count(); ++v) {
      if (!estimate.CameraAt(frame, v).valid || !capture.HasStart(frame, v)) continue;
      views.push_back(v);
      rotations[static_cast<std::size_t>(v)] = estimate.CameraAt(frame, v).Rotation();
    }
    if (!views.empty()) mean_ = MeanStart(capture, frame, rotations, views, mirrored);
  }

  [[nodiscard]] double Length(int joint) const { return std::exp(lengths_[static_cast<std::size_t>(joint)]); }
  [[nodiscard]] Eigen::Vector3d Place(int joint) const {
    const int parent = capture_.skeleton.parents[static_cast<std::size_t>(joint)];
    if (parent < 0 || mean_.size() == 0 || mean_.row(joint).isZero()) return Unknown();
    const Eigen::Vector3d direction = (mean_.row(joint) - mean_.row(parent)).transpose();
    return estimate_.Joint(frame_, parent) + Length(joint) * direction.normalized();
  }

 private:
  static Eigen::Vector3d Unknown() { return Eigen::Vector3d::Constant(std::nan("")); }

  const CaptureObservations& capture_;
  int frame_;
  const RigEstimate& estimate_;
  const std::vector<double>& lengths_;
  Points3d mean_;  ///< (J, 3) in the world; empty where no view has a start
};

/// Keeps joints near where the start's poses place them in directions in which the views leave them open, as two views
/// from opposite sides do. `points` (J) are the joints as the views show them, `typical` the scatter of a keypoint.
void SteadyByStart(const StartDirections& start, std::span<const RobustPoint> points, const Skeleton& skeleton,
                   double typical, int frame, RigEstimate& estimate) {
  for (const int j : FromTheRoot(skeleton)) {
    const RobustPoint& found = points[static_cast<std::size_t>(j)];
    const Eigen::Vector3d expected = start.Place(j);
    if (!found.point.allFinite() || !expected.allFinite()) continue;
    const double scatter = kStartScatter * start.Length(j);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(found.information);
    Eigen::Vector3d point = found.point;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d direction = axes.eigenvectors().col(axis);
      const double variance = 1.0 / std::max(axes.eigenvalues()[axis], 1e-12);
      if (std::sqrt(variance) < std::max(kOpenScatter * scatter, kOpenScatters * typical)) continue;
      const double share = variance / (variance + scatter * scatter);
      point += share * direction.dot(expected - found.point) * direction;
    }
    estimate.Joint(frame, j) = point;
  }
}

/// Places joints that only one view sees where the start's poses place them.
void FillFromStart(const CaptureObservations& capture, const StartDirections& start, int frame, RigEstimate& estimate) {
  for (const int j : FromTheRoot(capture.skeleton)) {
    if (estimate.Joint(frame, j).allFinite()) continue;
    bool is_seen = false;
    for (int v = 0; v < capture.view_count(); ++v) {
      is_seen = is_seen || (estimate.CameraAt(frame, v).valid && capture.Sees(frame, v, j));
    }
    if (is_seen) estimate.Joint(frame, j) = start.Place(j);
  }
}

}  // namespace

Eigen::Matrix3d MirrorRotation(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d flip(1.0, 1.0, -1.0);
  return flip.asDiagonal() * rotation * flip.asDiagonal();
}

FrameShape ShapeFromViews(const CaptureObservations& capture, int frame,
                          std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored) {
  FrameShape shape;
  shape.scales.assign(static_cast<std::size_t>(capture.view_count()), 0.0);
  std::vector<int> views;
  for (int v = 0; v < capture.view_count(); ++v) {
    if (capture.HasStart(frame, v) && camera_from_world[static_cast<std::size_t>(v)].allFinite()) views.push_back(v);
  }
  if (views.size() < 2) return shape;
  const Points3d mean = MeanStart(capture, frame, camera_from_world, views, mirrored);
  shape.joints = mean;
  for (int round = 0; round <= kShapeRounds; ++round) {
    for (const int v : views) {
      double& scale = shape.scales[static_cast<std::size_t>(v)];
      scale = ImageScaleOf(capture, frame, v, camera_from_world[static_cast<std::size_t>(v)], shape.joints);
      if (!(scale > 1e-9)) return shape;  // the views contradict each other
    }
    if (round < kShapeRounds) RefineShape(capture, frame, camera_from_world, views, mean, shape);
  }
  const double unit = SumOfBones(capture.skeleton, shape.joints);
  if (!(unit > 0.0) || !std::isfinite(unit)) return shape;
  shape.joints /= unit;
  for (double& scale : shape.scales) scale *= unit;
  shape.valid = true;
  return shape;
}

RigEstimate InitialiseStatic(const CaptureObservations& capture, std::span<const int> frames,
                             std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored, double focal) {
  RigEstimate estimate = RigEstimate::Unknown(true, capture.frame_count, capture.view_count(), capture.joint_count(),
                                              static_cast<int>(capture.subjects.size()));
  std::vector<FrameShape> shapes;
  shapes.reserve(frames.size());
  for (const int frame : frames) {
    shapes.push_back(ShapeFromViews(capture, frame, camera_from_world, mirrored));
    if (!shapes.back().valid) std::fill(shapes.back().scales.begin(), shapes.back().scales.end(), 0.0);
  }
  for (std::size_t v = 0; v < estimate.cameras.size(); ++v) {
    if (camera_from_world[v].allFinite()) estimate.cameras[v].SetRotation(camera_from_world[v]);
    estimate.cameras[v].log_focal = std::log(focal);
  }
  std::vector<Eigen::Vector3d> roots = ChainTranslations(capture, frames, camera_from_world, shapes, estimate);
  // The start knows no sizes. Where several people are seen, cameras and sizes are found in turns.
  for (int round = 0; round < kSizeRounds && capture.subjects.size() > 1; ++round) {
    const std::vector<double> sizes = CompareSizes(capture, frames, camera_from_world, shapes, estimate);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const double size = sizes[static_cast<std::size_t>(capture.ClipOf(frames[i]).subject)];
      shapes[i].joints *= size;
      for (double& scale : shapes[i].scales) scale /= size;
    }
    roots = ChainTranslations(capture, frames, camera_from_world, shapes, estimate);
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!shapes[i].valid || !roots[i].allFinite()) continue;
    for (int j = 0; j < capture.joint_count(); ++j) {
      estimate.Joint(frames[i], j) = roots[i] + shapes[i].joints.row(j).transpose();
    }
  }
  MeasureBones(capture, frames, estimate);
  return estimate;
}

RigEstimate InitialiseMoving(const CaptureObservations& capture, std::span<const int> frames,
                             const std::vector<std::vector<Eigen::Matrix3d>>& camera_from_world, bool mirrored) {
  RigEstimate estimate = RigEstimate::Unknown(false, capture.frame_count, capture.view_count(), capture.joint_count(),
                                              static_cast<int>(capture.subjects.size()));
  for (const int frame : frames) {
    const std::vector<Eigen::Matrix3d>& rotations = camera_from_world[static_cast<std::size_t>(frame)];
    const FrameShape shape = ShapeFromViews(capture, frame, rotations, mirrored);
    if (!shape.valid) continue;
    for (int j = 0; j < capture.joint_count(); ++j) estimate.Joint(frame, j) = shape.joints.row(j).transpose();
    for (int v = 0; v < capture.view_count(); ++v) {
      const double scale = shape.scales[static_cast<std::size_t>(v)];
      if (!(scale > 0.0)) continue;
      CameraEstimate& camera = estimate.CameraAt(frame, v);
      camera.SetRotation(rotations[static_cast<std::size_t>(v)]);
      const Eigen::Vector2d root = capture.At(frame, v, capture.skeleton.root);
      camera.placement = {root.x(), root.y(), std::log(scale)};
      camera.valid = true;
    }
  }
  MeasureBones(capture, frames, estimate);
  return estimate;
}

RobustPoint TriangulateJoint(const CaptureObservations& capture, int frame, int joint, const AdjustmentScales& scales,
                             const RigEstimate& estimate, int left_out_view) {
  std::vector<PointRay> rays;
  for (int v = 0; v < capture.view_count(); ++v) {
    const CameraEstimate& camera = estimate.CameraAt(frame, v);
    if (v == left_out_view || !camera.valid || !capture.Sees(frame, v, joint)) continue;
    rays.push_back({camera.Rotation(), estimate.Translation(frame, v), capture.At(frame, v, joint) / camera.Focal(),
                    scales.observation.Scatter(joint, capture.confidence[capture.Index(frame, v, joint)])});
  }
  return TriangulateRobustly(rays);
}

void TriangulateFrame(const CaptureObservations& capture, int frame, const AdjustmentScales& scales, bool mirrored,
                      RigEstimate& estimate) {
  std::vector<RobustPoint> points;
  for (int j = 0; j < capture.joint_count(); ++j) {
    points.push_back(TriangulateJoint(capture, frame, j, scales, estimate));
    estimate.Joint(frame, j) = points.back().point;
  }
  const StartDirections start(capture, frame, mirrored, estimate);
  SteadyByStart(start, points, capture.skeleton, scales.observation.Typical(), frame, estimate);
  FillFromStart(capture, start, frame, estimate);
}

void MeasureBones(const CaptureObservations& capture, std::span<const int> frames, RigEstimate& estimate) {
  const Skeleton& skeleton = capture.skeleton;
  for (std::size_t subject = 0; subject < capture.subjects.size(); ++subject) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      const int parent = skeleton.parents[static_cast<std::size_t>(j)];
      if (parent < 0) continue;
      std::vector<double> lengths;
      for (const int frame : frames) {
        if (capture.ClipOf(frame).subject != static_cast<int>(subject)) continue;
        const double length = (estimate.Joint(frame, j) - estimate.Joint(frame, parent)).norm();
        if (std::isfinite(length)) lengths.push_back(length);
      }
      if (!lengths.empty()) {
        estimate.log_bone_lengths[subject][static_cast<std::size_t>(j)] =
            std::log(std::max(Median(std::move(lengths)), 1e-4));
      }
    }
  }
}

}  // namespace canonpose
