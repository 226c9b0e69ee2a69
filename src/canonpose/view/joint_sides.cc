#include "canonpose/view/joint_sides.h"

#include <algorithm>
#include <cctype>

namespace canonpose {

std::string JointSides(const Skeleton& skeleton) {
  std::string sides;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const auto partner = static_cast<std::size_t>(skeleton.mirror[j]);
    if (partner == j) {
      sides += 'm';
      continue;
    }
    const std::string& name = skeleton.joints[j];
    const auto difference = std::ranges::mismatch(name, skeleton.joints[partner]).in1;
    const int letter = difference == name.end() ? 0 : std::tolower(static_cast<unsigned char>(*difference));
    const bool is_left = letter == 'l' || (letter != 'r' && j < partner);
    sides += is_left ? 'l' : 'r';
  }
  return sides;
}

}  // namespace canonpose
