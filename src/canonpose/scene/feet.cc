#include "canonpose/scene/feet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "canonpose/skeleton/anthropometry.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

/// Where the recording does not say.
constexpr double kUsualFps = 30.0;
/// In statures per second. The foot that carries a walking person moves by a third of that, the other by ten times it.
constexpr double kStillSpeed = 0.15;
constexpr double kSpeedSeconds = 0.05;  ///< before and after a frame, over which speeds are measured
constexpr double kStanceSeconds = 0.1;
/// In statures: how far a joint may be above the lowest one and still be on the floor.
constexpr double kClearlyAbove = 0.03;

struct FootPart {
  const char* name;
  double height;       ///< above the floor, in statures
  double uncertainty;  ///< of the height: of people, detectors, and how a foot stands
};

constexpr FootPart kParts[] = {{"ankle", kAnkleHeight, 0.008},
                               {"heel", kHeelHeight, 0.006},
                               {"bigtoe", kToeHeight, 0.006},
                               {"smalltoe", kToeHeight, 0.006}};

}  // namespace

Feet::Feet(const PoseSequence& person, double stature)
    : person_(&person), stature_(stature), fps_(person.fps > 0.0 ? person.fps : kUsualFps) {
  for (const FootPart& part : kParts) {
    for (const char side : {'l', 'r'}) {
      const std::optional<int> joint = FindPart(person.skeleton(), side + std::string(part.name));
      if (!joint) continue;
      joints_.push_back({*joint, stature * part.height, stature * part.uncertainty});
      only_ankles_ = only_ankles_ && std::string_view(part.name) == "ankle";
    }
  }
}

double Feet::height_uncertainty() const {
  return std::ranges::min_element(joints_, {}, &Joint::uncertainty)->uncertainty;
}

double Feet::LowestSole(int frame, const Eigen::Vector3d& up) const {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Joint& joint : joints_) {
    const double height = up.dot(At(frame, joint)) - joint.height;
    if (height < lowest) lowest = height;
  }
  return std::isfinite(lowest) ? lowest : std::numeric_limits<double>::quiet_NaN();
}

std::vector<Stance> Feet::Stances(const Eigen::Vector3d& up) const {
  const int frames = person_->frame_count();
  const int reach = std::max(1, static_cast<int>(std::lround(kSpeedSeconds * fps_)));
  const int least = std::max(3, static_cast<int>(std::lround(kStanceSeconds * fps_)));
  std::vector<double> lowest(static_cast<std::size_t>(frames));
  for (int t = 0; t < frames; ++t) lowest[static_cast<std::size_t>(t)] = LowestSole(t, up);
  std::vector<Stance> stances;
  for (const Joint& joint : joints_) {
    const auto stands = [&](int t) {
      const int before = std::max(0, t - reach);
      const int after = std::min(frames - 1, t + reach);
      if (after == before) return false;
      const double speed = (At(after, joint) - At(before, joint)).norm() * fps_ / (after - before);
      const double above = up.dot(At(t, joint)) - joint.height - lowest[static_cast<std::size_t>(t)];
      return speed < kStillSpeed * stature_ && above < kClearlyAbove * stature_;
    };
    for (int first = 0; first < frames; ++first) {
      int end = first;
      while (end < frames && stands(end)) ++end;
      if (end - first >= least) {
        Stance stance{Eigen::Vector3d::Zero(), joint.height, joint.uncertainty, first, end - 1};
        for (int t = first; t < end; ++t) stance.position += At(t, joint) / (end - first);
        stances.push_back(stance);
      }
      first = std::max(first, end);
    }
  }
  return stances;
}

}  // namespace canonpose
