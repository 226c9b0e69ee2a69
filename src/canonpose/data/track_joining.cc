#include "canonpose/data/track_joining.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Core>

namespace canonpose {
namespace {

using Eigen::Vector2d;

/// In a crowd, more tracks would be of no use.
constexpr std::size_t kMaxTracks = 64;
/// Parts of one person's track differ by less than this factor in prominence per frame and in size.
constexpr double kSameFactor = 2.5;
/// Another track counts as a person above these fractions of the lesser part's prominence, per frame and in total.
constexpr double kRivalShareOfFrame = 0.4;
constexpr double kRivalShareOfAll = 0.1;
/// From one frame to the next a person's size changes by less than the first factor, and by the second one for each
/// frame more.
constexpr double kLargestReturnScale = 1.4;
constexpr double kLogScalePerFrame = 0.03;
/// How far a person can get, in person sizes: immediately, and per frame; or in multiples of the usual way per frame.
constexpr double kReach = 0.5;
constexpr double kReachPerFrame = 0.1;
constexpr double kReachInSteps = 3.0;
/// With other people present: the same place and size, and every alternative is farther away by at least this factor.
constexpr double kSamePlace = 0.75;
constexpr double kSameSizeFactor = 1.3;
constexpr double kRunnerUpDistance = 2.0;
/// The ends of a track are means over this many sightings.
constexpr std::size_t kEndSightings = 5;

struct End {
  Vector2d place_px = Vector2d::Zero();
  double size_px = 0.0;
};

/// What joining needs to know of a track.
struct Part {
  int first = 0;
  int last = 0;
  double prominence = 0.0;
  double prominence_per_frame = 0.0;
  double step = 0.0;  ///< mean way from one sighting to the next frame's, in person sizes
  End begin;
  End end;
};

End MeanBox(const DetectedCamera& camera, const PersonTrack& track, std::size_t from, std::size_t count) {
  End mean;
  for (std::size_t i = from; i < from + count; ++i) {
    const PersonTrack::Sighting& sighting = track.sightings[i];
    const DetectedPerson& person =
        camera.frames[static_cast<std::size_t>(sighting.frame)].people[static_cast<std::size_t>(sighting.person)];
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high = -low;
    for (std::size_t k = 0; k < person.confidence.size(); ++k) {
      if (person.confidence[k] <= 0.0F) continue;
      const Vector2d point(person.keypoints[2 * k], person.keypoints[2 * k + 1]);
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    mean.place_px += 0.5 * (low + high) / static_cast<double>(count);
    mean.size_px += std::max(1.0, (high - low).norm()) / static_cast<double>(count);
  }
  return mean;
}

double MeanStep(const DetectedCamera& camera, const PersonTrack& track) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 1; i < track.sightings.size(); ++i) {
    if (track.sightings[i].frame != track.sightings[i - 1].frame + 1) continue;
    const End earlier = MeanBox(camera, track, i - 1, 1);
    const End later = MeanBox(camera, track, i, 1);
    sum += (later.place_px - earlier.place_px).norm() / std::max(earlier.size_px, later.size_px);
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

Part MakePart(const DetectedCamera& camera, const PersonTrack& track) {
  const std::size_t seen = track.sightings.size();
  const std::size_t count = std::min(kEndSightings, seen);
  Part part;
  part.first = track.sightings.front().frame;
  part.last = track.sightings.back().frame;
  part.prominence = track.prominence;
  part.prominence_per_frame = track.prominence / static_cast<double>(seen);
  part.step = MeanStep(camera, track);
  part.begin = MeanBox(camera, track, 0, count);
  part.end = MeanBox(camera, track, seen - count, count);
  return part;
}

bool LiveTogether(const Part& a, const Part& b) { return a.first <= b.last && b.first <= a.last; }

double Factor(double a, double b) { return std::max(a, b) / std::min(a, b); }

bool AreComparable(const Part& a, const Part& b) {
  return Factor(a.prominence_per_frame, b.prominence_per_frame) < kSameFactor;
}

/// Distance from the end of one to the beginning of the other, in person sizes.
double Distance(const Part& earlier, const Part& later) {
  return (earlier.end.place_px - later.begin.place_px).norm() / std::max(earlier.end.size_px, later.begin.size_px);
}

/// Whether `later` could be the same person as `earlier`, who has returned.
bool IsPossible(const Part& earlier, const Part& later) {
  const int gap = later.first - earlier.last;
  const double largest_factor = std::min(kSameFactor, kLargestReturnScale * std::exp(kLogScalePerFrame * gap));
  const double reach_per_frame = std::max(kReachPerFrame, kReachInSteps * std::max(earlier.step, later.step));
  return gap > 0 && AreComparable(earlier, later) &&
         Factor(earlier.end.size_px, later.begin.size_px) < largest_factor &&
         Distance(earlier, later) < kReach + reach_per_frame * gap;
}

bool HasRival(const std::vector<Part>& parts, std::size_t a, std::size_t b) {
  const double of_frame = std::min(parts[a].prominence_per_frame, parts[b].prominence_per_frame);
  const double of_all = std::min(parts[a].prominence, parts[b].prominence);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == a || i == b || (!LiveTogether(parts[i], parts[a]) && !LiveTogether(parts[i], parts[b]))) continue;
    if (parts[i].prominence_per_frame > kRivalShareOfFrame * of_frame &&
        parts[i].prominence > kRivalShareOfAll * of_all) {
      return true;
    }
  }
  return false;
}

/// Whether the person returned to the same place, and neither part has another continuation that is nearly as close.
bool IsOnlyPlausible(const std::vector<Part>& parts, std::size_t earlier, std::size_t later) {
  const double distance = Distance(parts[earlier], parts[later]);
  if (distance > kSamePlace || Factor(parts[earlier].end.size_px, parts[later].begin.size_px) > kSameSizeFactor) {
    return false;
  }
  const double limit = distance + kRunnerUpDistance;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i == earlier || i == later) continue;
    if (IsPossible(parts[earlier], parts[i]) && Distance(parts[earlier], parts[i]) < limit) return false;
    if (IsPossible(parts[i], parts[later]) && Distance(parts[i], parts[later]) < limit) return false;
  }
  return true;
}

