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
/// A person's size, by the keypoints that two sightings share, changes by less than these factors: from one frame to
/// the next, and for each frame more.
constexpr double kLargestScale = 1.4;
constexpr double kLogScalePerGapFrame = 0.015;
constexpr int kFewestForScale = 5;
/// A change that was under way may go on unseen, and faster by this factor.
constexpr double kScaleGoesOn = 1.5;
/// With the same track id, a person may have gone farther than the costs' limit, but not into another's place at once.
constexpr double kSameIdCostLimit = 1.0;
constexpr double kSameIdCostLimitPerGapFrame = 0.05;
/// A jump that may be to somebody else: over at most so many frames, by more than this fraction of the size, and by
/// more than so many usual steps for each frame.
constexpr int kLongestJump = 15;
constexpr double kSmallestJump = 0.4;
constexpr double kJumpInSteps = 8.0;
/// Somebody else counts from this fraction of the person's prominence in a frame.
constexpr double kReplacementShare = 0.15;
/// An absence of fewer frames is not worth a message.
constexpr int kShortestAbsence = 5;
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

/// The size of `later` relative to `earlier` by the spread of the keypoints that both have; 1 where these are too few.
double ScaleBetween(const Pose& earlier, const Pose& later) {
  Vector2d mean_earlier = Vector2d::Zero();
  Vector2d mean_later = Vector2d::Zero();
  int common = 0;
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    if (earlier.weights[k] <= 0.0 || later.weights[k] <= 0.0) continue;
    mean_earlier += earlier.points[k];
    mean_later += later.points[k];
    ++common;
  }
  if (common < kFewestForScale) return 1.0;
  mean_earlier /= common;
  mean_later /= common;
  double spread_earlier = 0.0;
  double spread_later = 0.0;
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    if (earlier.weights[k] <= 0.0 || later.weights[k] <= 0.0) continue;
    spread_earlier += (earlier.points[k] - mean_earlier).squaredNorm();
    spread_later += (later.points[k] - mean_later).squaredNorm();
  }
  return std::sqrt(std::max(1.0, spread_later) / std::max(1.0, spread_earlier));
}

/// Where a track is in a frame, as far as its last sightings predict it.
struct Prediction {
  int gap = 0;
  Vector2d shift = Vector2d::Zero();
};

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
    double log_scale_rate = 0.0;  ///< how fast the size has changed lately, per frame
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

  static Prediction Predict(const Track& track, int frame) {
    const int gap = frame - track.last_frame;
    const double coasting = kCoastingFrames * (1.0 - std::exp(-gap / kCoastingFrames));
    return {gap, track.velocity_px * coasting};
  }

  /// Mean distance between predicted and seen keypoints, in person sizes, and how many there are.
  static std::pair<double, int> Distance(const Track& track, const Prediction& prediction, const Pose& pose) {
    const double size = 0.5 * (track.last.size_px + pose.size_px);
    double sum = 0.0;
    double weight = 0.0;
    int common = 0;
    for (std::size_t k = 0; k < pose.points.size(); ++k) {
      const double w = std::min(pose.weights[k], track.last.weights[k]);
      if (w <= 0.0) continue;
      sum += w * std::min(2.0, (track.last.points[k] + prediction.shift - pose.points[k]).norm() / size);
      weight += w;
      ++common;
    }
    return {common > 0 ? sum / weight : 0.0, common};
  }

  static double Cost(const Track& track, int frame, const Pose& pose) {
    const Prediction prediction = Predict(track, frame);
    const int gap = prediction.gap;
    const bool has_same_id = track.last.id && pose.id && *track.last.id == *pose.id;
    if (gap > kLongestGap && !has_same_id) return kImpossible;
    const auto [distance, common] = Distance(track, prediction, pose);
    if (common == 0) return kImpossible;
    const double log_scale = std::abs(std::log(ScaleBetween(track.last, pose)));
    const double per_gap_frame = std::max(kLogScalePerGapFrame, kScaleGoesOn * track.log_scale_rate);
    if (log_scale > std::log(kLargestScale) + per_gap_frame * (gap - 1)) return kImpossible;
    const double missing_share = 1.0 - static_cast<double>(common) / std::max(pose.seen, track.last.seen);
    double cost = distance + 0.1 * missing_share + 0.1 * std::abs(std::log(pose.size_px / track.last.size_px));
    if (has_same_id) {
      return cost < kSameIdCostLimit + kSameIdCostLimitPerGapFrame * gap ? kSameIdFactor * cost : kImpossible;
    }
    const double limit = std::min(kLargestCostLimit, kCostLimit + kCostLimitPerGapFrame * (gap - 1));
    // Two ids are two people, unless a tracker lost one and found them again under a new number.
    if (track.last.id && pose.id) cost *= 2.0;
    return cost < limit ? cost : kImpossible;
  }

  void Start(int frame, int person, const Pose& pose) {
    Track track;
    track.last = pose;
    track.last_frame = frame;
    Record(track, {frame, person}, pose);
    tracks_.push_back(std::move(track));
  }

  static void Continue(Track& track, int frame, int person, const Pose& pose) {
    const bool has_other_id = track.last.id && pose.id && *track.last.id != *pose.id;
    const double log_scale = std::abs(std::log(ScaleBetween(track.last, pose))) / (frame - track.last_frame);
    const PersonTrack::Sighting sighting{frame, person, Distance(track, Predict(track, frame), pose).first,
                                         ScaleBetween(track.last, pose), has_other_id};
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
    track.log_scale_rate = std::max(0.7 * track.log_scale_rate, log_scale);
    Record(track, sighting, pose);
  }

  static void Record(Track& track, const PersonTrack::Sighting& sighting, const Pose& pose) {
    track.result.sightings.push_back(sighting);
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
/// Returns whether it warned.
bool LogLosses(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks, int number) {
  const auto chosen = static_cast<std::size_t>(number - 1);
  const auto number_of = [&](int frame) { return camera.frames[static_cast<std::size_t>(frame)].number; };
  for (const int frame : tracks[chosen].returns) {
    LogInfo("{}: the person who appears at frame {} is assumed to be the person followed, who has returned",
            camera.name, number_of(frame));
  }
  const std::vector<int> lost = FramesOfPossibleParts(camera, tracks, chosen);
  if (lost.empty()) return false;
  LogWarning(
      "{}: {} frames ({} to {}) are lost: the person followed is not seen there, but somebody similar is, who may be "
      "the same person; cut the clip, or use a detector that writes track ids",
      camera.name, lost.size(), number_of(lost.front()), number_of(lost.back()));
  return true;
}

/// Warns where somebody else may have taken the place of the person: within a few frames the keypoints are elsewhere or
/// the person is of another size, by far more than usual.
void LogJumps(const DetectedCamera& camera, const PersonTrack& track) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < track.sightings.size(); ++i) {
    const int gap = track.sightings[i].frame - track.sightings[i - 1].frame;
    if (gap == 1) steps.push_back(track.sightings[i].jump);
  }
  if (steps.empty()) return;
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  std::size_t jumps = 0;
  std::size_t first = 0;
  for (std::size_t i = 1; i < track.sightings.size(); ++i) {
    const PersonTrack::Sighting& sighting = track.sightings[i];
    const int gap = sighting.frame - track.sightings[i - 1].frame;
    const double limit = std::max(kSmallestJump, kJumpInSteps * *median * gap);
    const double evidence = sighting.jump + std::abs(std::log(sighting.scale)) * (gap > 1 ? 1.0 : 0.5);
    if (gap > kLongestJump || evidence <= (sighting.has_other_id ? 0.5 : 1.0) * limit) continue;
    if (jumps++ == 0) first = i;
  }
  if (jumps == 0) return;
  const PersonTrack::Sighting& sighting = track.sightings[first];
  LogWarning(
      "{}: at frame {}{} the person followed is suddenly {:.2g} of their size elsewhere and {:.2g} times as "
      "large{}; this may be somebody else from there on",
      camera.name, camera.frames[static_cast<std::size_t>(sighting.frame)].number,
      jumps > 1 ? fmt::format(" and at {} others", jumps - 1) : "", sighting.jump, sighting.scale,
      sighting.has_other_id ? ", under another track id" : "");
}

