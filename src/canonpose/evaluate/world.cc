#include "canonpose/evaluate/world.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "canonpose/evaluate/camera_alignment.h"
#include "canonpose/geometry/alignment.h"

namespace canonpose {
namespace {

bool IsSolved(const CameraView& view) { return !view.solved.empty() && !view.solved_calibration.empty(); }

/// Joints in two worlds, in the same order.
struct JointPairs {
  std::vector<Eigen::Vector3d> solved;
  std::vector<Eigen::Vector3d> truth;
  std::vector<std::size_t> first_of_pose;  ///< each pose's first joint

  [[nodiscard]] static Points3d Matrix(const std::vector<Eigen::Vector3d>& points, std::size_t first, std::size_t end) {
    Points3d matrix(static_cast<Eigen::Index>(end - first), 3);
    for (std::size_t i = first; i < end; ++i) matrix.row(static_cast<Eigen::Index>(i - first)) = points[i].transpose();
    return matrix;
  }
};

Eigen::Vector3d ToWorld(const Camera& camera, const Eigen::Vector3d& in_camera) {
  return camera.camera_from_world_rotation.transpose() * (in_camera - camera.camera_from_world_translation);
}

/// Of one person's sequence. With `only` it is the one camera that is used, whose frame is the world of the truth.
void AddSequence(const Sequence& sequence, const SequencePoses& reference, const std::vector<int>& joints,
                 const std::string& only, JointPairs& pairs) {
  for (int t = 0; t < sequence.frame_count; ++t) {
    const std::size_t first = pairs.solved.size();
    for (const int joint : joints) {
      for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
        const CameraView& view = sequence.cameras[c];
        const PoseSequence& truth = reference.poses_in_camera[c];
        const bool is_used = only.empty() ? !view.calibration.empty() : view.name == only;
        if (!is_used || !IsSolved(view) || truth.empty()) continue;
        if (!view.solved.IsKnown(t, joint) || !truth.IsKnown(t, joint)) continue;
        const Eigen::Vector3d solved = view.solved.PoseAt(t).row(joint).transpose().cast<double>();
        const Eigen::Vector3d in_camera = truth.PoseAt(t).row(joint).transpose().cast<double>();
        pairs.solved.push_back(ToWorld(view.SolvedCalibrationAt(t), solved));
        pairs.truth.push_back(only.empty() ? ToWorld(view.CalibrationAt(t), in_camera) : in_camera);
        break;
      }
    }
    if (pairs.solved.size() > first) pairs.first_of_pose.push_back(first);
  }
}

/// The first camera of a capture that has a solution and a reference; empty where there is none.
std::string FirstCamera(const Dataset& dataset, const std::vector<SequencePoses>& reference,
                        const std::string& capture) {
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    const Sequence& sequence = dataset.sequences[s];
    if (sequence.capture != capture) continue;
    for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
      if (IsSolved(sequence.cameras[c]) && !reference[s].poses_in_camera[c].empty()) return sequence.cameras[c].name;
    }
  }
  return "";
}

}  // namespace

void WorldComparison::AddCapture(const Dataset& dataset, const std::vector<SequencePoses>& reference,
                                 const std::string& capture) {
  std::vector<int> joints;
  for (int j = 0; j < dataset.skeleton.joint_count(); ++j) {
    if (std::ranges::count(left_out_, j) == 0) joints.push_back(j);
  }
  bool is_calibrated = false;
  bool is_metric = true;
  CameraPairs cameras;
  std::set<std::string> known;
  for (const Sequence& sequence : dataset.sequences) {
    if (sequence.capture != capture || !sequence.static_cameras) continue;
    for (const CameraView& view : sequence.cameras) {
      if (!IsSolved(view)) continue;
      is_metric = is_metric && view.solved.unit == LengthUnit::kMillimetres;
      if (view.calibration.empty()) continue;
      is_calibrated = true;
      if (known.insert(view.name).second) cameras.Add(view.SolvedCalibrationAt(0), view.CalibrationAt(0));
    }
  }
  const std::string only = is_calibrated ? "" : FirstCamera(dataset, reference, capture);
  if (!is_calibrated && only.empty()) return;
  JointPairs pairs;
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    const Sequence& sequence = dataset.sequences[s];
    if (sequence.capture == capture && sequence.static_cameras)
      AddSequence(sequence, reference[s], joints, only, pairs);
  }
  if (pairs.solved.empty()) return;
  const auto add = [](const Points3d& found, const Points3d& truth, Mean& mean) {
    mean.sum += (found - truth).rowwise().norm().sum();
    mean.count += static_cast<long>(found.rows());
  };
  const std::size_t count = pairs.solved.size();
  const Points3d solved = JointPairs::Matrix(pairs.solved, 0, count);
  const Points3d truth = JointPairs::Matrix(pairs.truth, 0, count);
  add(AlignSimilarity(solved, truth).Apply(solved), truth, whole_);
  if (is_metric && cameras.size() >= 2) add(cameras.Rigid().Apply(solved), truth, by_cameras_);
  for (std::size_t p = 0; p < pairs.first_of_pose.size(); ++p) {
    const std::size_t first = pairs.first_of_pose[p];
    const std::size_t end = p + 1 < pairs.first_of_pose.size() ? pairs.first_of_pose[p + 1] : count;
    if (end - first < 3) continue;  // a similarity fits them whatever they are
    const Points3d pose = JointPairs::Matrix(pairs.solved, first, end);
    const Points3d true_pose = JointPairs::Matrix(pairs.truth, first, end);
    add(AlignSimilarity(pose, true_pose).Apply(pose), true_pose, by_pose_);
  }
}

void WorldComparison::Add(const Dataset& dataset, const std::vector<SequencePoses>& reference) {
  std::set<std::string> captures;
  for (const Sequence& sequence : dataset.sequences) {
    if (sequence.static_cameras && captures.insert(sequence.capture).second) {
      AddCapture(dataset, reference, sequence.capture);
    }
  }
}

std::optional<WorldErrors> WorldComparison::Means() const {
  if (whole_.count == 0) return std::nullopt;
  const auto mean = [](const Mean& of) { return of.sum / static_cast<double>(of.count); };
  WorldErrors errors;
  errors.wa_mpjpe_mm = mean(whole_);
  if (by_cameras_.count > 0) errors.w_mpjpe_mm = mean(by_cameras_);
  errors.pa_mpjpe_mm = by_pose_.count > 0 ? mean(by_pose_) : std::nan("");
  return errors;
}

}  // namespace canonpose
