#include "canonpose/view/display_frame.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/base/median.h"
#include "canonpose/geometry/alignment.h"

namespace canonpose {
namespace {

/// The sum of bone lengths of an adult in the field's skeletons.
constexpr double kAdultBonesMetres = 4.5;
constexpr double kMetresPerMillimetre = 1e-3;
/// Joints of the feet are below the ankle's height by this, in displayed units: skeletons often end at the ankle.
constexpr double kAnkleHeight = 0.08;
/// Frames looked at where all are not needed.
constexpr int kSampledFrames = 400;

int Stride(int frames) { return std::max(1, frames / kSampledFrames); }

template <typename Visit>
void VisitJoints(const Scene& scene, Visit&& visit) {
  for (const PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); t += Stride(person.frame_count())) {
      for (int j = 0; j < person.joint_count(); ++j) {
        if (person.IsKnown(t, j)) visit(Eigen::Vector3d(person.PoseAt(t).row(j).transpose().cast<double>()));
      }
    }
  }
}

bool IsInWorld(const Scene& scene) {
  return !scene.people.empty() && scene.people.front().coordinate_frame.kind == CoordinateFrame::Kind::kWorld;
}

Eigen::Vector3d GuessUp(const Scene& scene) {
  const Eigen::Vector3d up_in_camera = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  if (IsInWorld(scene)) {
    for (const SceneCamera& camera : scene.cameras) {
      Eigen::Vector3d of_camera = Eigen::Vector3d::Zero();
      for (const Camera& calibration : camera.calibration) {
        of_camera += calibration.camera_from_world_rotation.transpose() * up_in_camera;
      }
      if (of_camera.norm() > 0.0 && of_camera.allFinite()) up += of_camera.normalized();
    }
  }
  return up.norm() > 1e-3 ? Eigen::Vector3d(up.normalized()) : up_in_camera;
}

/// The quantile of values, which are reordered.
double Quantile(std::vector<double>& values, double share) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool HasFeet(const Skeleton& skeleton) {
  return std::ranges::any_of(skeleton.joints, [](const std::string& joint) {
    return joint.find("Toe") != std::string::npos || joint.find("Heel") != std::string::npos;
  });
}

/// Where the person is before and after: joints of one name at one time.
void AddCommonJoints(const PoseSequence& a, const PoseSequence& b, std::vector<Eigen::Vector3d>& of_a,
                     std::vector<Eigen::Vector3d>& of_b) {
  const int frames = std::min(a.frame_count(), b.frame_count());
  for (int j = 0; j < a.joint_count(); ++j) {
    const std::optional<int> k = b.skeleton().Find(a.skeleton().joints[static_cast<std::size_t>(j)]);
    if (!k) continue;
    for (int t = 0; t < frames; t += Stride(frames)) {
      if (!a.IsKnown(t, j) || !b.IsKnown(t, *k)) continue;
      of_a.emplace_back(a.PoseAt(t).row(j).transpose().cast<double>());
      of_b.emplace_back(b.PoseAt(t).row(*k).transpose().cast<double>());
    }
  }
}

Points3d AsRows(const std::vector<Eigen::Vector3d>& points) {
  Points3d rows(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t i = 0; i < points.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  return rows;
}

}  // namespace

double BoneLengthSum(const PoseSequence& person) {
  double sum = 0.0;
  for (int j = 0; j < person.joint_count(); ++j) {
    const int parent = person.skeleton().parents[static_cast<std::size_t>(j)];
    if (parent < 0) continue;
    std::vector<double> lengths;
    for (int t = 0; t < person.frame_count(); t += Stride(person.frame_count())) {
      if (!person.IsKnown(t, j) || !person.IsKnown(t, parent)) continue;
      lengths.push_back((person.PoseAt(t).row(j) - person.PoseAt(t).row(parent)).cast<double>().norm());
    }
    if (!lengths.empty()) sum += Median(std::move(lengths));
  }
  return sum;
}

DisplayFrame MakeDisplayFrame(const Scene& scene) {
  DisplayFrame frame;
  const bool up_is_known = IsInWorld(scene) && scene.up.is_known();
  frame.up_is_guess = !up_is_known;
  frame.floor_is_guess = !up_is_known;
  const Eigen::Vector3d up = up_is_known ? Eigen::Vector3d::UnitZ() : GuessUp(scene);
  frame.rotation = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();

  const bool is_millimetres = !scene.people.empty() && scene.people.front().unit == LengthUnit::kMillimetres;
  double bones = 0.0;
  for (const PoseSequence& person : scene.people) bones = std::max(bones, BoneLengthSum(person));
  frame.is_metric = is_millimetres;
  frame.scale = is_millimetres ? kMetresPerMillimetre : bones > 0.0 ? kAdultBonesMetres / bones : 1.0;

  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> height;
  VisitJoints(scene, [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d turned = frame.rotation * point;
    x.push_back(turned.x());
    y.push_back(turned.y());
    height.push_back(turned.z());
  });
  if (x.empty()) return frame;
  Eigen::Vector3d centre(0.0, 0.0, 0.0);
  if (!up_is_known) {
    const bool has_feet = HasFeet(scene.people.front().skeleton());
    constexpr double kLowest = 0.02;
    centre = {Quantile(x, 0.5), Quantile(y, 0.5),
              Quantile(height, kLowest) - (has_feet ? 0.0 : kAnkleHeight / frame.scale)};
  }
  frame.origin = frame.rotation.transpose() * centre;
  return frame;
}

DisplayFrame MakeDisplayFrameLike(const Scene& shown, const DisplayFrame& frame, const Scene& scene) {
  std::vector<Eigen::Vector3d> of_shown;
  std::vector<Eigen::Vector3d> of_scene;
  for (std::size_t p = 0; p < std::min(shown.people.size(), scene.people.size()); ++p) {
    AddCommonJoints(shown.people[p], scene.people[p], of_shown, of_scene);
  }
  constexpr std::size_t kEnough = 20;
  DisplayFrame own = MakeDisplayFrame(scene);
  if (of_scene.size() < kEnough) return own;
  const Similarity shown_from_scene = AlignSimilarity(AsRows(of_scene), AsRows(of_shown));
  if (!(shown_from_scene.scale > 0.0)) return own;
  own.scale = frame.scale * shown_from_scene.scale;
  own.rotation = frame.rotation * shown_from_scene.rotation;
  own.origin =
      shown_from_scene.rotation.transpose() * (frame.origin - shown_from_scene.translation) / shown_from_scene.scale;
  own.up_is_guess = frame.up_is_guess;
  own.floor_is_guess = frame.floor_is_guess;
  own.is_metric = frame.is_metric;
  return own;
}

}  // namespace canonpose
