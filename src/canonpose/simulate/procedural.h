// Procedural motion: people of varied build who walk, run, jump, squat, reach, throw, gesture, dance and ski.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/motion/landmarks.h"

namespace canonpose {

enum class Activity { kGait, kRun, kJump, kSquat, kSit, kReach, kThrow, kGesture, kDance, kSki };

/// All activities, in the order of the enumeration.
const std::vector<Activity>& AllActivities();
/// "gait", "run", ...
std::string_view ActivityName(Activity activity);
/// An activity by name; throws Error(kInvalidArgument) that lists the names.
Activity ParseActivity(std::string_view name);

struct ProceduralClip {
  Activity activity = Activity::kGait;
  std::uint64_t subject_seed = 0;  ///< the person
  std::uint64_t motion_seed = 0;   ///< what the person does
  double fps = 50.0;
  int frames = 500;
  std::string name;
  std::string subject;
};

/// The motion of a clip; the same bits for the same clip. Joints are those of body.h. They have the landmarks' names,
/// so that MakeLandmarkTrack() finds them, except for the articulations Lumbar, Neck, LClavicle, RClavicle, LToes and
/// RToes, which are not landmarks. The person faces in any direction and is in the middle of the activity. The ground
/// is z = 0, and the root stays within about two metres of the origin (walkers within about three); a runner starts at
/// the origin, a skier on a slope through it, and both travel away.
ArticulatedMotion MakeProceduralMotion(const ProceduralClip& clip);

}  // namespace canonpose
