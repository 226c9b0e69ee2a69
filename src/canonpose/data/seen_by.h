// Which cameras saw a joint.
#pragma once

#include <cstdint>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// (T, J): bit c is set where camera c of the sequence saw the joint. Of more than eight cameras, the first eight.
std::vector<std::uint8_t> SeenBy(const Sequence& sequence);

}  // namespace canonpose
