// Figures for papers: skeletons of chosen frames side by side, as vector graphics.
#pragma once

#include <string>
#include <vector>

#include "canonpose/view/page_content.h"

namespace canonpose {

struct StripOptions {
  std::vector<int> frames;  ///< counted from 0
  /// Where one looks from: 0 is from in front of the first person in the first frame, 90 from the person's left.
  double view_angle_deg = 35.0;
  int scene = 0;  ///< of each result
};

/// An SVG image: a row for each result, a column for each frame, all people of the scene in each, one scale for
/// everything. Limbs are drawn by parallel projection, the nearer over the farther, left ones blue and right ones
/// vermilion, and the floor as a line below. Throws Error(kInvalidArgument) where there are no frames, or one is beyond
/// the end of a scene.
std::string SkeletonStrip(const std::vector<ShownResult>& results, const StripOptions& options);

}  // namespace canonpose
