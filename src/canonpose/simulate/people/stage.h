// Where a movement is written down: curves over time for everything that a body can do, layer upon layer.
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

/// What moves: the channels of the trunk, then those of the left limbs, then those of the right.
enum StageChannel : int {
  kPelvisX,  ///< where the pelvis goes
  kPelvisY,
  kPelvisZ,      ///< height of the pelvis over standing straight, mm; negative is lower
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
  kShoulderFlex,   ///< forward; with the next the upper arm's rotation vector away from hanging
  kShoulderAbd,    ///< away from the body
  kShoulderTwist,  ///< inwards about the upper arm
  kElbow,          ///< 0 straight
  kShrug,          ///< shoulder up
  kProtract,       ///< shoulder forward
  kHandWeight,     ///< 0: the arm's angles; 1: the wrist is at the next three
  kHandX,
  kHandY,
  kHandZ,
  kFree,      ///< 0: the foot is where the foot's channels say; 1: where the leg's angles say
  kLegFlex,   ///< direction from hip to ankle forward of the pelvis' down
  kLegAbd,    ///< away from the body
  kLegTwist,  ///< knee outwards; added to what a planted foot demands
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

/// 0 to 1 with zero velocity and acceleration at both ends; constant outside 0..1.
double MinimumJerk(double s);
/// 0 to 1 and back to 0, smooth like MinimumJerk(); the top is at 0.5.
double SmoothBump(double s);

/// A smooth curve that is nowhere below `values`: the maximum over a window, averaged over the same window twice.
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
  /// Lengths relative to the body's stature, mm.
  [[nodiscard]] double Tall(double share) const { return share * body_.stature; }

  /// Ski boots: toes do not bend, heels do not rise, and the foot's channels are the place of the ankle itself.
  void WearBoots() { boots_ = true; }
  [[nodiscard]] bool boots() const { return boots_; }

  std::vector<double>& operator[](int channel) { return values_[static_cast<std::size_t>(channel)]; }
  const std::vector<double>& operator[](int channel) const { return values_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] double At(int channel, double time) const;

  /// Adds a constant over the whole clip.
  void Add(int channel, double value);
  /// A stroke from where the channel's strokes so far end to `value`.
  void MoveTo(int channel, double start, double duration, double value);
  void MoveBy(int channel, double start, double duration, double change);
  /// Where the channel's strokes so far end.
  [[nodiscard]] double Final(int channel) const { return final_[static_cast<std::size_t>(channel)]; }
  /// There and back.
  void Bump(int channel, double start, double duration, double height);
  /// Swinging with a smooth beginning and end; the amplitude wavers.
  void Swing(int channel, double start, double duration, double hertz, double amplitude, double phase);
  /// Smooth random movement over the whole clip with frequencies up to `hertz`.
  void Waver(int channel, double amplitude, double hertz);
  /// Fifth order curves through knots, added; nothing before the first knot, the last value after the last.
  void Quintic(int channel, const std::vector<Knot>& knots);

  /// A number from a range.
  double Uniform(double low, double high) { return rng_.Uniform(low, high); }
  bool Chance(double probability) { return rng_.Uniform() < probability; }
  int RandomSide() { return Chance(0.5) ? kLeft : kRight; }
  /// A time that is `seconds` at the person's tempo, give or take.
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

/// Hanging arms, the posture of the person's style, and small movements on everything. Every activity begins with it.
void StandNaturally(Stage& stage);
/// Feet beside each other under the pelvis' place at the beginning.
void PlaceFeet(Stage& stage, double half_width);
/// Head (and a little of the trunk) turning to look around now and then.
void LookAround(Stage& stage, double from, double to, double every_seconds);

}  // namespace canonpose
