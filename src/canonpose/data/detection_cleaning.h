// What must be put right in one camera's detections before a person can be followed.
#pragma once

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// Drops track ids that identify nobody: where two people of one frame have the same, and, unless the format keeps
/// individuals apart, where everybody has the same, or they only number the people of each frame in order. Reports it
/// where several people are concerned.
void DropUselessTrackIds(DetectedCamera& camera);

/// Where a detector found one person twice in a frame, so that the keypoints of two detections lie on each other, keeps
/// the one with the higher mean confidence. Reports in how many frames. Two people who pass each other are kept apart:
/// where as many people are seen shortly before and after as in a frame, none of them is one person found twice.
void MergeDuplicates(DetectedCamera& camera);

}  // namespace canonpose
