#include "canonpose/simulate/procedural.h"

#include <array>

#include "canonpose/base/error.h"
#include "canonpose/simulate/activities.h"
#include "canonpose/simulate/body.h"
#include "canonpose/simulate/pose_solver.h"
#include "canonpose/simulate/stage.h"

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
  ThrowUsage("there is no activity '{}'; choose from {}", name, names);
}

ArticulatedMotion MakeProceduralMotion(const ProceduralClip& clip) {
  CANONPOSE_CHECK(clip.frames > 0 && clip.fps > 0.0, "{} frames at {} frames a second", clip.frames, clip.fps);
  const Rng rng(clip.motion_seed, {kMotionStream, static_cast<std::uint64_t>(clip.activity)});
  Stage stage(MakeBody(clip.subject_seed), clip.fps, clip.frames, rng);
  EntryOf(clip.activity).perform(stage);
  ArticulatedMotion motion = PerformStage(stage);
  motion.name = clip.name;
  motion.subject = clip.subject;
  return motion;
}

}  // namespace canonpose
