// Everybody whom a camera sees, as keypoint clips: for the steps of an import that take one clip per camera.
#pragma once

#include <vector>

#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The people of a camera (TrackPeople()), the most prominent first, one after the other: a clip of T frames for each,
/// with the frame numbers of the camera again and again. So a check of the layout sees all of them as one. Tracks of
/// less than three frames are left out, unless there is no other. Logs how many there are. Throws Error(kBadInput)
/// where nobody is seen.
KeypointClip FollowEverybody(const DetectedCamera& camera);

/// The same people side by side: T frames, in which the keypoints of one person follow those of the other. So all are
/// aligned with other cameras as one.
KeypointClip PeopleSideBySide(const KeypointClip& one_after_the_other);

/// Each of the people who stand side by side, with `keypoint_count` keypoints, alone.
std::vector<KeypointClip> SplitPeople(const KeypointClip& side_by_side, int keypoint_count);

}  // namespace canonpose
