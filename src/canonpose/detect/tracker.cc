#include "canonpose/detect/tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/base/error.h"
#include "canonpose/detect/appearance.h"

namespace canonpose {
namespace {

// Distances between poses are means over joints, in sizes of a person (SizeOf()), so about in trunk lengths.

/// Fewer joints that are seen are a chair or a coat.
constexpr int kFewestJoints = 6;
/// Somebody new must be surer than somebody followed: the score of the search in the whole image.
constexpr float kLeastScoreOfNew = 0.2F;
/// Farther than that from where the frames before lead, a pose is somebody else's.
constexpr float kLargestJump = 0.8F;
/// Poses nearer than that are one person.
constexpr float kSamePerson = 0.3F;
/// The search in the whole image is less precise.
constexpr float kFoundAgain = 0.4F;
/// A pose is one person's rather than another's if its distance is so many times smaller.
constexpr float kClearlyNearer = 0.6F;
/// Of people near each other, a pose that is farther than that from what the search found is a mixture of two.
constexpr float kUnmixed = 0.25F;
/// People nearer than that may be taken for each other; then the whole image is searched so often, or, where they are
/// nearer still, in every frame.
constexpr float kNear = 1.0F;
constexpr float kVeryNear = 0.6F;
constexpr long kSearchIntervalOfNear = 3;
/// How much of a distance a difference in colour is worth.
constexpr float kColourWeight = 5.0F;
constexpr float kUnknownColour = 0.12F;
/// Colours of one person change with light and pose by less than that.
constexpr float kSameColour = 0.14F;
constexpr float kSameColourNearby = 0.25F;
/// A person who was lost may be one size farther away, and after each further frame by so much of that more.
constexpr float kWander = 0.1F;
/// Sizes differ by less than this factor, in natural logarithms.
constexpr float kSameSize = 0.5F;
/// After so many frames, position and size say nothing any more.
constexpr long kLongGap = 90;
/// Velocities of people who were lost are believed for so many frames.
constexpr long kLongestCoast = 10;
constexpr float kVelocityShare = 0.3F;
constexpr float kAppearanceShare = 0.1F;
/// People as far apart as this do not hide each other's colours.
constexpr float kFreeView = 1.5F;
/// A track with so low a score that so many searches do not find is nobody.
constexpr float kSureScore = 0.4F;
constexpr int kMostDoubts = 3;
/// Somebody who was seen less often is forgotten when lost.
constexpr int kFewestSightings = 3;

/// In sizes of the smaller person, so that somebody far away is not taken for somebody near.
float DistanceBetween(const DetectedPose& a, const DetectedPose& b) {
  return std::max(PoseDistance(a, b), PoseDistance(b, a));
}

/// Whether the pose of a crop is that of one of the people found, and not another's, or a mixture of two.
bool IsOf(const DetectedPose& pose, const std::vector<DetectedPose>& found, std::size_t person) {
  const float distance = DistanceBetween(pose, found[person]);
  return distance < kFoundAgain && std::ranges::none_of(found, [&](const DetectedPose& other) {
           if (&other == &found[person]) return false;
           const bool is_near = PoseDistance(found[person], other) < kNear;
           return distance > kClearlyNearer * DistanceBetween(pose, other) || (is_near && distance > kUnmixed);
         });
}

}  // namespace

void TrackerOptions::Validate() const {
  if (search_interval < 1) ThrowInvalidArgument("`search_interval` must be at least 1, not {}", search_interval);
  if (most_people < 1) ThrowInvalidArgument("`most_people` must be at least 1, not {}", most_people);
}

PersonTracker::PersonTracker(PoseNetwork& network, int image_width, int image_height, TrackerOptions options)
    : network_(network), width_(image_width), height_(image_height), options_(options) {
  options_.Validate();
}

DetectedPose PersonTracker::Predict(const Track& track) const {
  const auto frames = static_cast<float>(std::min(frame_ - track.last_frame, kLongestCoast));
  DetectedPose pose = track.pose;
  for (PosePoint& point : pose.joints) point.position += frames * track.velocity;
  return pose;
}

std::optional<DetectedPose> PersonTracker::LookAt(const cv::Mat& image, const DetectedPose& where) const {
  DetectedPose pose = network_.PoseInCrop(image, CropAround(where, width_, height_));
  if (SeenCount(pose) < kFewestJoints) return std::nullopt;
  return pose;
}

void PersonTracker::Follow(const cv::Mat& image) {
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (IsLost(tracks_[t])) continue;
    const DetectedPose predicted = Predict(tracks_[t]);
    const std::optional<DetectedPose> pose = LookAt(image, predicted);
    if (!pose) continue;
    const float jump = PoseDistance(predicted, *pose);
    if (jump > kLargestJump) continue;
    const Appearance appearance = network_.AppearanceOf(image, *pose);
    const float colour = AppearanceDistance(tracks_[t].appearance, appearance, kUnknownColour);
    candidates_.push_back({t, *pose, appearance, jump + kColourWeight * colour});
  }
}

