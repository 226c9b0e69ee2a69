// Which layout keypoints are in: nothing in a detector's file says whether its 25 values are BODY_25 or BODY_25B;
// anatomy does.
//
// Two properties that neither the pose nor the way up of a person changes much:
// - Joints that a layout calls neighbours are close together. So the kinematic tree of the right layout is hardly
// longer than the
//   shortest tree through the same points, whereas that of a wrong one zigzags through the body.
// - What a layout calls a left and a right limb are equally long, over a clip.
// Measured on a real recording (400 views) and a walk seen from the side: tree ratio 1.0 to 1.5 and asymmetry 0.02 to
// 0.11 for the right layout; 1.5 to 4.1 and 0.13 to 0.40 for the wrong one of as many joints; 2.0 to 5.8 and 0.11 to
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
  int frames = 0;  ///< measured; 0 where too few joints are seen together to tell anything
  double tree_ratio =
      0.0;  ///< mean edge of the layout's tree / mean edge of the shortest tree, lower quartile over frames
  /// Sum over pairs of left and right edges |l - r| / (l + r), each edge's length its upper quartile over frames.
  double asymmetry = 0.0;
  /// Median lengths over frames of what the layout calls thigh / shank and upper arm / forearm; 0 where not seen.
  double thigh_to_shank = 0.0;
  double upper_arm_to_forearm = 0.0;
  /// Small where the layout explains the keypoints: tree_ratio * (1 + 3 * asymmetry).
  [[nodiscard]] double misfit() const { return tree_ratio * (1.0 + 3.0 * asymmetry); }
  [[nodiscard]] bool fits() const;
};

/// Measures one layout on the clips of several cameras, at most some hundred frames of them.
LayoutFit MeasureLayout(const Skeleton& layout, std::span<const KeypointClip> clips);

/// The layout to read the clips with. Where `requested` is empty, the one that the number of keypoints and anatomy
/// allow, told in the log. Throws Error(kBadInput) where that is none or undecided, where `requested` has another
/// number of keypoints, and where anatomy contradicts it, also in one camera alone; names the layout that fits. Throws
/// Error(kInvalidArgument) for an unknown name.
const Skeleton& CheckLayout(std::span<const KeypointClip> clips, const std::string& requested);

}  // namespace canonpose
