// What people look like, to tell them apart after one was hidden.
#pragma once

#include "canonpose/detect/pose_network.h"

namespace canonpose {

/// Colours of an 8-bit image (blue, green, red) on a person's trunk and thighs.
Appearance MeasureAppearance(const cv::Mat& image, const DetectedPose& pose);

/// Mean difference of the colours that both have, 0..1; `unknown` where they have none in common.
float AppearanceDistance(const Appearance& a, const Appearance& b, float unknown);

/// Moves `mean` towards `seen` by `share`; colours that one of them lacks are taken from the other.
void UpdateAppearance(Appearance& mean, const Appearance& seen, float share);

}  // namespace canonpose
