// Follows people through one camera's clip, so that one person is taken from it and not the first entry of each frame.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// A track that is less prominent than this share of the first is a false alarm rather than a person.
inline constexpr double kPersonShare = 0.02;

/// One person's way through a clip.
struct PersonTrack {
  struct Sighting {
    int frame;   ///< index into DetectedCamera::frames
    int person;  ///< index into DetectedFrame::people
  };
  std::vector<Sighting> sightings;  ///< ascending frames
  std::vector<int> returns;         ///< frames at which a track that was lost for long goes on, JoinTracks()
  double prominence =
      0.0;  ///< sum over frames of the box's diagonal in pixels times the mean confidence of all keypoints
};

/// The people of a clip, the most prominent first. Frame by frame, people are given to the tracks that predict them
/// best: by the distance of their keypoints, weighted by confidence, from the track's last ones moved on with its
/// velocity, relative to the person's size. Track ids of the file bind detections where they do not contradict that. A
/// track outlives a gap of 60 frames; after a longer one it goes on where nobody else can be meant (JoinTracks()).
std::vector<PersonTrack> TrackPeople(const DetectedCamera& camera);

/// The keypoints of one person of a camera over T frames.
struct KeypointClip {
  std::string name;  ///< the camera's
  std::string path;  ///< where it was read from, for messages
  int keypoint_count = 0;
  std::vector<std::int64_t> frame_numbers;  ///< (T)
  std::vector<float> keypoints;             ///< (T, K, 2) pixels; NaN where missing
  std::vector<float> confidence;            ///< (T, K) as the file has it; 0 where missing

  [[nodiscard]] int frame_count() const { return static_cast<int>(frame_numbers.size()); }
};

/// Follows the N-th most prominent person (1 is the most prominent) and says so in the log; warns where the choice was
/// a close call, and where frames are lost because the person may go on as somebody else. Throws Error(kBadInput) where
/// fewer people are seen.
KeypointClip FollowPerson(const DetectedCamera& camera, int number);

}  // namespace canonpose
