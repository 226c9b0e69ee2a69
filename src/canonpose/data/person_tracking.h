// Follows people through one camera's clip, so that one person can be taken from it rather than the first detection of
// each frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// A track whose prominence is less than this fraction of the first track's is a false detection, not a person.
inline constexpr double kPersonShare = 0.02;

/// One person's detections throughout a clip.
struct PersonTrack {
  struct Sighting {
    int frame;                  ///< index into DetectedCamera::frames
    int person;                 ///< index into DetectedFrame::people
    double jump = 0.0;          ///< from where the sightings before predict the keypoints, in person sizes
    double scale = 1.0;         ///< size relative to the sighting before, by the keypoints that both have
    bool has_other_id = false;  ///< than the sighting before
  };
  std::vector<Sighting> sightings;  ///< ascending frames
  std::vector<int> returns;         ///< frames at which a track continues after a long absence; see JoinTracks()
  /// Sum over frames of the box's diagonal in pixels times the mean confidence of all keypoints.
  double prominence = 0.0;
};

/// The people of a clip, the most prominent first. Frame by frame, each person is assigned to the track that predicts
/// it best: by the distance between its keypoints and the track's last ones moved on with the track's velocity,
/// weighted by confidence and relative to the person's size. Nobody becomes 1.4 times as large from one frame to the
/// next. Track ids in the file link detections unless they contradict these distances. A track survives a gap of 60
/// frames; after a longer one it continues only where nobody else can be meant (JoinTracks()).
std::vector<PersonTrack> TrackPeople(const DetectedCamera& camera);

/// The keypoints of one person of a camera over T frames.
struct KeypointClip {
  std::string name;  ///< the camera's
  std::string path;  ///< the file or folder, for messages
  int keypoint_count = 0;
  std::vector<std::int64_t> frame_numbers;  ///< (T)
  /// Where frames are named by the time, their numbers are multiples of this; 0 where they count frames.
  double seconds_per_number = 0.0;
  std::optional<DetectedLayout> layout;  ///< as the camera's files say; empty where they do not
  std::vector<float> keypoints;          ///< (T, K, 2) pixels; NaN where missing
  std::vector<float> confidence;         ///< (T, K) as in the file; 0 where missing

  [[nodiscard]] int frame_count() const { return static_cast<int>(frame_numbers.size()); }
};

/// Follows the N-th most prominent person (1 is the most prominent) and logs it. Warns where the choice was close,
/// where frames are lost because the person may continue as another track, and where somebody else may have taken the
/// person's place. Reports where the person is away and somebody else is there. Throws Error(kBadInput) where fewer
/// people are seen.
KeypointClip FollowPerson(const DetectedCamera& camera, int number);

}  // namespace canonpose
