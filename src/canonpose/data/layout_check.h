// Recognises the layout of keypoints by anatomy, since nothing in a detector's file says whether its 25 keypoints are
// BODY_25 or BODY_25B.
//
// clang-format off
// Two properties depend little on a person's pose and on which way up the image is:
// - Neighbouring joints of the layout are close together. So the kinematic tree of the right layout is hardly longer
//   than the shortest tree through the same points, whereas that of a wrong one zigzags through the body.
// - A left limb of the layout is as long as its right one, over a clip.
// clang-format on
//
// Measured on a real recording (400 views) and a walk seen from the side: tree ratio 1.0 to 1.5 and asymmetry 0.02 to
// 0.11 for the right layout; 1.5 to 4.1 and 0.13 to 0.40 for a wrong one with as many joints; 2.0 to 5.8 and 0.11 to
// 0.56 for random orders.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "canonpose/data/person_tracking.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// How well a layout explains keypoints.
struct LayoutFit {
  const Skeleton* layout = nullptr;
  int frames = 0;  ///< measured; 0 where too few joints are ever seen together
  /// Mean edge of the layout's tree / mean edge of the shortest tree, lower quartile over frames.
  double tree_ratio = 0.0;
  /// Sum |l - r| / sum (l + r) over pairs of left and right edges, where the length of an edge is its upper quartile
  /// over frames.
  double asymmetry = 0.0;
  /// Median over frames of the ratios thigh / shank and upper arm / forearm, by the layout's names; 0 where not seen.
  double thigh_to_shank = 0.0;
  double upper_arm_to_forearm = 0.0;
  /// Small where the layout explains the keypoints: tree_ratio * (1 + 3 * asymmetry).
  [[nodiscard]] double misfit() const { return tree_ratio * (1.0 + 3.0 * asymmetry); }
  [[nodiscard]] bool fits() const;
};

/// Measures one layout on the clips of several cameras, using at most a few hundred frames.
LayoutFit MeasureLayout(const Skeleton& layout, std::span<const KeypointClip> clips);

/// The layout with which to read the clips. Where `requested` is empty, it is the one that fits the number of keypoints
/// and anatomy, and is logged. Throws Error(kBadInput) where no layout or more than one fits, where `requested` has
/// another number of keypoints, and where anatomy contradicts it, even in a single camera; the message names the layout
/// that fits. Throws Error(kInvalidArgument) for an unknown name.
const Skeleton& CheckLayout(std::span<const KeypointClip> clips, const std::string& requested);

}  // namespace canonpose
