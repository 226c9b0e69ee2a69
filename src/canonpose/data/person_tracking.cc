#include "canonpose/data/person_tracking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/track_joining.h"

namespace canonpose {
namespace {

using Eigen::Vector2d;

constexpr int kLongestGap = 60;
/// In a gap a person is assumed to move on, by at most this many frames' velocity, since the assumption becomes ever
/// less certain.
constexpr double kCoastingFrames = 15.0;
/// Costs are mean keypoint distances in person sizes (box diagonals).
constexpr double kCostLimit = 0.5;
constexpr double kCostLimitPerGapFrame = 0.03;
constexpr double kLargestCostLimit = 1.2;
/// The cost of a detection with the track's own id is multiplied by this.
constexpr double kSameIdFactor = 0.25;
/// Above this fraction of the first person's prominence, the second person might be the one who is meant.
constexpr double kCloseCallShare = 0.6;

/// One detection as the tracker sees it.
struct Pose {
  std::vector<Vector2d> points;  ///< (K) px
  std::vector<double> weights;   ///< (K) 0 where missing
  double size_px = 0.0;
  double mean_confidence = 0.0;
  int seen = 0;
  std::optional<std::int64_t> id;
};

Pose MakePose(const DetectedPerson& person) {
  Pose pose;
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
  Vector2d high = -low;
  pose.points.reserve(person.confidence.size());
  pose.weights.reserve(person.confidence.size());
  for (std::size_t k = 0; k < person.confidence.size(); ++k) {
    const Vector2d point(person.keypoints[2 * k], person.keypoints[2 * k + 1]);
    pose.points.push_back(point);
    pose.weights.push_back(person.confidence[k]);
    if (person.confidence[k] <= 0.0F) continue;
    ++pose.seen;
    pose.mean_confidence += static_cast<double>(person.confidence[k]) / static_cast<double>(person.confidence.size());
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  // A single keypoint has no size; one pixel keeps divisions finite.
  pose.size_px = std::max(1.0, (high - low).norm());
  pose.id = person.track_id;
  return pose;
}

class Tracker {
 public:
  void Step(int frame, const std::vector<DetectedPerson>& people) {
    std::vector<Pose> poses;
    poses.reserve(people.size());
    for (const DetectedPerson& person : people) poses.push_back(MakePose(person));
    const std::vector<int> track_of = Assign(frame, poses);
    for (std::size_t p = 0; p < poses.size(); ++p) {
      if (track_of[p] < 0) {
        Start(frame, static_cast<int>(p), poses[p]);
      } else {
        Continue(tracks_[static_cast<std::size_t>(track_of[p])], frame, static_cast<int>(p), poses[p]);
      }
    }
  }

  std::vector<PersonTrack> Finish() {
    std::vector<PersonTrack> results;
    for (Track& track : tracks_) results.push_back(std::move(track.result));
    std::stable_sort(results.begin(), results.end(),
                     [](const PersonTrack& a, const PersonTrack& b) { return a.prominence > b.prominence; });
    return results;
  }

 private:
  struct Track {
    PersonTrack result;
    Pose last;  ///< the latest position of every keypoint ever seen
    Vector2d velocity_px = Vector2d::Zero();
    int last_frame = 0;
  };

  /// The track of each person in a frame; -1 for a new track.
  std::vector<int> Assign(int frame, const std::vector<Pose>& poses) const {
    struct Pair {
      double cost;
      int track;
      int person;
    };
    std::vector<Pair> pairs;
    std::vector<std::vector<double>> costs(poses.size(), std::vector<double>(tracks_.size(), kImpossible));
    for (std::size_t p = 0; p < poses.size(); ++p) {
      for (std::size_t t = 0; t < tracks_.size(); ++t) {
        const double cost = Cost(tracks_[t], frame, poses[p]);
        if (cost >= kImpossible) continue;
        costs[p][t] = cost;
        pairs.push_back({cost, static_cast<int>(t), static_cast<int>(p)});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
    std::vector<int> track_of(poses.size(), -1);
    std::vector<bool> is_taken(tracks_.size(), false);
    for (const Pair& pair : pairs) {
      const auto t = static_cast<std::size_t>(pair.track);
      const auto p = static_cast<std::size_t>(pair.person);
      if (is_taken[t] || track_of[p] >= 0) continue;
      track_of[p] = pair.track;
      is_taken[t] = true;
    }
    SwapWhereBetter(costs, track_of);
    return track_of;
  }

  /// Assigning the cheapest pair first may leave an expensive one for the end; swapping two assignments fixes that for
  /// people who cross.
  static void SwapWhereBetter(const std::vector<std::vector<double>>& costs, std::vector<int>& track_of) {
    bool has_changed = true;
    while (has_changed) {
      has_changed = false;
      for (std::size_t a = 0; a < track_of.size(); ++a) {
        for (std::size_t b = a + 1; b < track_of.size(); ++b) {
          if (track_of[a] < 0 || track_of[b] < 0) continue;
          const auto ta = static_cast<std::size_t>(track_of[a]);
          const auto tb = static_cast<std::size_t>(track_of[b]);
          if (costs[a][tb] + costs[b][ta] >= costs[a][ta] + costs[b][tb] - 1e-9) continue;
          std::swap(track_of[a], track_of[b]);
          has_changed = true;
        }
      }
    }
  }

  static double Cost(const Track& track, int frame, const Pose& pose) {
    const int gap = frame - track.last_frame;
    const bool has_same_id = track.last.id && pose.id && *track.last.id == *pose.id;
    if (gap > kLongestGap && !has_same_id) return kImpossible;
    const double coasting = kCoastingFrames * (1.0 - std::exp(-gap / kCoastingFrames));
    const Vector2d shift = track.velocity_px * coasting;
    const double size = 0.5 * (track.last.size_px + pose.size_px);
    double sum = 0.0;
    double weight = 0.0;
    int common = 0;
    for (std::size_t k = 0; k < pose.points.size(); ++k) {
      const double w = std::min(pose.weights[k], track.last.weights[k]);
      if (w <= 0.0) continue;
      sum += w * std::min(2.0, (track.last.points[k] + shift - pose.points[k]).norm() / size);
      weight += w;
      ++common;
    }
    if (common == 0) return kImpossible;
    const double missing_share = 1.0 - static_cast<double>(common) / std::max(pose.seen, track.last.seen);
    double cost = sum / weight + 0.1 * missing_share + 0.1 * std::abs(std::log(pose.size_px / track.last.size_px));
    if (has_same_id) return kSameIdFactor * cost;
    const double limit = std::min(kLargestCostLimit, kCostLimit + kCostLimitPerGapFrame * (gap - 1));
    // Two ids are two people, unless a tracker lost one and found them again under a new number.
    if (track.last.id && pose.id) cost *= 2.0;
    return cost < limit ? cost : kImpossible;
  }

  void Start(int frame, int person, const Pose& pose) {
    Track track;
    track.last = pose;
    track.last_frame = frame;
    Record(track, frame, person, pose);
    tracks_.push_back(std::move(track));
  }

  static void Continue(Track& track, int frame, int person, const Pose& pose) {
    Vector2d moved = Vector2d::Zero();
    double weight = 0.0;
    for (std::size_t k = 0; k < pose.points.size(); ++k) {
      const double w = std::min(pose.weights[k], track.last.weights[k]);
      if (w <= 0.0) continue;
      moved += w * (pose.points[k] - track.last.points[k]);
      weight += w;
    }
    if (weight > 0.0) moved /= weight;
    const int gap = frame - track.last_frame;
    const double newest_share = track.result.sightings.size() == 1 ? 1.0 : 0.3;
    track.velocity_px += newest_share * (moved / gap - track.velocity_px);
    for (std::size_t k = 0; k < pose.points.size(); ++k) {
      if (pose.weights[k] > 0.0) {
        track.last.points[k] = pose.points[k];
        track.last.weights[k] = pose.weights[k];
      } else {
        // An unseen keypoint moves with the others and gets less and less weight.
        track.last.points[k] += moved;
        track.last.weights[k] *= 0.8;
      }
    }
    track.last.size_px += 0.3 * (pose.size_px - track.last.size_px);
    track.last.seen = pose.seen;
    if (pose.id) track.last.id = pose.id;
    track.last_frame = frame;
    Record(track, frame, person, pose);
  }

  static void Record(Track& track, int frame, int person, const Pose& pose) {
    track.result.sightings.push_back({frame, person});
    track.result.prominence += pose.size_px * pose.mean_confidence;
  }

  static constexpr double kImpossible = 1e9;
  std::vector<Track> tracks_;
};

std::string Ordinal(int number) {
  if (number == 1) return "the most prominent";
  const int last = number % 10;
  const bool is_teen = number % 100 >= 11 && number % 100 <= 13;
  const char* suffix = is_teen ? "th" : last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th";
  return fmt::format("the {}{} most prominent", number, suffix);
}

/// Logs who is followed, and warns where that might not be who is meant.
void LogChoice(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks, int number) {
  const auto people = std::count_if(tracks.begin(), tracks.end(), [&](const PersonTrack& track) {
    return track.prominence >= kPersonShare * tracks.front().prominence;
  });
  const PersonTrack& chosen = tracks[static_cast<std::size_t>(number - 1)];
  const std::size_t frames = camera.frames.size();
  if (people == 1 && number == 1) {
    LogInfo("{}: 1 person seen, in {} of {} frames", camera.name, chosen.sightings.size(), frames);
    return;
  }
  LogInfo("{}: {} people seen; following {}, in {} of {} frames", camera.name, people, Ordinal(number),
          chosen.sightings.size(), frames);
  if (number == 1 && tracks[1].prominence > kCloseCallShare * chosen.prominence) {
    LogWarning(
        "{}: the second most prominent person is {:.0f} % as prominent as the one followed; to follow the second, set "
        "`person` {}=2",
        camera.name, 100.0 * tracks[1].prominence / chosen.prominence, camera.name);
  }
}

/// Logs where the person was lost for long and found again, and warns where they may have continued as somebody else.
void LogLosses(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks, int number) {
  const auto chosen = static_cast<std::size_t>(number - 1);
  const auto number_of = [&](int frame) { return camera.frames[static_cast<std::size_t>(frame)].number; };
  for (const int frame : tracks[chosen].returns) {
    LogInfo("{}: the person who appears at frame {} is assumed to be the person followed, who has returned",
            camera.name, number_of(frame));
  }
  const std::vector<int> lost = FramesOfPossibleParts(camera, tracks, chosen);
  if (lost.empty()) return;
  LogWarning(
      "{}: {} frames ({} to {}) are lost: the person followed is not seen there, but somebody similar is, who may be "
      "the same person; cut the clip, or use a detector that writes track ids",
      camera.name, lost.size(), number_of(lost.front()), number_of(lost.back()));
}

}  // namespace

std::vector<PersonTrack> TrackPeople(const DetectedCamera& camera) {
  Tracker tracker;
  for (std::size_t frame = 0; frame < camera.frames.size(); ++frame) {
    tracker.Step(static_cast<int>(frame), camera.frames[frame].people);
  }
  return JoinTracks(camera, tracker.Finish());
}

KeypointClip FollowPerson(const DetectedCamera& camera, int number) {
  const std::vector<PersonTrack> tracks = TrackPeople(camera);
  if (number < 1 || number > static_cast<int>(tracks.size())) {
    ThrowBadInput({camera.path, "", fmt::format("{} people in camera {}", number, camera.name),
                   fmt::format("{}", tracks.size()), "choose a smaller `person`"});
  }
  LogChoice(camera, tracks, number);
  LogLosses(camera, tracks, number);
  const PersonTrack& track = tracks[static_cast<std::size_t>(number - 1)];
  const auto count = static_cast<std::size_t>(camera.keypoint_count);
  KeypointClip clip;
  clip.name = camera.name;
  clip.path = camera.path;
  clip.keypoint_count = camera.keypoint_count;
  clip.seconds_per_number = camera.seconds_per_number;
  clip.keypoints.assign(camera.frames.size() * count * 2, std::numeric_limits<float>::quiet_NaN());
  clip.confidence.assign(camera.frames.size() * count, 0.0F);
  for (const DetectedFrame& frame : camera.frames) clip.frame_numbers.push_back(frame.number);
  for (const PersonTrack::Sighting& sighting : track.sightings) {
    const auto t = static_cast<std::size_t>(sighting.frame);
    const DetectedPerson& person = camera.frames[t].people[static_cast<std::size_t>(sighting.person)];
    std::copy(person.keypoints.begin(), person.keypoints.end(),
              clip.keypoints.begin() + static_cast<std::ptrdiff_t>(t * count * 2));
    std::copy(person.confidence.begin(), person.confidence.end(),
              clip.confidence.begin() + static_cast<std::ptrdiff_t>(t * count));
  }
  return clip;
}

}  // namespace canonpose
