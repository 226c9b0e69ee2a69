// Which way is up in a motion whose file does not say so.
#pragma once

#include <string>

#include "canonpose/motion/articulated_motion.h"

namespace canonpose {

/// Turns a motion that was read with y up so that it stands upright, where it does not: some files have z up, others
/// are upside down. Up is where the head is, seen from the ankles, in the mean over all frames; the joints are found by
/// their names. Where the rest pose agrees, this is certain. Where it does not, the motion is turned only if the feet
/// stay on one level, the ground, since otherwise the person may simply lie; and it is turned where the person would
/// stand on the head all the time. Logs what it does, and warns where the person lies all the time. `file` is for
/// messages.
void StandUpright(ArticulatedMotion& motion, const std::string& file);

}  // namespace canonpose
