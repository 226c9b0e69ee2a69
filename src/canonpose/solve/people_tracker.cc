#include "canonpose/solve/people_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "canonpose/solve/assignment.h"
#include "canonpose/solve/new_people.h"

namespace canonpose {
namespace {

/// Distances in body units, of which a person is about 4.5 m.
constexpr double kFarOff = 0.05;
/// A prediction from longer ago may be so much farther off, per second, and altogether.
constexpr double kFarOffPerSecond = 0.25;
constexpr double kFarthestOff = 0.2;
/// Of mean distances, 1 being far off.
constexpr double kPredictedLimit = 0.8;
constexpr double kSameTrackletFactor = 0.6;
constexpr double kDisagreement = 0.6;
constexpr double kGoodAgreement = 0.5;
/// People who are not seen move on for a while, ever more slowly.
constexpr double kCoastingSeconds = 1.0;
constexpr double kSpeedKept = 0.9;
constexpr double kNewestSpeed = 0.3;
/// Somebody who appears near where a person was lost a moment ago is that person. Who comes later is known by the bones
/// (people_parts.h): in three seconds, one of a group leaves and another comes.
constexpr double kReturnSeconds = 1.5;
constexpr double kReturnDistance = 0.08;
constexpr double kReturnPerSecond = 0.25;
/// Two people whose joints are nearer to each other than this, and whom no view sees as two, are one.
constexpr double kSamePlace = 0.04;
constexpr int kSamePlaceFrames = 5;

double MeanDistance(const JointPositions& a, const JointPositions& b) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (!a[j].allFinite() || !b[j].allFinite()) continue;
    sum += (a[j] - b[j]).norm();
    ++count;
  }
  return count > 0 ? sum / count : std::nan("");
}

/// A person who is being followed.
struct Followed {
  Person person;
  JointPositions joints;                               ///< at `last_seen`, and from longer ago where not seen since
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< per frame
  int last_seen = 0;
  bool is_solid = false;                                ///< two views agreed in the frame `last_seen`
  std::vector<int> tracklets;                           ///< (V) that showed the person last; -1: none
  std::vector<LaneSighting> seen;                       ///< in the frame in question
  bool is_gone = false;                                 ///< was somebody else
  std::vector<std::pair<std::size_t, int>> same_place;  ///< with whom, for how many frames
};

class PeopleTracker {
 public:
  PeopleTracker(const PeopleObservations& people, const KnownCameras& known)
      : people_(people), rays_(people.capture, known.cameras), new_people_(people, rays_, known.bones) {}

  void Step(int frame) {
    frame_ = frame;
    std::vector<LaneSighting> free = Sightings();
    for (Followed& followed : people_followed_) followed.seen.clear();
    AssignPredicted(free);
    for (Followed& followed : people_followed_) {
      if (!followed.seen.empty()) Update(followed, free);
    }
    AssignLeftOver(free);
    for (const std::vector<LaneSighting>& group : new_people_.Find(free, frame)) Welcome(group);
    JoinSamePlace();
    Record();
  }

  FollowedPeople Finish() {
    FollowedPeople result;
    for (Followed& followed : people_followed_) {
      if (!followed.is_gone) result.persons.push_back(std::move(followed.person));
    }
    result.sightings = sightings_;
    result.explained = explained_;
    result.links = links_;
    result.error = explained_ > 0 ? kFarOff * error_ / explained_ : 0.0;
    return result;
  }

 private:
  /// Those of the views that are known; counts all.
  std::vector<LaneSighting> Sightings() {
    const Lanes& lanes = people_.lanes;
    std::vector<LaneSighting> sightings;
    for (int v = 0; v < lanes.view_count; ++v) {
      for (int lane = 0; lane < lanes.lane_count; ++lane) {
        const int tracklet = lanes.Owner(lane, v, frame_);
        if (tracklet < 0) continue;
        ++sightings_;
        if (rays_.IsKnown(v)) sightings.push_back({v, lane, tracklet, people_.FrameOf(lane, frame_)});
      }
    }
    return sightings;
  }

  static ViewSighting InView(const LaneSighting& sighting) { return {sighting.view, sighting.frame}; }
  static std::vector<ViewSighting> InViews(const std::vector<LaneSighting>& sightings) {
    std::vector<ViewSighting> views;
    for (const LaneSighting& sighting : sightings) views.push_back(InView(sighting));
    return views;
  }

  [[nodiscard]] double SecondsSince(int frame) const { return (frame_ - frame) / people_.lanes.fps; }

