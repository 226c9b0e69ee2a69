// The score of a movement: curves over time for everything that a body can do, in layers.
//
// Movements are sums of minimum-jerk strokes (Flash and Hogan 1985), which overlap freely and stay smooth to the second
// derivative. Angles are radians; positions mm in the world.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/simulate/people/body.h"

namespace canonpose {

constexpr double kGravityMmPerS2 = 9810.0;
constexpr double kPi = std::numbers::pi;

/// The channels: those of the trunk, then those of the left limbs, then those of the right limbs.
enum StageChannel : int {
  kPelvisX,  ///< path of the pelvis
  kPelvisY,
  kPelvisZ,      ///< height of the pelvis relative to standing straight, mm; negative is lower
  kPelvisYaw,    ///< counter-clockwise from above
  kPelvisPitch,  ///< forward
  kPelvisRoll,   ///< to the left
  kTrunkFlex,    ///< forward, relative to the pelvis
  kTrunkSide,    ///< to the left
  kTrunkTwist,   ///< to the left
  kNeckFlex,
  kNeckSide,
  kNeckTwist,
  kSway,   ///< of the pelvis to its left, mm; not followed by the feet
  kSurge,  ///< of the pelvis forward, mm; not followed by the feet
  kFirstSideChannel,
};
enum SideChannel : int {
  kShoulderFlex,   ///< forward; with kShoulderAbd the upper arm's rotation vector relative to hanging
  kShoulderAbd,    ///< away from the body
  kShoulderTwist,  ///< inwards about the upper arm
  kElbow,          ///< 0 straight
  kShrug,          ///< shoulder up
  kProtract,       ///< shoulder forward
  kHandWeight,     ///< 0: the arm follows its angles; 1: the wrist is at kHandX, kHandY, kHandZ
  kHandX,
  kHandY,
  kHandZ,
  kFree,      ///< 0: the foot is placed by the foot's channels; 1: by the leg's angles
  kLegFlex,   ///< direction from hip to ankle, forward from the pelvis' downward direction
  kLegAbd,    ///< away from the body
  kLegTwist,  ///< knee outwards; added to what a planted foot requires
  kKnee,      ///< flexion, for a free leg
  kAnkle,     ///< plantar flexion, for a free leg
  kFootX,     ///< ankle of the flat foot
  kFootY,
  kFootLift,   ///< height of the sole
  kFootYaw,    ///< where the toes point
  kFootPitch,  ///< heel up (about the ball), or toes up (about the heel) where negative
  kFootRoll,   ///< tilt to the left
  kSideChannelCount
};
constexpr int kChannelCount = kFirstSideChannel + 2 * kSideChannelCount;

constexpr int Of(SideChannel channel, int side) { return kFirstSideChannel + side * kSideChannelCount + channel; }

/// From 0 to 1 with zero velocity and acceleration at both ends; constant outside 0..1.
double MinimumJerk(double s);
/// From 0 to 1 and back to 0, as smooth as MinimumJerk(); the maximum is at 0.5.
double SmoothBump(double s);

/// A smooth curve that is never below `values`: the maximum over a window, averaged twice over the same window.
std::vector<double> SmoothCover(const std::vector<double>& values, int half_window);

/// Position, velocity and acceleration of a channel at a time, for Quintic().
struct Knot {
  double time;
  double value;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// How a person stands and moves, whatever the activity.
struct Style {
  double stance_half_width;  ///< mm from the midline to an ankle
  double toe_out;
  double arm_carry;    ///< the arms' abduction when hanging
  double elbow_carry;  ///< the elbows' flexion when hanging
  double trunk_lean;
  double head_pitch;
  double tempo;   ///< around 1
  double energy;  ///< around 1: size of movements
  double noise;   ///< size of the small random movements
  double asymmetry;
};

class Stage {
 public:
  Stage(const Body& body, double fps, int frames, Rng rng);

  [[nodiscard]] const Body& body() const { return body_; }
  [[nodiscard]] const Style& style() const { return style_; }
  Rng& rng() { return rng_; }
  [[nodiscard]] double fps() const { return fps_; }
  [[nodiscard]] int frames() const { return frames_; }
  [[nodiscard]] double seconds() const { return frames_ / fps_; }
  /// The length in mm of a fraction of the body's stature.
  [[nodiscard]] double Tall(double share) const { return share * body_.stature; }

  /// Ski boots: toes do not bend, heels do not rise, and the foot's channels give the position of the ankle itself.
  void WearBoots() { boots_ = true; }
  [[nodiscard]] bool boots() const { return boots_; }

  std::vector<double>& operator[](int channel) { return values_[static_cast<std::size_t>(channel)]; }
  const std::vector<double>& operator[](int channel) const { return values_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] double At(int channel, double time) const;

  /// Adds a constant over the whole clip.
  void Add(int channel, double value);
  /// A stroke from the end of the channel's strokes so far to `value`.
  void MoveTo(int channel, double start, double duration, double value);
  void MoveBy(int channel, double start, double duration, double change);
  /// The channel's value after its strokes so far.
  [[nodiscard]] double Final(int channel) const { return final_[static_cast<std::size_t>(channel)]; }
  /// A stroke there and back.
  void Bump(int channel, double start, double duration, double height);
  /// Swinging with a smooth start and end and a varying amplitude.
  void Swing(int channel, double start, double duration, double hertz, double amplitude, double phase);
  /// Smooth random movement over the whole clip with frequencies up to `hertz`.
  void Waver(int channel, double amplitude, double hertz);
  /// Adds fifth-order curves through knots: zero before the first knot, the last value after the last one.
  void Quintic(int channel, const std::vector<Knot>& knots);

  /// A random number in a range.
  double Uniform(double low, double high) { return rng_.Uniform(low, high); }
  bool Chance(double probability) { return rng_.Uniform() < probability; }
  int RandomSide() { return Chance(0.5) ? kLeft : kRight; }
  /// A duration of about `seconds` at the person's tempo.
  double Beat(double seconds) { return seconds / style_.tempo * rng_.Uniform(0.85, 1.18); }

 private:
  [[nodiscard]] int FrameAt(double time) const;

  Body body_;
  double fps_;
  int frames_;
  Rng rng_;
  Style style_{};
  bool boots_ = false;
  std::array<std::vector<double>, kChannelCount> values_;
  std::array<double, kChannelCount> final_{};
};

/// Hanging arms, the person's characteristic posture, and small movements of everything. Every activity starts with
/// this.
void StandNaturally(Stage& stage);
/// Places the feet side by side under the pelvis at the start.
void PlaceFeet(Stage& stage, double half_width);
/// Turns the head (and the trunk a little) to look around occasionally.
void LookAround(Stage& stage, double from, double to, double every_seconds);

}  // namespace canonpose