void PersonTracker::DropDuplicates() {
  for (std::size_t a = 0; a < candidates_.size(); ++a) {
    for (std::size_t b = a + 1; b < candidates_.size();) {
      if (DistanceBetween(candidates_[a].pose, candidates_[b].pose) > kSamePerson) {
        ++b;
        continue;
      }
      // Somebody seen only now and then is no match for a track of many frames.
      const auto is_brief = [&](const Candidate& c) { return tracks_[c.track].sightings < kFewestSightings; };
      const bool keep_first = is_brief(candidates_[a]) != is_brief(candidates_[b])
                                  ? is_brief(candidates_[b])
                                  : candidates_[a].cost <= candidates_[b].cost;
      if (!keep_first) std::swap(candidates_[a], candidates_[b]);
      candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(b));
      b = a + 1;  // another may be the same as the one that was kept
    }
  }
}

bool PersonTracker::IsSearchDue() const {
  if (last_search_ < 0 || frame_ - last_search_ >= options_.search_interval) return true;
  const float nearest = NearestDistance();
  if (nearest < kVeryNear || (nearest < kNear && frame_ - last_search_ >= kSearchIntervalOfNear)) return true;
  const bool lost_now = std::ranges::any_of(tracks_, [&](const Track& track) {
    return track.last_frame + 1 == frame_ &&
           std::ranges::none_of(candidates_, [&](const Candidate& c) { return tracks_[c.track].id == track.id; });
  });
  return lost_now || frame_ == next_try_;
}

float PersonTracker::NearestDistance() const {
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t a = 0; a < candidates_.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      nearest = std::min({nearest, PoseDistance(candidates_[a].pose, candidates_[b].pose),
                          PoseDistance(candidates_[b].pose, candidates_[a].pose)});
    }
  }
  return nearest;
}

bool PersonTracker::IsTaken(const DetectedPose& pose) const {
  return std::ranges::any_of(
      candidates_, [&](const Candidate& candidate) { return DistanceBetween(candidate.pose, pose) < kFoundAgain; });
}

std::optional<std::size_t> PersonTracker::FindLost(const DetectedPose& pose, const Appearance& appearance) const {
  std::optional<std::size_t> best;
  float best_cost = std::numeric_limits<float>::infinity();
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Track& track = tracks_[t];
    if (std::ranges::any_of(candidates_, [&](const Candidate& c) { return c.track == t; })) continue;
    const long gap = frame_ - track.last_frame;
    const float size = SizeOf(track.pose);
    const float reach = 1.0F + kWander * static_cast<float>(gap);
    const float distance = (CentreOf(pose) - CentreOf(Predict(track))).norm() / size / reach;
    const float growth = std::abs(std::log(SizeOf(pose) / size));
    const float colour = AppearanceDistance(track.appearance, appearance, kUnknownColour);
    const bool is_long = gap > kLongGap;
    if (colour > (!is_long && distance < 0.5F ? kSameColourNearby : kSameColour)) continue;
    if (!is_long && (distance > 1.0F || growth > kSameSize * reach)) continue;
    const float cost = (is_long ? 1.0F : distance + growth) + kColourWeight * colour;
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = t;
  }
  return best;
}

void PersonTracker::DoubtWhoWasNotFound(const std::vector<DetectedPose>& found) {
  std::erase_if(candidates_, [&](const Candidate& candidate) {
    const bool is_found = std::ranges::any_of(
        found, [&](const DetectedPose& pose) { return DistanceBetween(candidate.pose, pose) < kFoundAgain; });
    Track& track = tracks_[candidate.track];
    track.doubts = is_found ? 0 : track.doubts + 1;
    return track.doubts >= kMostDoubts && candidate.pose.score < kSureScore;
  });
}

DetectedPose PersonTracker::Refine(const cv::Mat& image, const std::vector<DetectedPose>& found,
                                   std::size_t person) const {
  const std::optional<DetectedPose> pose = LookAt(image, found[person]);
  return pose && IsOf(*pose, found, person) ? *pose : found[person];
}

