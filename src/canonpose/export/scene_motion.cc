#include "canonpose/export/scene_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/body_size.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kUsualStatureMm = 1700.0;
constexpr double kUsualFps = 30.0;

/// point_mm = scale * rotation * point_in_scene + translation_mm, with z up.
struct ToMillimetres {
  double scale = 1.0;
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d translation_mm = Vector3d::Zero();

  [[nodiscard]] Vector3d operator()(const Vector3d& point) const { return scale * rotation * point + translation_mm; }
};

std::string NameOf(const Scene& scene) { return scene.name.empty() ? "the scene" : scene.name; }

Vector3d PointOf(const PoseSequence& person, int frame, int joint) {
  return person.PoseAt(frame).row(joint).transpose().cast<double>();
}

/// The mean of the joints that are known of these parts of the body; NaN where none is.
Vector3d MeanOf(const PoseSequence& person, int frame, const std::vector<std::string>& parts) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const std::string& part : parts) {
    const std::optional<int> joint = FindPart(person.skeleton(), part);
    if (!joint || !person.IsKnown(frame, *joint)) continue;
    sum += PointOf(person, frame, *joint);
    ++count;
  }
  return count > 0 ? Vector3d(sum / count) : Vector3d::Constant(std::nan(""));
}

/// From feet to shoulders in the mean over people and frames; where no feet are seen, from hips to shoulders.
Vector3d UpOfPeople(const Scene& scene) {
  Vector3d sum = Vector3d::Zero();
  for (const PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      const Vector3d shoulders = MeanOf(person, t, {"lshoulder", "rshoulder"});
      Vector3d below = MeanOf(person, t, {"lankle", "rankle"});
      if (!below.allFinite()) below = MeanOf(person, t, {"lhip", "rhip"});
      const Vector3d up = (shoulders - below).normalized();
      if (up.allFinite()) sum += up;
    }
  }
  return sum.norm() > 0.0 ? Vector3d(sum.normalized()) : Vector3d(Vector3d::UnitZ());
}

/// Turns people upright, the first of them above the origin, and puts z = 0 where their lowest joints are mostly.
void StandPeopleUp(const Scene& scene, ToMillimetres& to_mm) {
  to_mm.rotation = Eigen::Quaterniond::FromTwoVectors(UpOfPeople(scene), Vector3d::UnitZ()).toRotationMatrix();
  std::vector<double> heights;
  std::optional<Vector3d> first;
  for (const PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      double lowest = INFINITY;
      for (int j = 0; j < person.joint_count(); ++j) {
        if (person.IsKnown(t, j)) lowest = std::min(lowest, to_mm(PointOf(person, t, j)).z());
      }
      if (std::isfinite(lowest)) heights.push_back(lowest);
      const Vector3d hips = MeanOf(person, t, {"lhip", "rhip"});
      if (!first && hips.allFinite()) first = to_mm(hips);
    }
  }
  if (!first) return;
  to_mm.translation_mm = {-first->x(), -first->y(), -Median(std::move(heights))};
}

double MillimetresPerUnit(const Scene& scene, SceneMotion& motion) {
  switch (scene.people.front().unit) {
    case LengthUnit::kMillimetres:
      motion.scale = scene.scale.is_known() ? scene.scale.source : "millimetres in the input";
      return 1.0;
    case LengthUnit::kEachItsOwn:
      ThrowBadInput({NameOf(scene), "", "poses of one scale", "poses that each have a scale of their own",
                     "give the person's `height`"});
    case LengthUnit::kBodyLengths:
      break;
  }
  std::vector<double> statures;
  for (const PoseSequence& person : scene.people) {
    BodySize size(person.skeleton());
    size.Add(person.positions());
    if (const std::optional<double> stature = size.Stature()) statures.push_back(*stature);
  }
  motion.scale = fmt::format("unknown; people are taken to be {:.2f} m tall", kUsualStatureMm / 1000.0);
  LogWarning("{}: its scale is {}; positions and cameras are scaled with them", NameOf(scene), motion.scale);
  return statures.empty() ? 1.0 : kUsualStatureMm / Median(std::move(statures));
}

PoseSequence InMillimetres(const PoseSequence& person, const ToMillimetres& to_mm) {
  PoseSequence moved = person;
  moved.unit = LengthUnit::kMillimetres;
  for (int t = 0; t < moved.frame_count(); ++t) {
    for (int j = 0; j < moved.joint_count(); ++j) {
      if (person.IsKnown(t, j)) moved.PoseAt(t).row(j) = to_mm(PointOf(person, t, j)).transpose().cast<float>();
    }
  }
  return moved;
}

