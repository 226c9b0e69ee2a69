#include "canonpose/simulate/procedural.h"

#include <array>
#include <cmath>
#include <string>

#include "canonpose/base/error.h"
#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/body.h"
#include "canonpose/simulate/people/pose_solver.h"
#include "canonpose/simulate/people/stage.h"

namespace canonpose {
namespace {

struct Entry {
  Activity activity;
  std::string_view name;
  void (*perform)(Stage&);
};

constexpr std::array<Entry, 10> kEntries = {{
    {Activity::kGait, "gait", PerformGait},
    {Activity::kRun, "run", PerformRun},
    {Activity::kJump, "jump", PerformJump},
    {Activity::kSquat, "squat", PerformSquat},
    {Activity::kSit, "sit", PerformSit},
    {Activity::kReach, "reach", PerformReach},
    {Activity::kThrow, "throw", PerformThrow},
    {Activity::kGesture, "gesture", PerformGesture},
    {Activity::kDance, "dance", PerformDance},
    {Activity::kSki, "ski", PerformSki},
}};

constexpr std::uint64_t kMotionStream = 0x307a;

constexpr std::uint64_t kLeadStream = 0x1ead;

void DropFrames(int count, ArticulatedMotion& motion) {
  motion.root_position_mm.erase(motion.root_position_mm.begin(), motion.root_position_mm.begin() + count);
  motion.parent_from_joint.erase(motion.parent_from_joint.begin(),
                                 motion.parent_from_joint.begin() + count * motion.joint_count());
}

// Rotates the whole clip about the vertical axis through the origin.
void TurnAround(double angle, ArticulatedMotion& motion) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  for (std::size_t f = 0; f < motion.root_position_mm.size(); ++f) {
    motion.root_position_mm[f] = turn * motion.root_position_mm[f];
    Eigen::Quaterniond& root = motion.parent_from_joint[f * motion.joints.size()];
    root = turn * root;
  }
}

const Entry& EntryOf(Activity activity) { return kEntries.at(static_cast<std::size_t>(activity)); }

}  // namespace

const std::vector<Activity>& AllActivities() {
  static const std::vector<Activity> activities = [] {
    std::vector<Activity> all;
    for (const Entry& entry : kEntries) all.push_back(entry.activity);
    return all;
  }();
  return activities;
}

std::string_view ActivityName(Activity activity) { return EntryOf(activity).name; }

Activity ParseActivity(std::string_view name) {
  std::string names;
  for (const Entry& entry : kEntries) {
    if (entry.name == name) return entry.activity;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", entry.name);
  }
  ThrowInvalidArgument("there is no activity '{}'; choose from {}", name, names);
}

ArticulatedMotion MakeProceduralMotion(const ProceduralClip& clip) {
  CANONPOSE_CHECK(clip.frames > 0 && clip.fps > 0.0, "{} frames at {} frames per second", clip.frames, clip.fps);
  const Rng rng(clip.motion_seed, {kMotionStream, static_cast<std::uint64_t>(clip.activity)});
  // Clips start in the middle of the activity; the first steps of a runner from standing are left out.
  Rng lead_rng(clip.motion_seed, {kLeadStream});
  const int lead = static_cast<int>(std::lround(lead_rng.Uniform(1.0, 3.5) * clip.fps));
  Stage stage(MakeBody(clip.subject_seed), clip.fps, lead + clip.frames, rng);
  EntryOf(clip.activity).perform(stage);
  ArticulatedMotion motion = PerformStage(stage);
  DropFrames(lead, motion);
  TurnAround(lead_rng.Uniform(-kPi, kPi), motion);
  if (clip.activity == Activity::kSki) {
    // Skiers travel and descend; their slope passes through the origin.
    Eigen::Vector3d start = motion.root_position_mm.front();
    start.z() -= stage.body().standing_hip_height() * 0.75;
    for (Eigen::Vector3d& position : motion.root_position_mm) position -= start;
  }
  motion.name = clip.name;
  motion.subject = clip.subject;
  return motion;
}

}  // namespace canonpose
