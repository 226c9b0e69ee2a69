// Poses beyond the activities of the procedural people: hanging by the hands, climbing, lying, upside down, one
// person's legs with another's arms. For training a lifter to handle anything, not for realistic captures.
#pragma once

#include "canonpose/base/random.h"
#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// How often a clip gets each change (0..1), and how strong the change may be. Each change is drawn once per clip; its
/// parameters then vary smoothly, within about a second.
struct WildOptions {
  double arms_raised = 0.2;     ///< arms above the head, as when hanging or climbing
  double arms_anywhere = 0.2;   ///< arms in any direction
  double legs_anywhere = 0.25;  ///< legs lifted, spread and bent, off the ground
  double trunk_bent = 0.15;     ///< the trunk bent forward or backward
  double leaning = 0.25;        ///< the whole body inclined by about 25 degrees
  double tumbled = 0.1;         ///< the whole body in any orientation: prone, supine, inverted
  // Standard deviations of smooth random angles, degrees; those of a clip are between 0 and these.
  double arm_noise_deg = 30.0;
  double leg_noise_deg = 18.0;
  double hinge_noise_deg = 25.0;  ///< elbows and knees, within their range
  double trunk_noise_deg = 10.0;  ///< each joint of the spine and neck
};

/// Changes a procedural motion (with the joints of people/body.h) in place. Feet may leave the ground; knees and elbows
/// bend only one way, by at most 148 and 145 degrees.
void MakeWild(ArticulatedMotion& motion, const WildOptions& options, Rng rng);

/// Gives a procedural motion the trunk, head and arms of another one, which is repeated if it is shorter.
void TakeUpperBody(const ArticulatedMotion& other, ArticulatedMotion& motion);

}  // namespace canonpose
