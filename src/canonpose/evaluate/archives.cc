#include "canonpose/evaluate/archives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/body_size.h"
#include "canonpose/data/calibration_check.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/evaluate/evaluation.h"
#include "canonpose/geometry/alignment.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

std::string ShapeText(const PoseArchive& archive) {
  return fmt::format("pose3d of shape ({}, {}, 3)", archive.frame_count, archive.joint_count);
}

/// The joint names of both archives, which must agree; numbers if neither has any.
std::vector<std::string> JointNames(const PoseArchive& predicted, const PoseArchive& truth, const fs::path& file) {
  const auto same = [](const std::vector<std::string>& a, const std::vector<std::string>& b) {
    const Skeleton first{"", a, {}, 0, {}};
    const Skeleton second{"", b, {}, 0, {}};
    return first.SameJoints(second);
  };
  if (!predicted.joints.empty() && !truth.joints.empty() && !same(predicted.joints, truth.joints)) {
    ThrowBadInput({file.string(), "array joints", fmt::format("the truth's {}", fmt::join(truth.joints, ", ")),
                   fmt::format("{}", fmt::join(predicted.joints, ", ")), "bring both into the same order"});
  }
  if (!truth.joints.empty()) return truth.joints;
  if (!predicted.joints.empty()) return predicted.joints;
  std::vector<std::string> numbers;
  for (int j = 0; j < truth.joint_count; ++j) numbers.push_back(std::to_string(j));
  return numbers;
}

int RootOf(const std::vector<std::string>& joints, const std::optional<int>& chosen) {
  if (chosen) {
    if (*chosen >= 0 && *chosen < static_cast<int>(joints.size())) return *chosen;
    ThrowInvalidArgument("`root` {}: there are joints 0 to {}", *chosen, joints.size() - 1);
  }
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    Skeleton named = skeleton;
    named.joints = joints;
    if (skeleton.SameJoints(named)) return skeleton.root;
  }
  return 0;
}

/// Without names nothing shows that the poses are people's, but no body that is measured in millimetres is as small as
/// one in metres.
constexpr double kSmallestExtentMm = 5.0;

/// The median over poses of the largest extent along an axis.
double MedianExtent(const PoseArchive& archive) {
  std::vector<double> extents;
  const auto row = static_cast<std::size_t>(3 * archive.joint_count);
  for (std::size_t pose = 0; pose < archive.poses.size(); pose += row) {
    double extent = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double low = std::numeric_limits<double>::infinity();
      double high = -low;
      for (std::size_t i = pose + axis; i < pose + row; i += 3) {
        if (!std::isfinite(archive.poses[i])) continue;
        low = std::min(low, static_cast<double>(archive.poses[i]));
        high = std::max(high, static_cast<double>(archive.poses[i]));
      }
      extent = std::max(extent, high - low);
    }
    if (extent > 0.0) extents.push_back(extent);
  }
  return Median(std::move(extents));
}

/// Truth in centimetres or metres becomes millimetres.
void CheckUnit(PoseArchive& truth, const std::vector<std::string>& joints, const fs::path& file) {
  BodySize size(Skeleton{"", joints, {}, 0, {}});
  size.Add(truth.poses);
  double mm = 1.0;
  if (const std::optional<StatureUnit> unit = UnitOfTruth(size, file.string())) {
    mm = unit->mm;
  } else if (const double extent = MedianExtent(truth); !size.Stature() && extent < kSmallestExtentMm) {
    LogWarning("{}: the truth is in metres, as the bodies would be {} large otherwise; it is read as such",
               file.string(), DescribeLength(extent));
    mm = 1000.0;
  }
  if (mm == 1.0) return;
  for (float& value : truth.poses) value = static_cast<float>(value * mm);
}

/// Whether predictions and truth are in frames that are rotated against each other: one rotation, the same for all
/// poses, makes predictions fit that do not fit otherwise.
class CommonRotation {
 public:
  explicit CommonRotation(int root) : root_(static_cast<std::size_t>(root)) {}

  void Add(const float* predicted, const float* truth, std::size_t joint_count) {
    const auto joint = [&](const float* pose, std::size_t j) {
      return Eigen::Vector3d(pose[3 * j] - pose[3 * root_], pose[3 * j + 1] - pose[3 * root_ + 1],
                             pose[3 * j + 2] - pose[3 * root_ + 2]);
    };
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    double predicted_squares = 0.0;
    double true_squares = 0.0;
    for (std::size_t j = 0; j < joint_count; ++j) {
      const Eigen::Vector3d p = joint(predicted, j);
      const Eigen::Vector3d t = joint(truth, j);
      if (!p.allFinite() || !t.allFinite()) continue;
      products += t * p.transpose();
      predicted_squares += p.squaredNorm();
      true_squares += t.squaredNorm();
    }
    const double norm = std::sqrt(predicted_squares * true_squares);
    if (!(norm > 0.0)) return;
    sum_ += products / norm;
    ++count_;
  }

