#include "canonpose/simulate/people/stepping.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace canonpose {
namespace {

using Eigen::Vector2d;

struct StandingPlace {
  Vector2d at;
  double yaw;
};

Vector2d Ahead(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }
Vector2d ToTheLeft(double yaw) { return {-std::sin(yaw), std::cos(yaw)}; }

class Planner {
 public:
  Planner(Stage& stage, const StepOptions& options) : stage_(stage), options_(options) {
    for (const int side : {kLeft, kRight}) {
      feet_[side] = {{stage.Final(Of(kFootX, side)), stage.Final(Of(kFootY, side))}, stage.Final(Of(kFootYaw, side))};
    }
  }

  std::vector<Step> Plan() {
    std::vector<Step> steps;
    int side = stage_.RandomSide();
    // The first step may have started before the clip.
    double t = options_.from + (options_.from < 0.0 ? stage_.Uniform(0.0, 0.35) : 0.0);
    while (t < std::min(stage_.seconds(), options_.to)) {
      const double velocity = SpeedAt(t);
      const double hurry = velocity + TurnRateAt(t) * stage_.Tall(0.25);
      const Step step = Timing(side, t, hurry, velocity);
      if (hurry < 120.0) {
        // Standing: the foot that is farther off, or none if both are close enough.
        const double left = ErrorOf(kLeft, step);
        const double right = ErrorOf(kRight, step);
        if (std::max(left, right) < options_.patience_mm) {
          t += 0.06;
          continue;
        }
        side = left > right ? kLeft : kRight;
      }
      Step taken = Timing(side, t, hurry, velocity);
      Take(taken);
      steps.push_back(taken);
      t += taken.interval;
      side = 1 - side;
    }
    return steps;
  }

 private:
  [[nodiscard]] StandingPlace PelvisAt(double t) const {
    return {{stage_.At(kPelvisX, t), stage_.At(kPelvisY, t)}, stage_.At(kPelvisYaw, t)};
  }
  [[nodiscard]] double SpeedAt(double t) const { return (PelvisAt(t + 0.25).at - PelvisAt(t - 0.05).at).norm() / 0.3; }
  [[nodiscard]] double TurnRateAt(double t) const {
    return std::abs(stage_.At(kPelvisYaw, t + 0.25) - stage_.At(kPelvisYaw, t - 0.05)) / 0.3;
  }

  [[nodiscard]] Step Timing(int side, double t, double hurry, double velocity) const {
    const double metres = hurry / 1000.0 * 1.75 / (stage_.body().stature / 1000.0);
    const double rate = options_.running ? 2.35 + 0.13 * metres : 1.05 + 0.62 * std::min(metres, 2.4);
    Step step{};
    step.side = side;
    step.start = t;
    step.interval = 1.0 / (rate * options_.cadence);
    step.swing = step.interval * (options_.running ? std::clamp(1.63 + 0.04 * (metres - 2.2), 1.60, 1.74) : 0.80);
    step.speed = velocity;
    return step;
  }

  // The position of the foot for the middle of its next stance.
  [[nodiscard]] StandingPlace Desired(const Step& step) const {
    const double end = step.start + 2 * step.interval;
    const double landing = step.start + step.swing;
    // Slightly more of the stance is behind the body, where the heel rises.
    const StandingPlace pelvis = PelvisAt(landing + 0.42 * (end - landing));
    const double sign = SideSign(step.side);
    StandingPlace place;
    place.yaw = pelvis.yaw + sign * options_.toe_out;
    place.at = pelvis.at + sign * options_.half_width * ToTheLeft(pelvis.yaw);
    const StandingPlace& other = feet_[1 - step.side];
    // Feet do not cross: the distance that remains between them, relative to the pelvis' heading.
    const double apart = sign * (place.at - other.at).dot(ToTheLeft(pelvis.yaw));
    const double least = std::min(1.2 * options_.half_width, stage_.Tall(0.06));
    if (apart < least) place.at += sign * (least - apart) * ToTheLeft(pelvis.yaw);
    return place;
  }

