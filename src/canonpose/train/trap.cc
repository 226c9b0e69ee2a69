#include "canonpose/train/trap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "canonpose/base/log.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/train/losses.h"

namespace canonpose {
namespace {

constexpr std::size_t kFramesWanted = 3000;
constexpr std::size_t kTrapChunkFrames = 1024;
constexpr double kDegPerRad = DegFromRad(1.0);

double Median(std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// In the right basin depth was 0.89 to 1.02 and scatter 0.09 to 0.22 of the angle. In the trap depth was 1.5 to 3.3, or
// scatter 0.7 to 1.0 of the angle, or both; of moving cameras, within clips, it was 0.27 even there (docs/results.md).
constexpr double kSuspiciousDepth = 1.25;
constexpr double kTrappedDepth = 1.5;
constexpr double kFlat = 0.5;
// Of views that differ at all; an untrained network's are 2 degrees apart.
constexpr double kSmallestAngleDegrees = 10.0;
constexpr double kSuspiciousScatter = 0.4;
constexpr double kTrappedScatter = 0.6;

double AngleDegrees(const Eigen::Matrix3d& rotation) {
  return std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0)) * kDegPerRad;
}

/// Adds what the lifter makes of a chunk of frames.
void AddChunk(LiftingNetwork& lifter, const TrainingSet& set, const std::vector<const TrainingFrame*>& frames, int root,
              torch::Device device, TrapStatistics& statistics) {
  const LifterOutput output = lifter.forward(LifterInput(GatherBatch(set, frames, device)));
  torch::Tensor pose = torch::bmm(output.rotation, output.pose);
  pose = (pose - pose.narrow(2, root, 1)).to(torch::kCPU, torch::kFloat64).contiguous();         // (R, 3, J)
  const torch::Tensor rotation = output.rotation.to(torch::kCPU, torch::kFloat64).contiguous();  // (R, 3, 3)
  using Planar = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const auto pose_of = [&](std::int64_t row) {
    return Eigen::Map<const Planar>(pose.data_ptr<double>() + row * 3 * set.joint_count, 3, set.joint_count);
  };
  // A lifter that sees a turned camera is asked for the camera itself, which may stand still while the turn follows the
  // person.
  const auto rotation_of = [&](std::int64_t row, int set_row) -> Eigen::Matrix3d {
    const Eigen::Map<const RowMajor3> seen(rotation.data_ptr<double>() + row * 9);
    if (set.turned_from_camera.empty()) return seen;
    return set.turned_from_camera[static_cast<std::size_t>(set_row)].cast<double>().transpose() * seen;
  };
  std::int64_t first_row = 0;
  for (const TrainingFrame* frame : frames) {
    const bool is_static = set.static_captures[static_cast<std::size_t>(frame->capture)] != 0;
    // Captures and clips are numbered apart.
    const int group = is_static ? -1 - frame->capture : frame->clip;
    const auto views = static_cast<std::int64_t>(frame->views.size());
    for (std::int64_t i = 0; i < views; ++i) {
      const TrainingView& one = frame->views[static_cast<std::size_t>(i)];
      statistics.AddPose(frame->clip, one.camera, pose_of(first_row + i));
      for (std::int64_t j = i + 1; j < views; ++j) {
        const TrainingView& other = frame->views[static_cast<std::size_t>(j)];
        statistics.AddRotation(group, one.camera, other.camera,
                               rotation_of(first_row + j, other.row) * rotation_of(first_row + i, one.row).transpose());
      }
    }
    first_row += views;
  }
}

}  // namespace

std::string TrapSigns::Describe() const {
  return fmt::format("poses {:.2f} times as deep as wide, views {:.0f} degrees apart, scattered by {:.0f}", depth_ratio,
                     angle_deg, scatter_deg);
}

TrapVerdict JudgeTrap(const TrapSigns& signs) {
  const double scatter = signs.scatter_deg / signs.angle_deg;  // NaN, which is not more than anything, where unknown
  if (signs.depth_ratio > kTrappedDepth || scatter > kTrappedScatter) return TrapVerdict::kTrapped;
  const bool is_plausible =
      signs.depth_ratio >= kFlat && signs.depth_ratio <= kSuspiciousDepth && signs.angle_deg >= kSmallestAngleDegrees;
  return is_plausible && !(scatter > kSuspiciousScatter) ? TrapVerdict::kRight : TrapVerdict::kSuspicious;
}

