// Which joints are on the left of the body, as names and partners of a skeleton say it.
#pragma once

#include <string>

#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// The colours of everything on the body's left and right, wherever the project draws people: blue and vermilion, which
/// nearly all who are colour-blind can tell apart (Okabe and Ito 2008).
inline constexpr const char* kLeftColour = "#0072B2";
inline constexpr const char* kRightColour = "#D55E00";

/// "l", "r" or "m" (middle) for each joint. A joint with a partner is the left one where its name has an L where the
/// partner's has an R; where the names do not tell, the earlier one is.
std::string JointSides(const Skeleton& skeleton);

}  // namespace canonpose