/// Reports where the person is away and somebody else, who is not there at other times, is seen instead.
void LogReplacements(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks, std::size_t chosen) {
  std::vector<bool> is_present(camera.frames.size(), false);
  const PersonTrack& track = tracks[chosen];
  for (const PersonTrack::Sighting& sighting : track.sightings)
    is_present[static_cast<std::size_t>(sighting.frame)] = true;
  int first = -1;
  int last = -1;
  std::size_t people = 0;
  const double per_frame = track.prominence / static_cast<double>(track.sightings.size());
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const std::vector<PersonTrack::Sighting>& other = tracks[i].sightings;
    const auto together = std::count_if(other.begin(), other.end(), [&](const PersonTrack::Sighting& sighting) {
      return is_present[static_cast<std::size_t>(sighting.frame)];
    });
    if (i == chosen || std::ssize(other) < kShortestAbsence || 5 * together > std::ssize(other)) continue;
    if (tracks[i].prominence < kReplacementShare * per_frame * static_cast<double>(other.size())) continue;
    first = first < 0 ? other.front().frame : std::min(first, other.front().frame);
    last = std::max(last, other.back().frame);
    ++people;
  }
  if (people == 0) return;
  const auto number_of = [&](int frame) { return camera.frames[static_cast<std::size_t>(frame)].number; };
  LogInfo("{}: the person followed is away while {} seen (frames {} to {}), whose keypoints are not read", camera.name,
          people == 1 ? "somebody else is" : fmt::format("{} others are", people), number_of(first), number_of(last));
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
  const bool has_lost = LogLosses(camera, tracks, number);
  if (!has_lost) LogReplacements(camera, tracks, static_cast<std::size_t>(number - 1));
  LogJumps(camera, tracks[static_cast<std::size_t>(number - 1)]);
  const PersonTrack& track = tracks[static_cast<std::size_t>(number - 1)];
  const auto count = static_cast<std::size_t>(camera.keypoint_count);
  KeypointClip clip;
  clip.name = camera.name;
  clip.path = camera.path;
  clip.keypoint_count = camera.keypoint_count;
  clip.layout = camera.layout;
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
