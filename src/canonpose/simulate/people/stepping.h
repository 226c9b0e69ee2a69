// Steps that follow the pelvis: which foot goes where and when.
#pragma once

#include <vector>

#include "canonpose/simulate/people/stage.h"

namespace canonpose {

struct StepOptions {
  bool running = false;
  double half_width = 0.0;  ///< mm from the line of walking to an ankle
  double toe_out = 0.0;
  double lift = 0.03;                   ///< of a swinging foot, as a fraction of the stature
  double heel_rise = RadFromDeg(35.0);  ///< before the foot leaves the ground, at full speed forward
  double toes_up = RadFromDeg(14.0);    ///< when it lands
  double cadence = 1.0;                 ///< steps per second, relative to the usual rate at this speed
  double patience_mm = 60.0;            ///< a standing person does not correct a foot that is off by less than this
  double lean_over = 0.010;             ///< sway of the pelvis over the standing leg, as a fraction of the stature
  double from = -0.1;                   ///< seconds; steps start in this part of the clip
  double to = 1e9;
};

struct Step {
  int side;
  double start;     ///< when the foot leaves the ground
  double swing;     ///< seconds in the air
  double interval;  ///< seconds from this step to the next
  double speed;     ///< of the pelvis, mm/s
};

/// Writes steps to the foot channels that keep the feet under the pelvis along its path (kPelvisX, kPelvisY,
/// kPelvisYaw), starting with the feet placed by PlaceFeet(). While the pelvis rests, so do the feet.
std::vector<Step> PlanSteps(Stage& stage, const StepOptions& options);

/// How far the left foot is ahead of the right one in each frame, as a fraction of the stature: the phase of walking
/// with which arms and trunk swing.
std::vector<double> LeftFootAhead(const Stage& stage);

}  // namespace canonpose
