// Checks of a detector's keypoints as they are imported: what cannot be right is refused, what is hardly right warned
// of.
#pragma once

#include <array>
#include <vector>

#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// Throws Error(kBadInput) where the coordinates are fractions of the image rather than pixels.
void RefuseFractions(const KeypointClip& clip);

/// Warns where the keypoints say that the images were of another size: width and height in pixels.
void CheckImageSize(const KeypointClip& clip, const std::array<int, 2>& size);

/// Throws Error(kBadInput) where one confidence is far above all others: confidences are divided by the largest, so
/// that one absurd value would make the others nearly zero.
void RefuseAbsurdConfidences(const DetectedCamera& camera);

/// Throws Error(kBadInput) where two clips, which are aligned, are the same: a camera given twice would look like two
/// views that agree in everything.
void RefuseIdenticalClips(const std::vector<KeypointClip>& clips);

}  // namespace canonpose
