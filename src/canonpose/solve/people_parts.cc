#include "canonpose/solve/people_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/median.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/people_tracker.h"

namespace canonpose {
namespace {

constexpr double kFarOffUnit = 0.05;
constexpr int kFramesOfPerson = 120;
/// A person is seen by two views for so long at least.
constexpr double kShortestSeconds = 0.5;
constexpr int kShortestFrames = 8;
constexpr double kPoorFit = 0.6;
/// Parts that one tracklet shows both of, over a gap of at most so long.
constexpr double kLongestJoinSeconds = 1.5;
constexpr double kNearEnough = 0.35;
/// Bone lengths differ by so much, root mean square of logarithms, between parts of one person; and clearly more
/// between people.
constexpr double kSameBones = 0.035;
constexpr double kClearlyOtherBones = 0.015;
constexpr int kFramesForBones = 40;
constexpr double kRivalMargin = 0.25;
/// Two who are nearer to each other than this, in the median and in body units, are in one place: 45 cm.
constexpr double kOnePlace = 0.1;

/// What is known of a part of a person.
struct Part {
  int first = 0;  ///< with two views or more
  int last = 0;
  int frames = 0;
  Eigen::Vector3d first_place = Eigen::Vector3d::Constant(std::nan(""));
  Eigen::Vector3d last_place = Eigen::Vector3d::Constant(std::nan(""));
  std::vector<double> log_bones;  ///< (J) median, both sides together; NaN where unknown
};

Eigen::Vector3d PlaceOf(const PeopleObservations& people, const CameraRays& rays, const Person& person, int frame) {
  return Middle(JointsOf(people, rays, person, frame));
}

std::vector<double> LogBones(const PeopleObservations& people, const CameraRays& rays, const Person& person,
                             const std::vector<int>& frames) {
  const Skeleton& skeleton = people.capture.skeleton;
  std::vector<std::vector<double>> lengths(skeleton.joints.size());
  for (const int frame : EvenlySpread(frames, kFramesOfPerson)) {
    const JointPositions joints = JointsOf(people, rays, person, frame);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      if (skeleton.parents[j] < 0) continue;
      const double length = (joints[j] - joints[static_cast<std::size_t>(skeleton.parents[j])]).norm();
      // A bone and its partner on the other side are as long.
      const auto side = static_cast<std::size_t>(std::min(static_cast<int>(j), skeleton.mirror[j]));
      if (std::isfinite(length) && length > 0.0) lengths[side].push_back(std::log(length));
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& values : lengths) medians.push_back(Median(std::move(values)));
  return medians;
}

Part Summarise(const PeopleObservations& people, const CameraRays& rays, const Person& person) {
  Part part;
  const std::vector<int> frames = person.FramesWith(2);
  part.frames = static_cast<int>(frames.size());
  if (frames.empty()) return part;
  part.first = frames.front();
  part.last = frames.back();
  part.first_place = PlaceOf(people, rays, person, part.first);
  part.last_place = PlaceOf(people, rays, person, part.last);
  const std::vector<int> well_seen = person.FramesWith(3);
  part.log_bones =
      LogBones(people, rays, person, static_cast<int>(well_seen.size()) >= kFramesForBones ? well_seen : frames);
  return part;
}

double BoneDifference(const Part& a, const Part& b) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t j = 0; j < a.log_bones.size(); ++j) {
    const double difference = a.log_bones[j] - b.log_bones[j];
    if (!std::isfinite(difference)) continue;
    sum += difference * difference;
    ++count;
  }
  return count >= 4 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
}

/// Whether no view shows both in one frame, nor two views each of them.
bool AreApart(const Person& a, const Person& b) {
  for (std::size_t i = 0; i < a.lanes.size(); ++i) {
    if (a.lanes[i] >= 0 && b.lanes[i] >= 0) return false;
  }
  return true;
}

bool ShareATracklet(const PeopleObservations& people, const Person& earlier, const Person& later) {
  const Lanes& lanes = people.lanes;
  for (int v = 0; v < lanes.view_count; ++v) {
    int before = -1;
    for (int t = lanes.frame_count - 1; t >= 0 && before < 0; --t) {
      if (earlier.At(t, v) >= 0) before = lanes.Owner(earlier.At(t, v), v, t);
    }
    for (int t = 0; t < lanes.frame_count && before >= 0; ++t) {
      if (later.At(t, v) < 0) continue;
      if (lanes.Owner(later.At(t, v), v, t) == before) return true;
      break;
    }
  }
  return false;
}

