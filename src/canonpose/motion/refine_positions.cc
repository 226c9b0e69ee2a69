#include "canonpose/motion/refine_positions.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "canonpose/base/error.h"
#include "canonpose/base/parallel.h"

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kIterations = 4;
/// The root follows the others freely.
constexpr double kRootResistance = 1e-4;
constexpr int kFramesPerPiece = 64;

Matrix3d Cross(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Quaterniond RotationBy(const Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-12) return Quaterniond::Identity();
  return Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

/// Unknowns of a frame: the root's position, then the rotation vector, in the world's axes, of each joint that rotates.
class FrameSolver {
 public:
  FrameSolver(ArticulatedMotion& motion, const std::vector<double>& resistance_mm, const SeenJoints& seen)
      : motion_(motion), seen_(seen), column_(motion.joints.size(), -1), resistance_(3, kRootResistance) {
    for (std::size_t j = 0; j < resistance_mm.size(); ++j) {
      if (resistance_mm[j] <= 0.0) continue;
      column_[j] = size_;
      size_ += 3;
      resistance_.insert(resistance_.end(), 3, resistance_mm[j] * resistance_mm[j]);
    }
    normal_.resize(size_, size_);
    gradient_.resize(size_);
    change_.resize(size_);
  }

  void Solve(std::size_t frame) {
    const std::size_t joints = motion_.joints.size();
    const double* weights = &seen_.weights[frame * joints];
    if (std::all_of(weights, weights + joints, [](double weight) { return weight <= 0.0; })) return;
    change_.setZero();
    for (int i = 0; i < kIterations; ++i) Step(frame);
  }

 private:
  void Step(std::size_t frame) {
    const std::size_t joints = motion_.joints.size();
    ForwardKinematics(motion_, static_cast<int>(frame), positions_, rotations_);
    normal_.setZero();
    gradient_.setZero();
    for (std::size_t j = 0; j < joints; ++j) {
      const double weight = seen_.weights[frame * joints + j];
      if (weight > 0.0) AddPoint(j, seen_.positions_mm[frame * joints + j], weight);
    }
    // Resistance towards the rotations that came in, so it counts the changes of earlier steps, too.
    for (int i = 0; i < size_; ++i) {
      const double resistance = resistance_[static_cast<std::size_t>(i)];
      normal_(i, i) += resistance;
      gradient_(i) -= resistance * (i < 3 ? 0.0 : change_(i));
    }
    const Eigen::VectorXd step = normal_.selfadjointView<Eigen::Lower>().ldlt().solve(gradient_);
    if (!step.allFinite()) return;
    change_ += step;
    Apply(frame, step);
  }

  /// Adds |position + J * step - target|^2 of a joint, whose J has a block for each ancestor that rotates.
  void AddPoint(std::size_t joint, const Vector3d& target, double weight) {
    columns_.assign(1, 0);
    blocks_.assign(1, Matrix3d::Identity());
    for (int j = motion_.joints[joint].parent; j >= 0; j = motion_.joints[static_cast<std::size_t>(j)].parent) {
      const auto ancestor = static_cast<std::size_t>(j);
      if (column_[ancestor] < 0) continue;
      columns_.push_back(column_[ancestor]);
      blocks_.push_back(-Cross(positions_[joint] - positions_[ancestor]));
    }
    const Vector3d error = target - positions_[joint];
    for (std::size_t a = 0; a < columns_.size(); ++a) {
      gradient_.segment<3>(columns_[a]) += weight * blocks_[a].transpose() * error;
      for (std::size_t b = 0; b < columns_.size(); ++b) {
        if (columns_[a] < columns_[b]) continue;
        normal_.block<3, 3>(columns_[a], columns_[b]) += weight * blocks_[a].transpose() * blocks_[b];
      }
    }
  }

  void Apply(std::size_t frame, const Eigen::VectorXd& step) {
    const std::size_t joints = motion_.joints.size();
    motion_.root_position_mm[frame] += step.head<3>();
    Quaterniond* local = &motion_.parent_from_joint[frame * joints];
    for (std::size_t j = 0; j < joints; ++j) {
      if (column_[j] < 0) continue;
      // What is below the joint keeps its rotation relative to it.
      const Quaterniond rotated = RotationBy(step.segment<3>(column_[j])) * rotations_[j];
      const int parent = motion_.joints[j].parent;
      local[j] = parent < 0 ? rotated : rotations_[static_cast<std::size_t>(parent)].conjugate() * rotated;
      local[j].normalize();
    }
  }

  ArticulatedMotion& motion_;
  const SeenJoints& seen_;
  std::vector<int> column_;         // first unknown of each joint's rotation; -1 where it does not rotate
  std::vector<double> resistance_;  // of each unknown
  int size_ = 3;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd change_;
  std::vector<Vector3d> positions_;
  std::vector<Quaterniond> rotations_;
  std::vector<int> columns_;
  std::vector<Matrix3d> blocks_;
};

}  // namespace

void RefinePositions(ArticulatedMotion& motion, const std::vector<double>& resistance_mm, const SeenJoints& seen) {
  const std::size_t joints = motion.joints.size();
  const auto frames = static_cast<std::size_t>(motion.frame_count());
  CANONPOSE_CHECK(resistance_mm.size() == joints && seen.weights.size() == frames * joints &&
                      seen.positions_mm.size() == frames * joints,
                  "{} joints, {} frames, {} resistances, {} weights", joints, frames, resistance_mm.size(),
                  seen.weights.size());
  const int pieces = (motion.frame_count() + kFramesPerPiece - 1) / kFramesPerPiece;
  InParallel(pieces, ThreadsToUse(0), [&](int piece) {
    FrameSolver solver(motion, resistance_mm, seen);
    const auto first = static_cast<std::size_t>(piece) * kFramesPerPiece;
    for (std::size_t t = first; t < std::min(frames, first + kFramesPerPiece); ++t) solver.Solve(t);
  });
}

}  // namespace canonpose
