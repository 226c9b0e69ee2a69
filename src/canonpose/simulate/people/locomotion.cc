// Walking and running.
#include <algorithm>
#include <cmath>

#include "canonpose/simulate/people/activities.h"
#include "canonpose/simulate/people/arm_poses.h"
#include "canonpose/simulate/people/stepping.h"

namespace canonpose {
namespace {

// What the walker does for a while: velocity in the walker's own frame, mm/s.
struct Leg {
  double until;
  double ahead;
  double left;
};

double RandomSpeed(Stage& stage, bool running) {
  if (running) return 1000.0 * stage.Uniform(2.2, 3.6);
  return 1000.0 * std::clamp(1.25 + 0.42 * stage.rng().Normal(), 0.5, 2.2);
}

std::vector<Leg> PlanLegs(Stage& stage, bool running) {
  std::vector<Leg> legs;
  const double speed = RandomSpeed(stage, running);
  for (double t = 0.0; t < stage.seconds();) {
    const double chance = stage.Uniform(0.0, 1.0);
    const double own =
        std::clamp(speed * stage.Uniform(0.75, 1.3), running ? 2200.0 : 500.0, running ? 3600.0 : 2200.0);
    const double slow = 1000.0 * stage.Uniform(0.35, 0.85);
    if (running || t == 0.0 || chance < 0.68) {
      t += stage.Uniform(2.5, 6.0);
      legs.push_back({t, own, 0.0});
    } else if (chance < 0.80) {
      t += stage.Uniform(0.8, 2.5);
      legs.push_back({t, 0.0, 0.0});
    } else if (chance < 0.90) {
      t += stage.Uniform(1.8, 3.5);
      legs.push_back({t, -slow, 0.0});
    } else {
      t += stage.Uniform(1.5, 3.0);
      legs.push_back({t, 0.0, slow * SideSign(stage.RandomSide())});
    }
  }
  return legs;
}

// The pelvis' path through a room, from one goal to the next with limited angular velocities. Linear and angular
// velocities pass through two first-order lags, so that accelerations are smooth.
void WalkThroughRoom(Stage& stage, const std::vector<Leg>& legs, double radius, double max_turn) {
  double x = 0.0;
  double y = 0.0;
  double yaw = stage.Uniform(-kPi, kPi);
  double goal_x = radius * std::cos(yaw);
  double goal_y = radius * std::sin(yaw);
  double ahead[2] = {legs[0].ahead, legs[0].ahead};
  double left[2] = {0.0, 0.0};
  double turn[2] = {0.0, 0.0};
  double goal_time = 0.0;
  std::size_t leg = 0;
  const double dt = 1.0 / stage.fps();
  const double lag = 1.0 - std::exp(-dt / 0.22);
  for (int f = 0; f < stage.frames(); ++f) {
    const double t = f * dt;
    if (leg + 1 < legs.size() && t > legs[leg].until) ++leg;
    if (std::hypot(goal_x - x, goal_y - y) < 0.35 * radius || t > goal_time) {
      const double direction = stage.Uniform(-kPi, kPi);
      const double distance = radius * std::sqrt(stage.Uniform(0.3, 1.0));
      goal_x = distance * std::cos(direction);
      goal_y = distance * std::sin(direction);
      goal_time = t + stage.Uniform(2.5, 6.0);
    }
    const double moving = std::hypot(legs[leg].ahead, legs[leg].left);
    const double offset = moving > 0.0 ? std::atan2(legs[leg].left, legs[leg].ahead) : 0.0;
    const double to_goal = std::remainder(std::atan2(goal_y - y, goal_x - x) - offset - yaw, 2 * kPi);
    const double limit = max_turn * (moving > 0.0 ? 1.0 : 0.0);
    const double wanted_turn = std::clamp(1.6 * to_goal, -limit, limit);
    // Slower in sharp turns, as people do.
    const double ease = 1.0 - 0.45 * std::abs(turn[1]) / max_turn;
    ahead[0] += lag * (legs[leg].ahead * ease - ahead[0]);
    ahead[1] += lag * (ahead[0] - ahead[1]);
    left[0] += lag * (legs[leg].left * ease - left[0]);
    left[1] += lag * (left[0] - left[1]);
    turn[0] += lag * (wanted_turn - turn[0]);
    turn[1] += lag * (turn[0] - turn[1]);
    const auto i = static_cast<std::size_t>(f);
    stage[kPelvisX][i] += x;
    stage[kPelvisY][i] += y;
    stage[kPelvisYaw][i] += yaw;
    // The body leans into a turn, with the pelvis on the inside of the feet.
    const double lean = std::atan(ahead[1] * turn[1] / 9810.0);
    stage[kSway][i] += 0.8 * std::sin(lean) * stage.Tall(0.5);
    stage[kPelvisRoll][i] += 0.8 * lean;
    x += dt * (std::cos(yaw) * ahead[1] - std::sin(yaw) * left[1]);
    y += dt * (std::sin(yaw) * ahead[1] + std::cos(yaw) * left[1]);
    yaw += dt * turn[1];
  }
}

struct ArmSwing {
  double reach[2];  // radians of flexion by foot distance
  double elbow[2];
};

// Arms and trunk swing opposite to the legs.
void SwingAlong(Stage& stage, const std::vector<double>& left_ahead, const ArmSwing& swing,
                const std::array<std::vector<double>, 2>& busy, double pelvis_turn, double trunk_turn) {
  for (std::size_t f = 0; f < left_ahead.size(); ++f) {
    const double phase = left_ahead[f];
    for (const int side : {kLeft, kRight}) {
      const double own = -SideSign(side) * phase * (1.0 - busy[static_cast<std::size_t>(side)][f]);
      stage[Of(kShoulderFlex, side)][f] += swing.reach[side] * own;
      stage[Of(kElbow, side)][f] += swing.elbow[side] * (own + 0.25 * std::abs(phase));
    }
    stage[kTrunkTwist][f] += trunk_turn * phase;
    stage[kNeckTwist][f] -= 0.6 * (trunk_turn - pelvis_turn) * phase;
    stage[kPelvisYaw][f] -= pelvis_turn * phase;
  }
}

// Sometimes a hand does something else.
std::array<std::vector<double>, 2> BusyHands(Stage& stage, double chance) {
  std::array<std::vector<double>, 2> busy;
  for (std::vector<double>& hand : busy) hand.assign(static_cast<std::size_t>(stage.frames()), 0.0);
  if (!stage.Chance(chance)) return busy;
  double t = stage.Uniform(-1.0, 3.0);
  while (t < stage.seconds()) {
    const double hold = stage.Uniform(1.5, 6.0);
    const double reach_time = stage.Beat(0.7);
    const bool both = stage.Chance(0.4);
    const int one = stage.RandomSide();
    const bool random = stage.Chance(0.4);
    const auto pose = static_cast<ArmPose>(stage.rng().Index(static_cast<std::size_t>(ArmPose::kCount)));
    for (const int side : {kLeft, kRight}) {
      if (!both && side != one) continue;
      MoveArm(stage, side, t, reach_time, random ? RandomArm(stage) : AnglesOf(stage, pose));
      MoveArm(stage, side, t + hold, reach_time, HangingArm(stage));
      for (int f = 0; f < stage.frames(); ++f) {
        const double now = f / stage.fps();
        busy[static_cast<std::size_t>(side)][static_cast<std::size_t>(f)] +=
            0.85 * (MinimumJerk((now - t) / reach_time) - MinimumJerk((now - t - hold) / reach_time));
      }
    }
    t += hold + reach_time + stage.Uniform(0.3, 4.0);
  }
  return busy;
}

}  // namespace

void PerformGait(Stage& stage) {
  StandNaturally(stage);
  const std::vector<Leg> legs = PlanLegs(stage, false);
  WalkThroughRoom(stage, legs, 1000.0 * stage.Uniform(1.5, 2.2), RadFromDeg(stage.Uniform(75.0, 125.0)));
  StepOptions options;
  options.half_width = stage.Tall(stage.Uniform(0.022, 0.055));
  options.toe_out = RadFromDeg(stage.Uniform(-3.0, 14.0));
  options.lift = stage.Chance(0.12) ? stage.Uniform(0.06, 0.16) : stage.Uniform(0.015, 0.04);
  options.heel_rise = RadFromDeg(stage.Uniform(26.0, 46.0));
  options.toes_up = RadFromDeg(stage.Uniform(5.0, 24.0));
  options.cadence = stage.Uniform(0.88, 1.14);
  options.lean_over = stage.Uniform(0.006, 0.018);
  PlaceFeet(stage, options.half_width);
  PlanSteps(stage, options);
  ArmSwing swing{};
  const double size = stage.Chance(0.15) ? stage.Uniform(1.4, 2.2) : stage.Uniform(0.5, 1.3);
  for (const int side : {kLeft, kRight}) {
    swing.reach[side] = size * (1.0 + SideSign(side) * stage.style().asymmetry);
    swing.elbow[side] = size * stage.Uniform(0.2, 0.7);
  }
  const std::array<std::vector<double>, 2> busy = BusyHands(stage, 0.4);
  SwingAlong(stage, LeftFootAhead(stage), swing, busy, stage.Uniform(0.08, 0.28), stage.Uniform(0.1, 0.45));
  stage.Add(kTrunkFlex, RadFromDeg(stage.Chance(0.1) ? stage.Uniform(10.0, 30.0) : stage.Uniform(-3.0, 3.0)));
  stage.Add(kPelvisZ, -stage.Tall(stage.Chance(0.1) ? stage.Uniform(0.02, 0.10) : stage.Uniform(0.0, 0.003)));
  LookAround(stage, 0.0, stage.seconds(), 3.0);
}

void PerformRun(Stage& stage) {
  StandNaturally(stage);
  const std::vector<Leg> legs = PlanLegs(stage, true);
  WalkThroughRoom(stage, legs, 1000.0 * stage.Uniform(1.3, 2.0), RadFromDeg(stage.Uniform(120.0, 165.0)));
  StepOptions options;
  options.running = true;
  options.half_width = stage.Tall(stage.Uniform(0.022, 0.040));
  options.toe_out = RadFromDeg(stage.Uniform(-2.0, 10.0));
  options.lift = stage.Uniform(0.08, 0.18);
  options.heel_rise = RadFromDeg(stage.Uniform(40.0, 58.0));
  options.toes_up = RadFromDeg(stage.Uniform(0.0, 16.0));
  options.cadence = stage.Uniform(0.92, 1.10);
  PlaceFeet(stage, options.half_width);
  const double bounce = stage.Tall(stage.Uniform(0.035, 0.06));
  for (const Step& step : PlanSteps(stage, options)) {
    // The pelvis is highest in the middle of the flight, just after the foot has left.
    stage.Bump(kPelvisZ, step.start - 0.42 * step.interval, 1.2 * step.interval, bounce);
  }
  stage.Add(kPelvisZ, -bounce * 0.75 - stage.Tall(0.025));
  ArmSwing swing{};
  for (const int side : {kLeft, kRight}) {
    swing.reach[side] = stage.Uniform(0.9, 1.7);
    swing.elbow[side] = stage.Uniform(0.1, 0.7);
    stage.Add(Of(kElbow, side), RadFromDeg(stage.Uniform(45.0, 80.0)));
    stage.Add(Of(kShoulderFlex, side), -RadFromDeg(stage.Uniform(5.0, 20.0)));
    stage.Add(Of(kShoulderTwist, side), RadFromDeg(stage.Uniform(-8.0, 18.0)));
    stage.Add(Of(kShoulderAbd, side), RadFromDeg(stage.Uniform(5.0, 18.0)));
  }
  const std::array<std::vector<double>, 2> busy = BusyHands(stage, 0.15);
  SwingAlong(stage, LeftFootAhead(stage), swing, busy, stage.Uniform(0.10, 0.25), stage.Uniform(0.25, 0.50));
  stage.Add(kTrunkFlex, RadFromDeg(stage.Uniform(2.0, 10.0)));
  stage.Add(kPelvisPitch, RadFromDeg(stage.Uniform(2.0, 9.0)));
  stage.Add(kNeckFlex, -RadFromDeg(stage.Uniform(2.0, 12.0)));
  LookAround(stage, 0.0, stage.seconds(), 5.0);
}

}  // namespace canonpose
