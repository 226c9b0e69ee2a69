// The activities: each fills a stage. See procedural.h.
#pragma once

#include "canonpose/simulate/people/stage.h"

namespace canonpose {

void PerformGait(Stage& stage);
void PerformRun(Stage& stage);
void PerformJump(Stage& stage);
void PerformSquat(Stage& stage);
void PerformSit(Stage& stage);
void PerformReach(Stage& stage);
void PerformThrow(Stage& stage);
void PerformGesture(Stage& stage);
void PerformDance(Stage& stage);
void PerformSki(Stage& stage);

/// A gesture of one or both arms, about `seconds` long; also used for people who sit or walk. Returns the time of its
/// end.
double MakeGesture(Stage& stage, double start, double seconds);

}  // namespace canonpose
