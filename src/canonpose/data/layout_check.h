// Which layout keypoints are in: nothing in a detector's file says whether its 25 values are BODY_25 or BODY_25B;
// anatomy does.
//
// Joints that a layout calls neighbours are close together. So the kinematic tree of the right layout is hardly longer
// than the shortest tree through the same points, whatever the pose and whichever way up it is; that of a wrong layout
// zigzags through the body. Measured on a real recording (400 views), the tree of the right layout is 1.1 to 1.3 times
// as long as the shortest, that of BODY_25 for BODY_25B 3.6, of COCO-17 for Human3.6M 2.6 and the other way round 2.0;
// of a random order 2.0 to 5.8.
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
  /// Median lengths over frames of what the layout calls thigh / shank and upper arm / forearm; 0 where not seen.
  double thigh_to_shank = 0.0;
  double upper_arm_to_forearm = 0.0;
  [[nodiscard]] bool fits() const;
};

/// Measures one layout on the clips of several cameras, at most some hundred frames of them.
LayoutFit MeasureLayout(const Skeleton& layout, std::span<const KeypointClip> clips);

/// The layout to read the clips with. Where `requested` is empty, the one that the number of keypoints and anatomy
/// allow, told in the log. Throws Error(kBadInput) where that is none or undecided, where `requested` has another
/// number of keypoints, and where anatomy contradicts it, also in one camera alone; names the layout that fits. Throws
/// Error(kUsage) for an unknown name.
const Skeleton& CheckLayout(std::span<const KeypointClip> clips, const std::string& requested);

}  // namespace canonpose