  /// Empty where there is nothing to say.
  [[nodiscard]] std::string Warning() const {
    constexpr double kFits = 0.9;
    constexpr double kContradicts = 0.6;
    constexpr double kSmallestDeg = 40.0;
    if (count_ == 0) return "";
    const Eigen::Matrix3d mean = sum_ / static_cast<double>(count_);
    const Eigen::Matrix3d rotation = NearestRotation(mean);
    // Mean cosines between true and predicted poses, as they are and once they are rotated.
    const double as_given = mean.trace();
    const double rotated = (rotation.transpose() * mean).trace();
    const double angle_deg = DegFromRad(std::acos(std::clamp((rotation.trace() - 1.0) / 2.0, -1.0, 1.0)));
    if (rotated < kFits || as_given > kContradicts || angle_deg < kSmallestDeg) return "";
    return fmt::format(
        "the predictions are in another frame than the truth: all fit once they are rotated by {:.0f} degrees; bring "
        "both "
        "into the camera's frame (x right, y down, z forward)",
        angle_deg);
  }

 private:
  std::size_t root_;
  Eigen::Matrix3d sum_ = Eigen::Matrix3d::Zero();
  std::int64_t count_ = 0;
};

}  // namespace

PoseArchive ReadPoseArchive(const fs::path& path) {
  const NpzReader reader(path);
  PoseArchive archive;
  std::vector<std::size_t> shape;
  archive.poses = reader.ReadFloats("pose3d", &shape);
  if (shape.size() != 3 || shape[0] == 0 || shape[1] == 0 || shape[2] != 3) {
    ThrowBadInput({path.string(), "array pose3d", "shape (N, J, 3) = poses, joints, x y z",
                   fmt::format("({})", fmt::join(shape, ", ")), ""});
  }
  archive.frame_count = static_cast<int>(shape[0]);
  archive.joint_count = static_cast<int>(shape[1]);
  if (reader.Has("joints")) archive.joints = reader.ReadStrings("joints");
  if (!archive.joints.empty() && archive.joints.size() != shape[1]) {
    ThrowBadInput({path.string(), "array joints", fmt::format("{} names", shape[1]),
                   fmt::format("{}", archive.joints.size()), ""});
  }
  return archive;
}

EvaluationReport EvaluateArchives(const fs::path& predictions, const fs::path& truth, const ArchiveOptions& options) {
  const PoseArchive predicted = ReadPoseArchive(predictions);
  PoseArchive true_poses = ReadPoseArchive(truth);
  if (predicted.frame_count != true_poses.frame_count || predicted.joint_count != true_poses.joint_count) {
    ThrowBadInput({predictions.string(), "", ShapeText(true_poses) + " as in " + truth.string(), ShapeText(predicted),
                   "give both the same poses and joints in the same order"});
  }
  const std::vector<std::string> joints = JointNames(predicted, true_poses, predictions);
  CheckUnit(true_poses, joints, truth);
  options.frames.RequireLast(true_poses.frame_count, truth.string());
  const int last = std::min(options.frames.last, true_poses.frame_count - 1);
  if (options.frames.first > last) {
    ThrowBadInput({truth.string(), "", fmt::format("poses from {} on", options.frames.first),
                   fmt::format("{}", true_poses.frame_count), "choose frames that exist"});
  }
  Evaluation evaluation(joints, RootOf(joints, options.root), options.left_out);
  evaluation.KeepFrameErrors(options.frame_errors);
  CommonRotation rotation(RootOf(joints, options.root));
  const std::size_t row = 3 * joints.size();
  for (auto i = static_cast<std::size_t>(options.frames.first); i <= static_cast<std::size_t>(last); ++i) {
    evaluation.Add({truth.stem().string(), "", static_cast<std::int64_t>(i)}, &predicted.poses[i * row],
                   &true_poses.poses[i * row]);
    rotation.Add(&predicted.poses[i * row], &true_poses.poses[i * row], joints.size());
  }
  EvaluationReport report = evaluation.Finish({"truth", {}}, predictions.string());
  if (const std::string warning = rotation.Warning(); !warning.empty()) report.warnings.push_back(warning);
  return report;
}

}  // namespace canonpose
