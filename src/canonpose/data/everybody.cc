#include "canonpose/data/everybody.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {
namespace {

/// Fewer frames show nobody who could be told from a false detection.
constexpr int kShortestTrack = 3;
constexpr float kMissingKeypoint = std::numeric_limits<float>::quiet_NaN();

/// Copies T rows of `width` values: row t from place t * from_stride to place t * to_stride.
struct RowCopy {
  std::size_t rows;
  std::size_t width;
  std::size_t from_stride;
  std::size_t to_stride;

  void Run(const float* from, float* to) const {
    for (std::size_t t = 0; t < rows; ++t) std::copy_n(from + t * from_stride, width, to + t * to_stride);
  }
};

/// The clip without keypoints, of other dimensions.
KeypointClip EmptyClip(const KeypointClip& like, std::vector<std::int64_t> frame_numbers, int keypoint_count) {
  KeypointClip clip;
  clip.name = like.name;
  clip.path = like.path;
  clip.layout = like.layout;
  clip.seconds_per_number = like.seconds_per_number;
  clip.keypoint_count = keypoint_count;
  clip.frame_numbers = std::move(frame_numbers);
  const std::size_t values = clip.frame_numbers.size() * static_cast<std::size_t>(keypoint_count);
  clip.keypoints.assign(2 * values, kMissingKeypoint);
  clip.confidence.assign(values, 0.0F);
  return clip;
}

/// Frame numbers ascend within a person, and begin again with the next one.
std::size_t FramesOfOne(const KeypointClip& one_after_the_other) {
  const std::vector<std::int64_t>& numbers = one_after_the_other.frame_numbers;
  std::size_t frames = 1;
  while (frames < numbers.size() && numbers[frames] > numbers[frames - 1]) ++frames;
  CANONPOSE_CHECK(numbers.size() % frames == 0, "{} frames of people with {}", numbers.size(), frames);
  return frames;
}

}  // namespace

KeypointClip FollowEverybody(const DetectedCamera& camera) {
  std::vector<PersonTrack> tracks = TrackPeople(camera);
  if (tracks.empty()) {
    ThrowBadInput({camera.path, "", fmt::format("somebody in camera {}", camera.name), "nobody in any frame",
                   "leave the camera out, or run the detector again"});
  }
  const auto is_short = [](const PersonTrack& track) { return std::ssize(track.sightings) < kShortestTrack; };
  const auto left_out = std::min(std::ranges::count_if(tracks, is_short), std::ssize(tracks) - 1);
  if (left_out > 0) {
    const PersonTrack first = tracks.front();
    std::erase_if(tracks, is_short);
    if (tracks.empty()) tracks.push_back(first);
    LogInfo("{}: {} tracks of people; {} of one or two frames are left out", camera.name, tracks.size(), left_out);
  } else {
    LogInfo("{}: {} tracks of people", camera.name, tracks.size());
  }
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (const DetectedFrame& frame : camera.frames) numbers.push_back(frame.number);
  }
  KeypointClip like;
  like.name = camera.name;
  like.path = camera.path;
  like.layout = camera.layout;
  like.seconds_per_number = camera.seconds_per_number;
  KeypointClip clip = EmptyClip(like, std::move(numbers), camera.keypoint_count);
  const auto count = static_cast<std::ptrdiff_t>(camera.keypoint_count);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    for (const PersonTrack::Sighting& sighting : tracks[i].sightings) {
      const auto t = static_cast<std::size_t>(sighting.frame);
      const DetectedPerson& person = camera.frames[t].people[static_cast<std::size_t>(sighting.person)];
      const auto row = static_cast<std::ptrdiff_t>(i * camera.frames.size() + t);
      std::ranges::copy(person.keypoints, clip.keypoints.begin() + 2 * row * count);
      std::ranges::copy(person.confidence, clip.confidence.begin() + row * count);
    }
  }
  return clip;
}

KeypointClip PeopleSideBySide(const KeypointClip& one_after_the_other) {
  const std::size_t frames = FramesOfOne(one_after_the_other);
  const std::size_t people = one_after_the_other.frame_numbers.size() / frames;
  const auto count = static_cast<std::size_t>(one_after_the_other.keypoint_count);
  const auto end = one_after_the_other.frame_numbers.begin() + static_cast<std::ptrdiff_t>(frames);
  KeypointClip clip = EmptyClip(one_after_the_other, {one_after_the_other.frame_numbers.begin(), end},
                                static_cast<int>(people * count));
  for (std::size_t p = 0; p < people; ++p) {
    const RowCopy copy{frames, count, count, people * count};
    copy.Run(&one_after_the_other.confidence[p * frames * count], &clip.confidence[p * count]);
    const RowCopy copy_pairs{frames, 2 * count, 2 * count, 2 * people * count};
    copy_pairs.Run(&one_after_the_other.keypoints[2 * p * frames * count], &clip.keypoints[2 * p * count]);
  }
  return clip;
}

std::vector<KeypointClip> SplitPeople(const KeypointClip& side_by_side, int keypoint_count) {
  const auto count = static_cast<std::size_t>(keypoint_count);
  const auto width = static_cast<std::size_t>(side_by_side.keypoint_count);
  CANONPOSE_CHECK(width % count == 0, "{} keypoints of people with {}", width, count);
  const std::size_t frames = side_by_side.frame_numbers.size();
  std::vector<KeypointClip> people;
  for (std::size_t p = 0; p < width / count; ++p) {
    KeypointClip& clip = people.emplace_back(EmptyClip(side_by_side, side_by_side.frame_numbers, keypoint_count));
    RowCopy{frames, count, width, count}.Run(&side_by_side.confidence[p * count], clip.confidence.data());
    RowCopy{frames, 2 * count, 2 * width, 2 * count}.Run(&side_by_side.keypoints[2 * p * count], clip.keypoints.data());
  }
  return people;
}

}  // namespace canonpose
