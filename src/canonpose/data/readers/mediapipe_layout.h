// The 33 landmarks of MediaPipe's pose, which MediaPipe's dumps and FreeMoCap's arrays contain.
#pragma once

#include "canonpose/data/readers/detections.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

inline constexpr std::size_t kMediapipePoints = 33;

/// "mediapipe-33": the landmarks in MediaPipe's order, with the program's names where it has the joint: LFootIndex is
/// LBigToe.
const Skeleton& MediapipeLayout();
/// The same as a file's own layout.
DetectedLayout DetectedMediapipeLayout();

/// The place of a landmark by its name as MediaPipe spells it, in any case and punctuation: "LEFT_FOOT_INDEX", "left
/// foot index", or as the layout has it. Nothing where it is none.
std::optional<int> FindLandmark(std::string_view name);

}  // namespace canonpose
