// Giant slalom: carved turns left and right down a slope.
#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "canonpose/simulate/people/activities.h"

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct SkierStyle {
  double slope;
  double heading;
  double turn_seconds;  // of one turn to one side
  double inclination;   // the largest
  double stretch;       // of the outer leg, as a fraction of its length
  double stretch_range;
  double stretch_phase;
  double crouch_pitch;  // of the pelvis
  double crouch_flex;   // of the trunk
  double angulation;    // how much of the inclination the trunk compensates
  double facing;        // how much of the turn the trunk compensates
  double width;         // between the feet, mm
  double lead;          // of the inner ski, mm
};

SkierStyle MakeSkier(Stage& stage) {
  SkierStyle skier{};
  skier.slope = RadFromDeg(stage.Uniform(10.0, 27.0));
  skier.heading = stage.Uniform(-kPi, kPi);
  skier.turn_seconds = stage.Uniform(1.05, 1.9);
  skier.inclination = RadFromDeg(stage.Uniform(36.0, 56.0));
  skier.stretch = stage.Uniform(0.74, 0.83);
  skier.stretch_range = stage.Uniform(0.0, 0.035);
  skier.stretch_phase = stage.Uniform(-0.6, 0.6);
  skier.crouch_pitch = RadFromDeg(stage.Uniform(2.0, 18.0));
  skier.crouch_flex = RadFromDeg(stage.Uniform(12.0, 40.0));
  skier.angulation = stage.Uniform(0.35, 0.7);
  skier.facing = stage.Uniform(0.2, 0.6);
  skier.width = stage.Tall(stage.Uniform(0.13, 0.20));
  skier.lead = stage.Tall(stage.Uniform(0.02, 0.06));
  return skier;
}

struct Angles {
  double yaw;
  double pitch;
  double roll;
};

// Inverse of Rz(yaw) Ry(pitch) Rx(-roll).
Angles AnglesOf(const Matrix3d& world_from_body) {
  const Vector3d front = world_from_body.col(0);
  const double pitch = std::asin(std::clamp(-front.z(), -1.0, 1.0));
  const double roll = -std::atan2(world_from_body(2, 1), world_from_body(2, 2));
  return {std::atan2(front.y(), front.x()), pitch, roll};
}

// The position of the skis and the forces of the turn at one time; x is the horizontal direction down the slope, y is
// to the left.
struct Turn {
  Vector3d place;
  Vector3d front;   // along the skis
  Vector3d normal;  // of the slope
  double lean;      // inclination to the left
};

class Skier {
 public:
  explicit Skier(Stage& stage) : stage_(stage), skier_(MakeSkier(stage)) {
    slow_ = {stage.Uniform(0.05, 0.2), stage.Uniform(0.0, 2 * kPi), stage.Uniform(0.05, 0.2),
             stage.Uniform(0.0, 2 * kPi)};
    phase_ = stage.Uniform(0.0, 2 * kPi);
  }

  void Ski() {
    const double rate = kPi / skier_.turn_seconds;
    // The lateral amplitude for which the sharpest turn requires the largest inclination.
    const double amplitude = kGravityMmPerS2 * std::cos(skier_.slope) * std::tan(skier_.inclination) / (rate * rate);
    const double speed = amplitude * rate * stage_.Uniform(1.6, 2.2);
    double phase = phase_;
    double down = 0.0;
    const double start = amplitude * std::sin(phase);
    const double dt = 1.0 / stage_.fps();
    for (int f = 0; f < stage_.frames(); ++f) {
      const double t = f * dt;
      const double own_rate = rate * (1.0 + 0.10 * std::sin(2 * kPi * slow_[0] * t + slow_[1]));
      const double size = 1.0 + 0.15 * std::sin(2 * kPi * slow_[2] * t + slow_[3]);
      const double across_speed = amplitude * size * own_rate * std::cos(phase);
      const double down_speed = std::sqrt(std::max(speed * speed - across_speed * across_speed, 0.1 * speed * speed));
      Turn turn;
      const Vector3d downhill(std::cos(skier_.slope), 0, -std::sin(skier_.slope));
      turn.normal = {std::sin(skier_.slope), 0, std::cos(skier_.slope)};
      turn.place = down * downhill + Vector3d(0, amplitude * size * std::sin(phase) - start, 0);
      turn.front = (down_speed * downhill + Vector3d(0, across_speed, 0)).normalized();
      const double press = amplitude * size * own_rate * own_rate * std::sin(phase);
      turn.lean = -std::atan2(press, kGravityMmPerS2 * std::cos(skier_.slope));
      turn.lean /= std::pow(1.0 + std::pow(turn.lean / RadFromDeg(62.0), 8.0), 1.0 / 8.0);
      Write(f, turn, phase);
      phase += dt * own_rate;
      down += dt * down_speed;
    }
  }

 private:
  void Put(int channel, int frame, double value) { stage_[channel][static_cast<std::size_t>(frame)] += value; }

  // Rotated by the run's heading.
  void PutPlace(int x, int y, int frame, const Vector3d& place) {
    Put(x, frame, std::cos(skier_.heading) * place.x() - std::sin(skier_.heading) * place.y());
    Put(y, frame, std::sin(skier_.heading) * place.x() + std::cos(skier_.heading) * place.y());
  }

