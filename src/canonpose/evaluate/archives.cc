#include "canonpose/evaluate/archives.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/evaluate/evaluation.h"
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
  const PoseArchive true_poses = ReadPoseArchive(truth);
  if (predicted.frame_count != true_poses.frame_count || predicted.joint_count != true_poses.joint_count) {
    ThrowBadInput({predictions.string(), "", ShapeText(true_poses) + " as in " + truth.string(), ShapeText(predicted),
                   "give both the same poses and joints in the same order"});
  }
  const std::vector<std::string> joints = JointNames(predicted, true_poses, predictions);
  options.frames.RequireLast(true_poses.frame_count, truth.string());
  const int last = std::min(options.frames.last, true_poses.frame_count - 1);
  if (options.frames.first > last) {
    ThrowBadInput({truth.string(), "", fmt::format("poses from {} on", options.frames.first),
                   fmt::format("{}", true_poses.frame_count), "choose frames that exist"});
  }
  Evaluation evaluation(joints, RootOf(joints, options.root), options.left_out);
  evaluation.KeepFrameErrors(options.frame_errors);
  const std::size_t row = 3 * joints.size();
  for (auto i = static_cast<std::size_t>(options.frames.first); i <= static_cast<std::size_t>(last); ++i) {
    evaluation.Add({truth.stem().string(), "", static_cast<std::int64_t>(i)}, &predicted.poses[i * row],
                   &true_poses.poses[i * row]);
  }
  return evaluation.Finish({"truth", {}}, predictions.string());
}

}  // namespace canonpose