std::size_t CountPeople(const std::vector<PersonTrack>& tracks) {
  std::size_t count = 0;
  while (count < std::min(kMaxTracks, tracks.size()) &&
         tracks[count].prominence >= kPersonShare * tracks.front().prominence) {
    ++count;
  }
  return count;
}

/// The two parts to join next, which are those with the shortest absence between them.
std::optional<std::pair<std::size_t, std::size_t>> NextPair(const std::vector<Part>& parts) {
  std::optional<std::pair<std::size_t, std::size_t>> best;
  int shortest = std::numeric_limits<int>::max();
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = 0; b < parts.size(); ++b) {
      const int gap = parts[b].first - parts[a].last;
      if (a == b || gap >= shortest || !IsPossible(parts[a], parts[b])) continue;
      if (HasRival(parts, a, b) && !IsOnlyPlausible(parts, a, b)) continue;
      best = {a, b};
      shortest = gap;
    }
  }
  return best;
}

}  // namespace

std::vector<PersonTrack> JoinTracks(const DetectedCamera& camera, std::vector<PersonTrack> tracks) {
  const std::size_t people = CountPeople(tracks);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < people; ++i) parts.push_back(MakePart(camera, tracks[i]));
  while (const auto pair = NextPair(parts)) {
    const auto [earlier, later] = *pair;
    PersonTrack& track = tracks[earlier];
    const PersonTrack& rest = tracks[later];
    track.returns.push_back(rest.sightings.front().frame);
    track.returns.insert(track.returns.end(), rest.returns.begin(), rest.returns.end());
    track.sightings.insert(track.sightings.end(), rest.sightings.begin(), rest.sightings.end());
    track.prominence += rest.prominence;
    parts[earlier] = MakePart(camera, track);
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(later));
    tracks.erase(tracks.begin() + static_cast<std::ptrdiff_t>(later));
  }
  std::stable_sort(tracks.begin(), tracks.end(),
                   [](const PersonTrack& a, const PersonTrack& b) { return a.prominence > b.prominence; });
  return tracks;
}

std::vector<int> FramesOfPossibleParts(const DetectedCamera& camera, const std::vector<PersonTrack>& tracks,
                                       std::size_t chosen) {
  const Part part = MakePart(camera, tracks[chosen]);
  std::set<int> frames;
  for (std::size_t i = 0; i < CountPeople(tracks); ++i) {
    const Part other = MakePart(camera, tracks[i]);
    if (i == chosen || LiveTogether(part, other) || !AreComparable(part, other)) continue;
    for (const PersonTrack::Sighting& sighting : tracks[i].sightings) frames.insert(sighting.frame);
  }
  return {frames.begin(), frames.end()};
}

}  // namespace canonpose