  [[nodiscard]] double ErrorOf(int side, Step step) const {
    step.side = side;
    const StandingPlace desired = Desired(step);
    return (desired.at - feet_[side].at).norm() + std::abs(desired.yaw - feet_[side].yaw) * stage_.Tall(0.14);
  }

  void Take(const Step& step) {
    const StandingPlace from = feet_[step.side];
    const StandingPlace to = Desired(step);
    feet_[step.side] = to;
    stage_.MoveTo(Of(kFootX, step.side), step.start, step.swing, to.at.x());
    stage_.MoveTo(Of(kFootY, step.side), step.start, step.swing, to.at.y());
    stage_.MoveTo(Of(kFootYaw, step.side), step.start, step.swing, to.yaw);
    GoAround(step, from, to);
    const double pelvis_yaw = stage_.At(kPelvisYaw, step.start + step.swing);
    const double stride = (to.at - from.at).dot(Ahead(pelvis_yaw)) / stage_.Tall(0.75);
    const double forward = std::clamp(stride, -0.4, 1.25);
    const double length = std::clamp((to.at - from.at).norm() / stage_.Tall(0.4), 0.5, 1.0);
    const int pitch = Of(kFootPitch, step.side);
    if (options_.running) {
      const double kick = options_.lift * (0.35 + 0.65 * std::clamp(forward, 0.0, 1.25));
      stage_.Bump(Of(kFootLift, step.side), step.start, 0.98 * step.swing, stage_.Tall(kick));
      stage_.Bump(pitch, step.start - 0.5 * step.interval, 1.5 * step.interval, options_.heel_rise);
    } else {
      stage_.Bump(Of(kFootLift, step.side), step.start, step.swing, stage_.Tall(options_.lift) * length);
      const double rise = options_.heel_rise * std::max(forward, 0.15 * length);
      stage_.Bump(pitch, step.start - 0.55 * step.interval, 1.15 * step.interval, rise);
      const double sway = -SideSign(step.side) * stage_.Tall(options_.lean_over);
      stage_.Bump(kSway, step.start - 0.12 * step.interval, 1.3 * step.interval, sway);
    }
    const double toes = options_.toes_up * std::max(forward, 0.0);
    stage_.Bump(pitch, step.start + 0.45 * step.swing, 0.55 * step.swing + 0.35 * step.interval, -toes);
  }

  // A foot passes the standing leg on the outside.
  void GoAround(const Step& step, const StandingPlace& from, const StandingPlace& to) {
    const Vector2d other = feet_[1 - step.side].at;
    const Vector2d path = to.at - from.at;
    const double length = path.norm();
    if (length < 20.0) return;
    const double along = std::clamp((other - from.at).dot(path) / (length * length), 0.15, 0.85);
    const Vector2d outwards = SideSign(step.side) * ToTheLeft(to.yaw);
    const double gap = (from.at + along * path - other).dot(outwards);
    const double missing = std::clamp(stage_.Tall(0.06) - gap, 0.0, stage_.Tall(0.12));
    stage_.Bump(Of(kFootX, step.side), step.start, step.swing, missing * outwards.x());
    stage_.Bump(Of(kFootY, step.side), step.start, step.swing, missing * outwards.y());
  }

  Stage& stage_;
  const StepOptions& options_;
  StandingPlace feet_[2];
};

}  // namespace

std::vector<Step> PlanSteps(Stage& stage, const StepOptions& options) { return Planner(stage, options).Plan(); }

std::vector<double> LeftFootAhead(const Stage& stage) {
  std::vector<double> ahead(static_cast<std::size_t>(stage.frames()));
  for (std::size_t f = 0; f < ahead.size(); ++f) {
    const double yaw = stage[kPelvisYaw][f];
    const Vector2d between(stage[Of(kFootX, kLeft)][f] - stage[Of(kFootX, kRight)][f],
                           stage[Of(kFootY, kLeft)][f] - stage[Of(kFootY, kRight)][f]);
    ahead[f] = between.dot(Ahead(yaw)) / stage.body().stature;
  }
  return ahead;
}

}  // namespace canonpose
