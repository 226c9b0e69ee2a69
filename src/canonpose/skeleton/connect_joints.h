// A skeleton for joints of which a file gives the names, and some or none of the bones.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// The tree that connects all joints: `bones` (pairs of indices, towards the root first) as far as they form no circle,
/// then the shortest of the other connections by `distances` (J, J), symmetric; NaN where unknown, empty where all are.
/// Partners follow from the names (SidePartners()); what lies on both sides has one distance, and partners are
/// connected with each other only where nothing else is near. The root is the one joint that is nowhere the second of a
/// pair, where `bones` connect all; otherwise the pelvis, or else the joint in the middle of the tree. Names must be
/// unique.
Skeleton ConnectJoints(const std::string& name, const std::vector<std::string>& joints,
                       const std::vector<std::array<int, 2>>& bones, const std::vector<double>& distances);

}  // namespace canonpose