TrapFinding ReportTrap(const TrapSigns& signs, const InputForm& input) {
  TrapFinding finding{"right", signs.depth_ratio, signs.angle_deg, signs.scatter_deg};
  const TrapVerdict verdict = JudgeTrap(signs);
  if (verdict == TrapVerdict::kRight) {
    LogInfo("trap: none seen ({})", signs.Describe());
    return finding;
  }
  finding.verdict = verdict == TrapVerdict::kTrapped ? "trapped" : "suspicious";
  LogWarning(
      "trap: training {} in a solution that is none ({}; people seen from all around are as deep as wide, and cameras "
      "turn little from frame to frame): train again with {}`camera_consistency=static` where cameras stand still, "
      "`camera_consistency=window` `camera_weight=0.5` where they move, more epochs or another `seed`",
      verdict == TrapVerdict::kTrapped ? "has settled" : "may have settled", signs.Describe(),
      input.ray == "off" ? "" : "`ray=off` and ");  // which camera consistency needs
  return finding;
}

void TrapStatistics::AddPose(int clip, int camera, const Eigen::Matrix3Xd& pose_in_camera) {
  const double norm = pose_in_camera.topRows<2>().norm();
  if (!(norm > 0.0)) return;
  const Eigen::Matrix3Xd scaled = pose_in_camera / norm;
  moments_.try_emplace({clip, camera}, Eigen::Matrix3d::Zero()).first->second += scaled * scaled.transpose();
}

void TrapStatistics::AddRotation(int group, int camera_a, int camera_b, const Eigen::Matrix3d& b_from_a) {
  rotations_[{group, camera_a, camera_b}].push_back(b_from_a);
}

TrapSigns TrapStatistics::Finish() const {
  double width = 0.0;
  double depth = 0.0;
  for (const auto& [key, moments] : moments_) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> image(moments.topLeftCorner<2, 2>());
    const Eigen::Vector2d across = image.eigenvectors().col(0);
    const Eigen::Vector2d along = image.eigenvectors().col(1);
    Eigen::Matrix2d upright;  // of the plane of `along` and the optical axis
    upright(0, 0) = image.eigenvalues()[1];
    upright(0, 1) = upright(1, 0) = along.dot(moments.topRightCorner<2, 1>());
    upright(1, 1) = moments(2, 2);
    width += across.dot(moments.topLeftCorner<2, 2>() * across);
    depth += Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(upright).eigenvalues()[0];
  }
  TrapSigns signs;
  signs.depth_ratio = std::sqrt(depth / width);
  std::vector<double> angles;
  std::vector<double> scatter;
  for (const auto& [key, rotations] : rotations_) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& rotation : rotations) sum += rotation;
    const Eigen::Matrix3d mean = NearestRotation(sum);
    for (const Eigen::Matrix3d& rotation : rotations) {
      angles.push_back(AngleDegrees(rotation));
      if (rotations.size() > 1) scatter.push_back(AngleDegrees(rotation * mean.transpose()));
    }
  }
  signs.angle_deg = Median(angles);
  signs.scatter_deg = Median(scatter);
  return signs;
}

TrapSigns MeasureTrapSigns(LiftingNetwork& lifter, const TrainingSet& set, int root, torch::Device device) {
  const torch::NoGradGuard no_grad;
  // Whole clips, so that consecutive frames stay together.
  const int stride = static_cast<int>(set.frames.size() / kFramesWanted) + 1;
  TrapStatistics statistics;
  std::vector<const TrainingFrame*> chunk;
  for (const TrainingFrame& frame : set.frames) {
    if (frame.clip % stride == 0) chunk.push_back(&frame);
    if (chunk.size() == kTrapChunkFrames || (&frame == &set.frames.back() && !chunk.empty())) {
      AddChunk(lifter, set, chunk, root, device, statistics);
      chunk.clear();
    }
  }
  return statistics.Finish();
}

}  // namespace canonpose
