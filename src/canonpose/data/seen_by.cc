#include "canonpose/data/seen_by.h"

#include <algorithm>

namespace canonpose {

std::vector<std::uint8_t> SeenBy(const Sequence& sequence) {
  std::vector<std::uint8_t> seen;
  for (std::size_t c = 0; c < std::min<std::size_t>(8, sequence.cameras.size()); ++c) {
    const std::vector<float>& confidence = sequence.cameras[c].confidence;
    seen.resize(confidence.size(), 0);
    for (std::size_t i = 0; i < confidence.size(); ++i) {
      if (confidence[i] > 0.0F) seen[i] = static_cast<std::uint8_t>(seen[i] | (1U << c));
    }
  }
  return seen;
}

}  // namespace canonpose