void Merge(const Person& other, Person& person) {
  for (std::size_t i = 0; i < person.lanes.size(); ++i) {
    if (person.lanes[i] < 0) person.lanes[i] = other.lanes[i];
  }
}

/// Finds the next two to join: the first pair that tracklets join, or the pair with the most alike bones.
class PartJoiner {
 public:
  PartJoiner(const PeopleObservations& people, const CameraRays& rays, std::vector<Person> persons)
      : people_(people), rays_(rays), persons_(std::move(persons)) {
    for (const Person& person : persons_) parts_.push_back(Summarise(people, rays, person));
  }

  std::vector<Person> Run() {
    while (const auto pair = NextInOnePlace()) Join(pair->first, pair->second);
    while (const auto pair = NextByTracklet()) Join(pair->first, pair->second);
    while (const auto pair = NextByBones()) Join(pair->first, pair->second);
    return std::move(persons_);
  }

 private:
  using Indices = std::pair<std::size_t, std::size_t>;

  /// Whom no view shows as two, and who are about in one place whenever both are there: some views see them where the
  /// others do not quite, since a camera is a little off.
  [[nodiscard]] std::optional<Indices> NextInOnePlace() const {
    for (std::size_t a = 0; a < persons_.size(); ++a) {
      for (std::size_t b = a + 1; b < persons_.size(); ++b) {
        if (!AreApart(persons_[a], persons_[b])) continue;
        std::vector<int> common;
        for (const int t : persons_[a].FramesWith(2)) {
          if (persons_[b].ViewsAt(t) >= 2) common.push_back(t);
        }
        if (static_cast<int>(common.size()) < kShortestFrames) continue;
        std::vector<double> distances;
        for (const int t : EvenlySpread(common, kFramesOfPerson)) {
          const double distance =
              (PlaceOf(people_, rays_, persons_[a], t) - PlaceOf(people_, rays_, persons_[b], t)).norm();
          if (std::isfinite(distance)) distances.push_back(distance);
        }
        if (!distances.empty() && Median(std::move(distances)) < kOnePlace) return {{a, b}};
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Indices> NextByTracklet() const {
    for (std::size_t a = 0; a < persons_.size(); ++a) {
      for (std::size_t b = 0; b < persons_.size(); ++b) {
        if (a == b || parts_[a].frames == 0 || parts_[b].frames == 0 || parts_[a].last > parts_[b].first) continue;
        const double gap = (parts_[b].first - parts_[a].last) / people_.lanes.fps;
        if (gap > kLongestJoinSeconds || !((parts_[b].first_place - parts_[a].last_place).norm() < kNearEnough))
          continue;
        if (AreApart(persons_[a], persons_[b]) && ShareATracklet(people_, persons_[a], persons_[b])) return {{a, b}};
      }
    }
    return std::nullopt;
  }

  /// Somebody who comes back: the bones are alike, and clearly less alike those of everybody else who might have been
  /// meant, on either side.
  [[nodiscard]] std::optional<Indices> NextByBones() const {
    std::optional<Indices> best;
    double least = kSameBones;
    for (std::size_t a = 0; a < persons_.size(); ++a) {
      for (std::size_t b = a + 1; b < persons_.size(); ++b) {
        if (!CouldBeOne(a, b)) continue;
        const double difference = BoneDifference(parts_[a], parts_[b]);
        if (difference >= least || HasRival(a, b, difference) || HasRival(b, a, difference)) continue;
        least = difference;
        best = {a, b};
      }
    }
    return best;
  }

  [[nodiscard]] bool CouldBeOne(std::size_t a, std::size_t b) const {
    if (parts_[a].frames < kFramesForBones || parts_[b].frames < kFramesForBones) return false;
    return AreApart(persons_[a], persons_[b]) &&
           (parts_[a].last < parts_[b].first || parts_[b].last < parts_[a].first || !Overlap(a, b));
  }

  [[nodiscard]] bool Overlap(std::size_t a, std::size_t b) const {
    for (int t = 0; t < people_.lanes.frame_count; ++t) {
      if (persons_[a].ViewsAt(t) > 0 && persons_[b].ViewsAt(t) > 0) return true;
    }
    return false;
  }

  [[nodiscard]] bool HasRival(std::size_t person, std::size_t partner, double difference) const {
    for (std::size_t other = 0; other < persons_.size(); ++other) {
      if (other == person || other == partner || !CouldBeOne(person, other)) continue;
      // Another part of the same person is no rival.
      if (!Overlap(partner, other) && BoneDifference(parts_[partner], parts_[other]) < kSameBones) continue;
      if (BoneDifference(parts_[person], parts_[other]) < difference + kClearlyOtherBones) return true;
    }
    return false;
  }

  void Join(std::size_t a, std::size_t b) {
    Merge(persons_[b], persons_[a]);
    persons_.erase(persons_.begin() + static_cast<std::ptrdiff_t>(b));
    parts_[a] = Summarise(people_, rays_, persons_[b < a ? a - 1 : a]);
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(b));
  }

  const PeopleObservations& people_;
  const CameraRays& rays_;
  std::vector<Person> persons_;
  std::vector<Part> parts_;
};

template <typename Visit>
void VisitSightings(const PeopleObservations& people, const CameraRays& rays, const Person& person, Visit&& visit) {
  for (const int frame : EvenlySpread(person.FramesWith(2), kFramesOfPerson)) {
    const JointPositions joints = JointsOf(people, rays, person, frame);
    for (int v = 0; v < people.lanes.view_count; ++v) {
      const int lane = person.At(frame, v);
      if (lane >= 0 && rays.IsKnown(v)) visit(frame, ViewSighting{v, people.FrameOf(lane, frame)}, joints);
    }
  }
}

}  // namespace

double MeanMisfit(const PeopleObservations& people, const CameraRays& rays, const Person& person) {
  double sum = 0.0;
  int count = 0;
  VisitSightings(people, rays, person, [&](int /*frame*/, const ViewSighting& sighting, const JointPositions& joints) {
    sum += rays.Distance(sighting, joints, kFarOffUnit);
    ++count;
  });
  return count > 0 ? sum / count : 1.0;
}

double ShareWithoutRival(const PeopleObservations& people, const CameraRays& rays, const Person& person) {
  const Lanes& lanes = people.lanes;
  int sure = 0;
  int count = 0;
  VisitSightings(people, rays, person, [&](int frame, const ViewSighting& sighting, const JointPositions& joints) {
    const double own = rays.Distance(sighting, joints, kFarOffUnit);
    bool has_rival = false;
    for (int lane = 0; lane < lanes.lane_count; ++lane) {
      const int other = people.FrameOf(lane, frame);
      if (other == sighting.frame || lanes.Owner(lane, sighting.view, frame) < 0) continue;
      has_rival = has_rival || rays.Distance({sighting.view, other}, joints, kFarOffUnit) < own + kRivalMargin;
    }
    sure += has_rival ? 0 : 1;
    ++count;
  });
  return count > 0 ? static_cast<double>(sure) / count : 0.0;
}

std::vector<Person> JoinParts(const PeopleObservations& people, const CameraRays& rays, std::vector<Person> persons) {
  return PartJoiner(people, rays, std::move(persons)).Run();
}

std::vector<std::string> LeaveOutFalsePeople(const PeopleObservations& people, const CameraRays& rays,
                                             std::vector<Person>& persons) {
  const int shortest = std::max(kShortestFrames, static_cast<int>(std::lround(kShortestSeconds * people.lanes.fps)));
  std::vector<std::string> left_out;
  int shorts = 0;
  int longest_short = 0;
  std::erase_if(persons, [&](const Person& person) {
    const std::vector<int> frames = person.FramesWith(2);
    if (static_cast<int>(frames.size()) < shortest) {
      ++shorts;
      longest_short = std::max(longest_short, static_cast<int>(frames.size()));
      return true;
    }
    const double misfit = MeanMisfit(people, rays, person);
    if (misfit < kPoorFit) return false;
    left_out.push_back(
        fmt::format("somebody in frames {} to {} is left out: the cameras do not agree on one person (keypoints are "
                    "{:.1f} % of the "
                    "body's size off)",
                    frames.front(), frames.back(), 100.0 * kFarOffUnit * misfit));
    return true;
  });
  if (shorts > 0) {
    left_out.push_back(
        fmt::format("{} sightings that two cameras share for at most {} frames are left out", shorts, longest_short));
  }
  return left_out;
}

}  // namespace canonpose