void PersonTracker::CorrectCandidates(const cv::Mat& image, const std::vector<DetectedPose>& found) {
  std::vector<Appearance> appearances;
  for (const DetectedPose& person : found) appearances.push_back(network_.AppearanceOf(image, person));
  struct Pair {
    float cost;
    std::size_t track, person;
  };
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (IsLost(tracks_[t])) continue;
    const DetectedPose predicted = Predict(tracks_[t]);
    for (std::size_t f = 0; f < found.size(); ++f) {
      const float distance = DistanceBetween(predicted, found[f]);
      if (distance > kLargestJump) continue;
      const float colour = AppearanceDistance(tracks_[t].appearance, appearances[f], kUnknownColour);
      pairs.push_back({distance + kColourWeight * colour, t, f});
    }
  }
  std::ranges::stable_sort(pairs, {}, &Pair::cost);
  std::vector<bool> has_person(tracks_.size(), false);
  std::vector<bool> is_given(found.size(), false);
  for (const Pair& pair : pairs) {
    if (has_person[pair.track] || is_given[pair.person]) continue;
    has_person[pair.track] = is_given[pair.person] = true;
    const auto candidate = std::ranges::find_if(candidates_, [&](const Candidate& c) { return c.track == pair.track; });
    if (candidate != candidates_.end() && IsOf(candidate->pose, found, pair.person)) continue;
    const DetectedPose pose = Refine(image, found, pair.person);
    const Candidate corrected{pair.track, pose, network_.AppearanceOf(image, pose), pair.cost};
    if (candidate == candidates_.end()) {
      candidates_.push_back(corrected);
    } else {
      *candidate = corrected;
    }
  }
}

void PersonTracker::Search(const cv::Mat& image) {
  last_search_ = frame_;
  std::vector<DetectedPose> found = network_.FindPeople(image);
  DoubtWhoWasNotFound(found);
  std::erase_if(found, [](const DetectedPose& person) {
    return person.score < kLeastScoreOfNew || SeenCount(person) < kFewestJoints;
  });
  CorrectCandidates(image, found);
  DropDuplicates();
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (std::ssize(candidates_) >= options_.most_people) break;
    if (IsTaken(found[f])) continue;
    const DetectedPose pose = Refine(image, found, f);
    if (IsTaken(pose)) continue;
    const Appearance appearance = network_.AppearanceOf(image, pose);
    std::optional<std::size_t> track = FindLost(pose, appearance);
    if (!track) {
      Track fresh;
      fresh.id = next_id_++;
      fresh.appearance = appearance;
      track = tracks_.size();
      tracks_.push_back(fresh);
    }
    candidates_.push_back({*track, pose, appearance, 0.0F});
  }
}

void PersonTracker::Update(const Candidate& candidate) {
  Track& track = tracks_[candidate.track];
  if (track.sightings > 0) {
    const Eigen::Vector2f moved = CentreOf(candidate.pose) - CentreOf(track.pose);
    const bool was_lost = IsLost(track);
    const Eigen::Vector2f velocity = moved / static_cast<float>(frame_ - track.last_frame);
    track.velocity =
        was_lost ? velocity : Eigen::Vector2f((1.0F - kVelocityShare) * track.velocity + kVelocityShare * velocity);
    if (was_lost && frame_ - track.last_frame > kLongestCoast) track.velocity.setZero();
  }
  const bool is_free = std::ranges::none_of(candidates_, [&](const Candidate& other) {
    return other.track != candidate.track &&
           (CentreOf(other.pose) - CentreOf(candidate.pose)).norm() < kFreeView * SizeOf(candidate.pose);
  });
  if (is_free) UpdateAppearance(track.appearance, candidate.appearance, kAppearanceShare);
  track.pose = candidate.pose;
  track.last_frame = frame_;
  ++track.sightings;
}

std::vector<TrackedPose> PersonTracker::Next(const cv::Mat& image) {
  ++frame_;
  candidates_.clear();
  Follow(image);
  DropDuplicates();
  if (IsSearchDue()) {
    Search(image);
  }
  std::ranges::sort(candidates_, {}, [&](const Candidate& c) { return tracks_[c.track].id; });
  std::vector<TrackedPose> people;
  for (const Candidate& candidate : candidates_) {
    Update(candidate);
    people.push_back({tracks_[candidate.track].id, candidate.pose});
  }
  std::erase_if(tracks_,
                [&](const Track& track) { return track.last_frame < frame_ && track.sightings < kFewestSightings; });
  const bool any_lost_lately = std::ranges::any_of(
      tracks_, [&](const Track& track) { return track.last_frame < frame_ && frame_ - track.last_frame <= kLongGap; });
  if (last_search_ == frame_) try_gap_ = any_lost_lately ? std::min<long>(2 * try_gap_, options_.search_interval) : 1;
  if (any_lost_lately && next_try_ <= frame_) next_try_ = frame_ + try_gap_;
  return people;
}

}  // namespace canonpose
