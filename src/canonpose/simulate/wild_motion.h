// Poses that no activity of the procedural people holds: hanging by the hands, climbing, lying, upside down, one
// person's legs with another's arms. For training that must not be surprised, not for captures that look real.
#pragma once

#include "canonpose/base/random.h"
#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// How often a clip gets each change (0..1), and how strong it is at the most. Every change is drawn once for a clip;
/// what then varies does so smoothly, within about a second.
struct WildOptions {
  double arms_raised = 0.2;     ///< arms above the head, as who hangs or climbs
  double arms_anywhere = 0.2;   ///< arms in any direction
  double legs_anywhere = 0.25;  ///< legs lifted, spread and bent, off the ground
  double trunk_bent = 0.15;     ///< the trunk bent forward or backward
  double leaning = 0.25;        ///< the whole body inclined by some 25 degrees
  double tumbled = 0.1;         ///< the whole body in any orientation: prone, supine, inverted
  // Standard deviations of smooth random angles, degrees; a clip's own lie between 0 and these.
  double arm_noise_deg = 30.0;
  double leg_noise_deg = 18.0;
  double hinge_noise_deg = 25.0;  ///< elbows and knees, which stay within their range
  double trunk_noise_deg = 10.0;  ///< each joint of the spine and neck
};

/// Changes a procedural motion (the joints of people/body.h) in place. Feet no longer keep to the ground; knees and
/// elbows bend one way only, by 148 and 145 degrees at the most.
void MakeWild(ArticulatedMotion& motion, const WildOptions& options, Rng rng);

/// Gives a procedural motion the trunk, head and arms of another one; where that is shorter it starts anew.
void TakeUpperBody(const ArticulatedMotion& other, ArticulatedMotion& motion);

}  // namespace canonpose