  [[nodiscard]] JointPositions Predict(const Followed& followed) const {
    const int gap = frame_ - followed.last_seen;
    const Eigen::Vector3d moved =
        followed.velocity * (1.0 - std::pow(kSpeedKept, gap)) / (1.0 - kSpeedKept) * kSpeedKept;
    JointPositions joints = followed.joints;
    for (Eigen::Vector3d& joint : joints) joint += moved;
    return joints;
  }

  /// Each view's sightings, to the people whom they fit best by prediction.
  void AssignPredicted(std::vector<LaneSighting>& free) {
    std::vector<std::size_t> present;
    std::vector<JointPositions> predicted;
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      const Followed& followed = people_followed_[p];
      if (followed.is_gone || SecondsSince(followed.last_seen) > kCoastingSeconds) continue;
      present.push_back(p);
      predicted.push_back(Predict(followed));
    }
    const auto cost = [&](std::size_t i, const LaneSighting& sighting) {
      const Followed& followed = people_followed_[present[i]];
      // The frame before is the usual case.
      const double gap = std::max(0.0, SecondsSince(followed.last_seen) - 1.0 / people_.lanes.fps);
      const double unit = std::min(kFarthestOff, kFarOff + kFarOffPerSecond * gap);
      const double distance = rays_.Distance(InView(sighting), predicted[i], unit);
      const bool is_same = followed.tracklets[static_cast<std::size_t>(sighting.view)] == sighting.tracklet;
      return is_same ? kSameTrackletFactor * distance : distance;
    };
    AssignTo(present, cost, kPredictedLimit, free);
  }

  /// Assigns free sightings of each view to people whom the view does not show yet, and takes them out of `free`.
  template <typename Cost>
  void AssignTo(const std::vector<std::size_t>& present, const Cost& cost, double limit,
                std::vector<LaneSighting>& free) {
    for (int v = 0; v < people_.lanes.view_count; ++v) {
      std::vector<std::size_t> of_view;
      for (std::size_t i = 0; i < free.size(); ++i) {
        if (free[i].view == v) of_view.push_back(i);
      }
      std::vector<std::size_t> rows;
      for (std::size_t i = 0; i < present.size(); ++i) {
        const std::vector<LaneSighting>& seen = people_followed_[present[i]].seen;
        if (std::ranges::none_of(seen, [&](const LaneSighting& s) { return s.view == v; })) rows.push_back(i);
      }
      if (of_view.empty() || rows.empty()) continue;
      std::vector<std::vector<double>> costs;
      for (const std::size_t i : rows) {
        std::vector<double>& row = costs.emplace_back();
        for (const std::size_t s : of_view) row.push_back(cost(i, free[s]));
      }
      const std::vector<int> assigned = AssignAtLeastCost(costs, limit);
      std::vector<std::size_t> taken;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        if (assigned[r] < 0) continue;
        taken.push_back(of_view[static_cast<std::size_t>(assigned[r])]);
        people_followed_[present[rows[r]]].seen.push_back(free[taken.back()]);
      }
      std::ranges::sort(taken, std::greater<>());
      for (const std::size_t s : taken) free.erase(free.begin() + static_cast<std::ptrdiff_t>(s));
    }
  }

  /// The sighting that the others contradict most, if one does: its place in `seen`; -1 otherwise.
  [[nodiscard]] int Contradicted(const std::vector<LaneSighting>& seen, const JointPositions& predicted) const {
    int worst = -1;
    double largest = kDisagreement;
    if (seen.size() == 2) {
      // Nothing says which of the two is wrong but the prediction.
      const JointPositions joints = rays_.Triangulate(InViews(seen));
      const double distance = std::max(rays_.Distance(InView(seen[0]), joints, 0.5 * kFarOff),
                                       rays_.Distance(InView(seen[1]), joints, 0.5 * kFarOff));
      if (distance <= kDisagreement) return -1;
      const double first = rays_.Distance(InView(seen[0]), predicted, kFarthestOff);
      const double second = rays_.Distance(InView(seen[1]), predicted, kFarthestOff);
      return first > second ? 0 : 1;
    }
    for (std::size_t i = 0; seen.size() > 2 && i < seen.size(); ++i) {
      std::vector<LaneSighting> others = seen;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const JointPositions joints = rays_.Triangulate(InViews(others), &predicted);
      // How well the others agree without it says whether it is the one.
      double rest = 0.0;
      for (const LaneSighting& other : others) rest += rays_.Distance(InView(other), joints, kFarOff);
      const double distance =
          rays_.Distance(InView(seen[i]), joints, kFarOff) - rest / static_cast<double>(others.size());
      if (distance <= largest) continue;
      largest = distance;
      worst = static_cast<int>(i);
    }
    return worst;
  }

  /// Moves a person to what views saw of them, without what the others contradict, which becomes free.
  void Update(Followed& followed, std::vector<LaneSighting>& free) {
    const JointPositions predicted = Predict(followed);
    for (int wrong = Contradicted(followed.seen, predicted); wrong >= 0;
         wrong = Contradicted(followed.seen, predicted)) {
      free.push_back(followed.seen[static_cast<std::size_t>(wrong)]);
      followed.seen.erase(followed.seen.begin() + wrong);
    }
    Place(followed, predicted);
  }

  void Place(Followed& followed, const JointPositions& predicted) {
    const Eigen::Vector3d before = Middle(followed.joints);
    const int gap = std::max(1, frame_ - followed.last_seen);
    JointPositions joints = predicted;
    if (followed.seen.size() >= 2) {
      const JointPositions found = rays_.Triangulate(InViews(followed.seen), &predicted);
      for (std::size_t j = 0; j < joints.size(); ++j) {
        if (found[j].allFinite()) joints[j] = found[j];
      }
    } else {
      const Eigen::Vector3d shift = rays_.ShiftTo(InView(followed.seen.front()), predicted);
      for (Eigen::Vector3d& joint : joints) joint += shift;
    }
    followed.is_solid = followed.seen.size() >= 2;
    followed.joints = std::move(joints);
    if (frame_ > followed.last_seen) {
      const Eigen::Vector3d moved = (Middle(followed.joints) - before) / gap;
      followed.velocity += kNewestSpeed * (moved - followed.velocity);
    }
    followed.last_seen = frame_;
  }

  /// What nobody was predicted to be, to people whom other views show in this frame. A person whom a single view shows
  /// may have been made up of somebody else's sighting.
  void AssignLeftOver(std::vector<LaneSighting>& free) {
    std::vector<std::size_t> solid;
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      Followed& followed = people_followed_[p];
      if (followed.is_gone || followed.seen.empty()) continue;
      if (followed.seen.size() >= 2) solid.push_back(p);
    }
    std::vector<std::pair<std::size_t, LaneSighting>> lent;
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      Followed& followed = people_followed_[p];
      if (followed.is_gone || followed.seen.size() != 1) continue;
      lent.emplace_back(p, followed.seen.front());
      free.push_back(followed.seen.front());
    }
    const auto cost = [&](std::size_t i, const LaneSighting& sighting) {
      return rays_.Distance(InView(sighting), people_followed_[solid[i]].joints, kFarOff);
    };
    AssignTo(solid, cost, kGoodAgreement, free);
    for (const auto& [p, sighting] : lent) {
      const auto left = std::ranges::find_if(
          free, [&](const LaneSighting& s) { return s.view == sighting.view && s.lane == sighting.lane; });
      if (left == free.end()) {
        people_followed_[p].seen.clear();
      } else {
        free.erase(left);
      }
    }
    // A person whom a single view shows, and a free sighting of another view that agrees with it.
    std::vector<std::size_t> single;
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      if (!people_followed_[p].is_gone && people_followed_[p].seen.size() == 1) single.push_back(p);
    }
    const auto cost_of_single = [&](std::size_t i, const LaneSighting& sighting) {
      return rays_.Distance(InView(sighting), people_followed_[single[i]].joints, kFarOff);
    };
    AssignTo(single, cost_of_single, kGoodAgreement, free);
    for (const std::size_t p : single) {
      if (people_followed_[p].seen.size() >= 2) Update(people_followed_[p], free);
    }
  }

  /// A new person, or one who was lost a moment ago.
  void Welcome(const std::vector<LaneSighting>& group) {
    const JointPositions joints = rays_.Triangulate(InViews(group));
    const Eigen::Vector3d place = Middle(joints);
    if (!place.allFinite()) return;
    std::size_t best = people_followed_.size();
    double nearest = 1.0;
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      const Followed& followed = people_followed_[p];
      const double seconds = SecondsSince(followed.last_seen);
      if (followed.is_gone || !followed.seen.empty() || seconds > kReturnSeconds) continue;
      const double distance = (Middle(Predict(followed)) - place).norm();
      const double relative = distance / (kReturnDistance + kReturnPerSecond * seconds);
      if (relative >= nearest) continue;
      nearest = relative;
      best = p;
    }
    if (best == people_followed_.size()) {
      Followed& created = people_followed_.emplace_back();
      created.person = Person(people_.lanes);
      created.tracklets.assign(static_cast<std::size_t>(people_.lanes.view_count), -1);
      created.joints.assign(joints.size(), Eigen::Vector3d::Constant(std::nan("")));
    }
    Followed& followed = people_followed_[best];
    followed.seen = group;
    followed.joints = joints;
    followed.velocity.setZero();
    followed.is_solid = true;
    followed.last_seen = frame_;
  }

  /// People who have been in one place for a while without being seen as two.
  void JoinSamePlace() {
    for (std::size_t p = 0; p < people_followed_.size(); ++p) {
      for (std::size_t q = p + 1; q < people_followed_.size(); ++q) {
        Followed& first = people_followed_[p];
        Followed& second = people_followed_[q];
        if (first.is_gone || second.is_gone || first.seen.empty() || second.seen.empty()) continue;
        auto known = std::ranges::find_if(first.same_place, [&](const auto& entry) { return entry.first == q; });
        if (!AreInOnePlace(first, second)) {
          if (known != first.same_place.end()) known->second = 0;
          continue;
        }
        if (known == first.same_place.end()) known = first.same_place.insert(known, {q, 0});
        if (++known->second < kSamePlaceFrames) continue;
        Join(first, second);
      }
    }
  }

  [[nodiscard]] static bool AreInOnePlace(const Followed& first, const Followed& second) {
    const bool share_a_view = std::ranges::any_of(first.seen, [&](const LaneSighting& a) {
      return std::ranges::any_of(second.seen, [&](const LaneSighting& b) { return a.view == b.view; });
    });
    return !share_a_view && MeanDistance(first.joints, second.joints) < kSamePlace;
  }

  void Join(Followed& first, Followed& second) const {
    for (std::size_t i = 0; i < first.person.lanes.size(); ++i) {
      if (first.person.lanes[i] < 0) first.person.lanes[i] = second.person.lanes[i];
    }
    first.seen.insert(first.seen.end(), second.seen.begin(), second.seen.end());
    first.last_seen = std::max(first.last_seen, second.last_seen);
    second.seen.clear();
    second.is_gone = true;
  }

  void Record() {
    for (Followed& followed : people_followed_) {
      if (followed.is_gone) continue;
      if (followed.seen.size() >= 2) links_ += static_cast<int>(followed.seen.size()) - 1;
      for (const LaneSighting& sighting : followed.seen) {
        followed.person.At(frame_, sighting.view) = sighting.lane;
        followed.tracklets[static_cast<std::size_t>(sighting.view)] = sighting.tracklet;
        if (followed.seen.size() < 2) continue;
        ++explained_;
        error_ += rays_.Distance(InView(sighting), followed.joints, kFarOff);
      }
    }
  }

  const PeopleObservations& people_;
  CameraRays rays_;
  NewPeople new_people_;
  int frame_ = 0;
  std::vector<Followed> people_followed_;
  int sightings_ = 0;
  int explained_ = 0;
  int links_ = 0;
  double error_ = 0.0;
};

}  // namespace

double FollowedPeople::Score(int view_count) const {
  if (sightings == 0 || view_count < 2) return 0.0;
  const double possible = sightings * (view_count - 1.0) / view_count;
  return links * std::max(0.0, 1.0 - error / kFarOff) / possible;
}

FollowedPeople FollowPeople(const PeopleObservations& people, const KnownCameras& known, std::span<const int> frames) {
  PeopleTracker tracker(people, known);
  for (const int frame : frames) tracker.Step(frame);
  return tracker.Finish();
}

std::vector<ViewSighting> SightingsOf(const PeopleObservations& people, const CameraRays& rays, const Person& person,
                                      int frame, int without) {
  std::vector<ViewSighting> sightings;
  for (int v = 0; v < people.lanes.view_count; ++v) {
    const int lane = person.At(frame, v);
    if (v != without && lane >= 0 && rays.IsKnown(v)) sightings.push_back({v, people.FrameOf(lane, frame)});
  }
  return sightings;
}

JointPositions JointsOf(const PeopleObservations& people, const CameraRays& rays, const Person& person, int frame) {
  return rays.Triangulate(SightingsOf(people, rays, person, frame));
}

}  // namespace canonpose
