// Names of joints as other programs write them.
#pragma once

#include <string>
#include <vector>

namespace canonpose {

/// The names without what comes before a colon or a bar ("Armature|mixamorig:Hips" -> "Hips"), and without a prefix
/// that at least four fifths of them share and that ends where a word does ("Character1_Hips", "mixamorigHips"). Names
/// without the prefix stay as they are, and so do all where some would become equal.
std::vector<std::string> WithoutPrefix(const std::vector<std::string>& names);

/// (J) the left-right partner of each joint by its name, or the joint itself: "LEar" and "REar", "left ear" and "right
/// ear", "ear_L" and "ear_R", "EarLeft" and "EarRight". A side counts where the partner is there, too.
std::vector<int> SidePartners(const std::vector<std::string>& names);

}  // namespace canonpose