  void Write(int frame, const Turn& turn, double phase) {
    const Body& body = stage_.body();
    const Vector3d left = turn.normal.cross(turn.front);
    // The legs' axis, leaning to the inside.
    const Vector3d up = std::cos(turn.lean) * turn.normal + std::sin(turn.lean) * left;
    const double cosine = std::cos(2.0 * phase + skier_.stretch_phase);
    const double inside = std::sin(turn.lean);
    const double stretch = skier_.stretch - skier_.stretch_range * cosine - 0.08 * inside * inside;
    const Vector3d pelvis = turn.place + up * (stretch * body.leg(kLeft) + body.ankle_height[kLeft]) -
                            turn.front * stage_.Tall(0.045) - left * (inside * stage_.Tall(0.02));
    PutPlace(kPelvisX, kPelvisY, frame, pelvis);
    Put(kPelvisZ, frame, pelvis.z() - body.standing_hip_height());
    const double swing = std::atan2(turn.front.y(), turn.front.x());
    PutPelvis(frame, turn, swing);
    for (const int side : {kLeft, kRight}) PutBoot(frame, side, turn, left, up);
    Put(kTrunkSide, frame, -skier_.angulation * turn.lean * 0.75);
    Put(kTrunkTwist, frame, -skier_.facing * 0.7 * swing);
    Put(kNeckTwist, frame, -0.25 * swing);
    Put(kNeckSide, frame, -0.25 * turn.lean);
    // The outer hand lower, the inner one up, off the snow.
    for (const int side : {kLeft, kRight}) {
      const double inner = SideSign(side) * inside;
      Put(Of(kShoulderAbd, side), frame, RadFromDeg(20.0) * inner + RadFromDeg(8.0) * inner * inner);
      Put(Of(kShoulderFlex, side), frame, RadFromDeg(12.0) * inner);
    }
  }

  void PutPelvis(int frame, const Turn& turn, double swing) {
    // The pelvis leans less than the legs and faces slightly down the slope.
    const double lean = turn.lean * (1.0 - 0.25 * skier_.angulation);
    Matrix3d skis;
    skis.col(0) = turn.front;
    skis.col(1) = turn.normal.cross(turn.front);
    skis.col(2) = turn.normal;
    const Matrix3d pelvis = skis * (Eigen::AngleAxisd(-lean, Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(-0.3 * skier_.facing * swing, Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(skier_.crouch_pitch, Vector3d::UnitY()))
                                       .toRotationMatrix();
    const Angles angles = AnglesOf(pelvis);
    Put(kPelvisYaw, frame, angles.yaw + skier_.heading);
    Put(kPelvisPitch, frame, angles.pitch);
    Put(kPelvisRoll, frame, angles.roll);
  }

  void PutBoot(int frame, int side, const Turn& turn, const Vector3d& left, const Vector3d& up) {
    const double sign = SideSign(side);
    const double inside = std::sin(turn.lean);
    // When leaning, the feet are apart along the slope, with the inner ski ahead.
    const double apart = sign * 0.5 * skier_.width * (1.0 + 0.6 * inside * inside);
    const double ahead = sign * inside * skier_.lead;
    const Vector3d ankle =
        turn.place + apart * left + ahead * turn.front + stage_.body().ankle_height[Body::Index(side)] * up;
    PutPlace(Of(kFootX, side), Of(kFootY, side), frame, ankle);
    Put(Of(kFootLift, side), frame, ankle.z());
    Matrix3d boot;
    boot.col(0) = turn.front;
    boot.col(1) = up.cross(turn.front);
    boot.col(2) = up;
    const Angles angles = AnglesOf(boot);
    Put(Of(kFootYaw, side), frame, angles.yaw + skier_.heading);
    Put(Of(kFootPitch, side), frame, angles.pitch);
    Put(Of(kFootRoll, side), frame, angles.roll);
  }

  Stage& stage_;
  SkierStyle skier_;
  std::array<double, 4> slow_{};
  double phase_ = 0.0;

 public:
  [[nodiscard]] const SkierStyle& skier() const { return skier_; }
};

}  // namespace

void PerformSki(Stage& stage) {
  stage.WearBoots();
  StandNaturally(stage);
  Skier skier(stage);
  skier.Ski();
  stage.Add(kTrunkFlex, skier.skier().crouch_flex);
  stage.Add(kNeckFlex, -0.55 * (skier.skier().crouch_flex + skier.skier().crouch_pitch));
  stage.Waver(kTrunkFlex, RadFromDeg(5.0), 0.8);
  // Hands with the poles forward and apart, each with its own habit; a pole plant between turns.
  for (const int side : {kLeft, kRight}) {
    stage.Add(Of(kShoulderFlex, side), RadFromDeg(stage.Uniform(20.0, 48.0)));
    stage.Add(Of(kShoulderAbd, side), RadFromDeg(stage.Uniform(12.0, 38.0)));
    stage.Add(Of(kShoulderTwist, side), RadFromDeg(stage.Uniform(-15.0, 25.0)));
    stage.Add(Of(kElbow, side), RadFromDeg(stage.Uniform(25.0, 70.0)));
    stage.Waver(Of(kShoulderFlex, side), RadFromDeg(9.0), 1.0);
    stage.Waver(Of(kShoulderAbd, side), RadFromDeg(7.0), 1.0);
    stage.Waver(Of(kElbow, side), RadFromDeg(12.0), 1.0);
  }
}

}  // namespace canonpose
