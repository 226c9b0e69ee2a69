// The layout of keypoints that a detector's files name themselves, or that the user describes: animals, markers, and
// detectors that the program has no layout for.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/person_tracking.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// The layout with which to read the clips, whose keypoints are brought into its order.
/// - `requested` is a file (skeleton_json.h): that skeleton. Where the clips name their joints, they are taken by name,
///   and those that the skeleton lacks are left out, which is reported.
/// - It is a built-in layout: that one, after CheckLayout().
/// - It is empty, or the name of the clips' own layout: what the clips say. Where they do not name the bones, joints
/// are
///   connected by the shortest tree through them, which is reported. Where they say nothing, CheckLayout() decides.
/// `known` is a skeleton from an earlier import, or null: where `requested` is none of these, clips that do not name
/// their joints are in its order. Throws Error(kBadInput) where joints are missing or counts differ,
/// Error(kInvalidArgument) for an unknown name.
Skeleton LayoutOf(std::vector<KeypointClip>& clips, const std::string& requested, const Skeleton* known = nullptr);

/// Throws Error(kInvalidArgument) where no layout has this name and it is no file of a skeleton.
void RequireLayoutName(const std::string& layout);

/// How many keypoints the layout has; 0 where it is empty or only the detector's files know it. Throws Error(kBadInput)
/// where it is a file that is no skeleton.
int KeypointCountOf(const std::string& layout);

}  // namespace canonpose