Camera InMillimetres(Camera camera, const ToMillimetres& to_mm) {
  // scale * x_in_camera = R * rotation^T * (point_mm - translation_mm) + scale * t
  camera.camera_from_world_rotation *= to_mm.rotation.transpose();
  camera.camera_from_world_translation =
      to_mm.scale * camera.camera_from_world_translation - camera.camera_from_world_rotation * to_mm.translation_mm;
  return camera;
}

void FindTimes(const Scene& scene, SceneMotion& motion) {
  const PoseSequence& person = scene.people.front();
  const bool is_known = person.fps > 0.0 || !person.time_seconds.empty();
  if (!is_known) {
    LogWarning("{}: neither its frame rate nor its times are known; {:g} frames per second are assumed", NameOf(scene),
               kUsualFps);
  }
  for (int t = 0; t < person.frame_count(); ++t) {
    motion.times_seconds.push_back(is_known ? person.TimeOf(t) - person.TimeOf(0) : t / kUsualFps);
    const double step = t == 0 ? 1.0 : motion.times_seconds.back() - *(motion.times_seconds.end() - 2);
    if (step > 0.0) continue;
    ThrowBadInput({NameOf(scene), fmt::format("time of frame {}", t), "later than the frame before",
                   fmt::format("{:g} s later", step), "correct the times"});
  }
}

/// "LElbow 10-14, 30" for at most so many spans.
std::string Describe(const std::vector<UnseenFrames>& unseen) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> spans;
  for (std::size_t i = 0; i < unseen.size() && i < kMost; ++i) {
    std::string span = i > 0 && unseen[i].joint == unseen[i - 1].joint ? "" : unseen[i].joint + ' ';
    span += unseen[i].first == unseen[i].last ? fmt::format("{}", unseen[i].first)
                                              : fmt::format("{}-{}", unseen[i].first, unseen[i].last);
    spans.push_back(span);
  }
  return fmt::format("{}{}", fmt::join(spans, ", "),
                     unseen.size() > kMost ? fmt::format(" and {} more", unseen.size() - kMost) : "");
}

void Report(const HierarchyFit& fit) {
  const std::string& name = fit.motion.name;
  LogInfo(
      "{}: the hierarchy's joints are {:.1f} mm ({:.1f} % of the stature) from the poses' in the mean, at most "
      "{:.0f} mm ({}, frame {})",
      name, fit.mean_error_mm, 100.0 * fit.mean_error_mm / fit.stature_mm, fit.largest_error_mm, fit.worst_joint,
      fit.worst_frame);
  if (!fit.unseen.empty()) {
    LogInfo("{}: rotations are interpolated or held where joints are unknown, in the frames {}", name,
            Describe(fit.unseen));
  }
  if (!fit.never_seen.empty()) {
    LogInfo("{}: never seen, so of average length and at rest: {}", name, fmt::join(fit.never_seen, ", "));
  }
}

/// The person's own name, or "person 2", made different from those before.
std::string DistinctName(const std::string& name, std::size_t number, std::set<std::string>& taken) {
  const std::string plain = name.empty() ? fmt::format("person {}", number) : name;
  std::string distinct = plain;
  for (int i = 2; !taken.insert(distinct).second; ++i) distinct = fmt::format("{} {}", plain, i);
  return distinct;
}

}  // namespace

SceneMotion MakeSceneMotion(const Scene& scene, const MotionExportOptions& options) {
  scene.Validate();
  SceneMotion motion;
  if (std::none_of(scene.people.begin(), scene.people.end(), [](const PoseSequence& p) { return p.AnyKnown(); }))
    ThrowBadInput({NameOf(scene), "people", "somebody who is seen", "nobody", ""});
  FindTimes(scene, motion);
  ToMillimetres to_mm;
  to_mm.scale = MillimetresPerUnit(scene, motion);
  motion.has_floor = scene.up.is_known();
  motion.up = scene.up.is_known() ? scene.up.source : "unknown; people are taken to be upright on average";
  if (!scene.up.is_known()) {
    LogWarning("{}: which way is up is {}", NameOf(scene), motion.up);
    StandPeopleUp(scene, to_mm);
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < scene.people.size(); ++i) {
    PoseSequence person = InMillimetres(scene.people[i], to_mm);
    person.name = DistinctName(person.name, i + 1, names);
    if (!person.AnyKnown()) {
      LogWarning("{}: never seen, and left out", person.name);
      continue;
    }
    HierarchyFit& fit = motion.people.emplace_back(FitHierarchy(person, options.joint_names));
    if (fit.motion.fps <= 0.0) fit.motion.fps = kUsualFps;
    Report(fit);
  }
  for (const SceneCamera& camera : scene.cameras) {
    if (camera.calibration.empty()) continue;
    SceneCamera& moved = motion.cameras.emplace_back(camera);
    for (Camera& calibration : moved.calibration) calibration = InMillimetres(calibration, to_mm);
  }
  return motion;
}

}  // namespace canonpose
