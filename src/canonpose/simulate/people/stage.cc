#include "canonpose/simulate/people/stage.h"

#include <algorithm>

namespace canonpose {
namespace {

Style MakeStyle(const Body& body, Rng& rng) {
  Style style{};
  style.stance_half_width = body.hip_width / 2 * rng.Uniform(0.75, 1.35);
  style.toe_out = RadFromDeg(rng.Uniform(-2.0, 18.0));
  style.arm_carry = RadFromDeg(rng.Uniform(5.0, 16.0));
  style.elbow_carry = RadFromDeg(rng.Uniform(8.0, 48.0));
  style.trunk_lean = RadFromDeg(rng.Uniform(-7.0, 6.0));
  style.head_pitch = RadFromDeg(rng.Uniform(-8.0, 14.0));
  style.tempo = rng.Uniform(0.78, 1.28);
  style.energy = rng.Uniform(0.7, 1.25);
  style.noise = rng.Uniform(0.5, 1.6);
  style.asymmetry = rng.Normal() * 0.06;
  return style;
}

}  // namespace

double MinimumJerk(double s) {
  if (s <= 0.0) return 0.0;
  if (s >= 1.0) return 1.0;
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

double SmoothBump(double s) {
  if (s <= 0.0 || s >= 1.0) return 0.0;
  const double x = 4.0 * s * (1.0 - s);
  return x * x * x;
}

std::vector<double> SmoothCover(const std::vector<double>& values, int half_window) {
  const int count = static_cast<int>(values.size());
  std::vector<double> cover(values.size());
  const auto at = [&](const std::vector<double>& v, int f) {
    return v[static_cast<std::size_t>(std::clamp(f, 0, count - 1))];
  };
  for (int f = 0; f < count; ++f) {
    double highest = 0.0;
    for (int w = -2 * half_window; w <= 2 * half_window; ++w) highest = std::max(highest, at(values, f + w));
    cover[static_cast<std::size_t>(f)] = highest;
  }
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<double> before = cover;
    for (int f = 0; f < count; ++f) {
      double sum = 0.0;
      for (int w = -half_window; w <= half_window; ++w) sum += at(before, f + w);
      cover[static_cast<std::size_t>(f)] = sum / (2 * half_window + 1);
    }
  }
  return cover;
}

Stage::Stage(const Body& body, double fps, int frames, Rng rng) : body_(body), fps_(fps), frames_(frames), rng_(rng) {
  for (std::vector<double>& channel : values_) channel.assign(static_cast<std::size_t>(frames), 0.0);
  style_ = MakeStyle(body_, rng_);
}

int Stage::FrameAt(double time) const {
  return static_cast<int>(std::clamp(std::ceil(time * fps_), 0.0, static_cast<double>(frames_)));
}

double Stage::At(int channel, double time) const {
  const std::vector<double>& values = values_[static_cast<std::size_t>(channel)];
  const double frame = std::clamp(time * fps_, 0.0, static_cast<double>(frames_ - 1));
  const auto below = static_cast<std::size_t>(frame);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (frame - static_cast<double>(below)) * (values[above] - values[below]);
}

void Stage::Add(int channel, double value) {
  for (double& v : (*this)[channel]) v += value;
  final_[static_cast<std::size_t>(channel)] += value;
}

void Stage::MoveBy(int channel, double start, double duration, double change) {
  std::vector<double>& values = (*this)[channel];
  final_[static_cast<std::size_t>(channel)] += change;
  if (change == 0.0) return;
  const int end = FrameAt(start + duration);
  for (int f = FrameAt(start); f < end; ++f) {
    values[static_cast<std::size_t>(f)] += change * MinimumJerk((f / fps_ - start) / duration);
  }
  for (int f = end; f < frames_; ++f) values[static_cast<std::size_t>(f)] += change;
}

void Stage::MoveTo(int channel, double start, double duration, double value) {
  MoveBy(channel, start, duration, value - Final(channel));
}

void Stage::Bump(int channel, double start, double duration, double height) {
  std::vector<double>& values = (*this)[channel];
  const int end = FrameAt(start + duration);
  for (int f = FrameAt(start); f < end; ++f) {
    values[static_cast<std::size_t>(f)] += height * SmoothBump((f / fps_ - start) / duration);
  }
}

void Stage::Swing(int channel, double start, double duration, double hertz, double amplitude, double phase) {
  std::vector<double>& values = (*this)[channel];
  const double ease = std::min(0.5 * duration, 0.6 / hertz);
  const double waver_hertz = rng_.Uniform(0.1, 0.4);
  const double waver_phase = rng_.Uniform(0.0, 2 * kPi);
  const int end = FrameAt(start + duration);
  for (int f = FrameAt(start); f < end; ++f) {
    const double t = f / fps_ - start;
    const double envelope = MinimumJerk(t / ease) * MinimumJerk((duration - t) / ease);
    const double size = amplitude * (1.0 + 0.25 * std::sin(2 * kPi * waver_hertz * t + waver_phase));
    values[static_cast<std::size_t>(f)] += envelope * size * std::sin(2 * kPi * hertz * t + phase);
  }
}

void Stage::Waver(int channel, double amplitude, double hertz) {
  if (amplitude == 0.0) return;
  std::vector<double>& values = (*this)[channel];
  for (int wave = 0; wave < 3; ++wave) {
    // Slower waves have larger amplitudes, as in the sway of a standing person.
    const double frequency = hertz * rng_.Uniform(0.1, 1.0);
    const double size = amplitude * 0.8 * rng_.Normal() / (0.6 + frequency / hertz);
    // sin(a + b) from sin(a) by a rotation: one sine and cosine per wave instead of per frame.
    const double step = 2 * kPi * frequency / fps_;
    const double cosine = std::cos(step);
    const double sine = std::sin(step);
    const double phase = rng_.Uniform(0.0, 2 * kPi);
    double x = size * std::cos(phase);
    double y = size * std::sin(phase);
    for (double& value : values) {
      value += y;
      const double turned = x * cosine - y * sine;
      y = x * sine + y * cosine;
      x = turned;
    }
  }
}

void Stage::Quintic(int channel, const std::vector<Knot>& knots) {
  std::vector<double>& values = (*this)[channel];
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const Knot& a = knots[k];
    const Knot& b = knots[k + 1];
    const double d = b.time - a.time;
    const double c0 = a.value;
    const double c1 = a.velocity * d;
    const double c2 = a.acceleration * d * d / 2;
    const double rise = b.value - c0 - c1 - c2;
    const double slope = b.velocity * d - c1 - 2 * c2;
    const double bend = b.acceleration * d * d - 2 * c2;
    const double c3 = 10 * rise - 4 * slope + bend / 2;
    const double c4 = -15 * rise + 7 * slope - bend;
    const double c5 = 6 * rise - 3 * slope + bend / 2;
    const int end = FrameAt(b.time);
    for (int f = FrameAt(a.time); f < end; ++f) {
      const double s = (f / fps_ - a.time) / d;
      values[static_cast<std::size_t>(f)] += c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
    }
  }
  for (int f = FrameAt(knots.back().time); f < frames_; ++f) {
    values[static_cast<std::size_t>(f)] += knots.back().value;
  }
  final_[static_cast<std::size_t>(channel)] += knots.back().value;
}

void StandNaturally(Stage& stage) {
  const Style& style = stage.style();
  const double n = style.noise;
  stage.Add(kTrunkFlex, style.trunk_lean);
  stage.Add(kNeckFlex, style.head_pitch - 0.5 * style.trunk_lean);
  stage.Add(kPelvisZ, -stage.Tall(stage.Uniform(-0.001, 0.006)));
  for (const int channel : {kTrunkFlex, kTrunkSide, kTrunkTwist}) stage.Waver(channel, RadFromDeg(1.6) * n, 0.9);
  for (const int channel : {kNeckFlex, kNeckSide}) stage.Waver(channel, RadFromDeg(2.2) * n, 0.9);
  stage.Waver(kNeckTwist, RadFromDeg(4.0) * n, 0.7);
  stage.Waver(kPelvisPitch, RadFromDeg(1.2) * n, 0.8);
  stage.Waver(kPelvisRoll, RadFromDeg(0.8) * n, 0.8);
  stage.Waver(kPelvisZ, stage.Tall(0.002) * n, 1.0);
  stage.Waver(kSway, stage.Tall(0.005) * n, 0.5);
  stage.Waver(kSurge, stage.Tall(0.005) * n, 0.5);
  for (const int side : {kLeft, kRight}) {
    stage.Add(Of(kShoulderAbd, side), style.arm_carry);
    stage.Add(Of(kShoulderFlex, side), RadFromDeg(stage.Uniform(-5.0, 10.0)));
    stage.Add(Of(kShoulderTwist, side), RadFromDeg(stage.Uniform(0.0, 35.0)));
    stage.Add(Of(kElbow, side), style.elbow_carry * (1.0 + stage.Uniform(-0.3, 0.3)));
    stage.Add(Of(kShrug, side), RadFromDeg(stage.Uniform(-4.0, 3.0)));
    stage.Waver(Of(kShoulderFlex, side), RadFromDeg(2.5) * n, 1.0);
    stage.Waver(Of(kShoulderAbd, side), RadFromDeg(1.8) * n, 1.0);
    stage.Waver(Of(kShoulderTwist, side), RadFromDeg(4.0) * n, 1.0);
    stage.Waver(Of(kElbow, side), RadFromDeg(3.5) * n, 1.1);
    stage.Waver(Of(kShrug, side), RadFromDeg(1.2) * n, 0.7);
    stage.Waver(Of(kProtract, side), RadFromDeg(1.5) * n, 0.7);
    stage.Waver(Of(kLegTwist, side), RadFromDeg(1.5) * n, 0.7);
  }
}

void PlaceFeet(Stage& stage, double half_width) {
  const double yaw = stage.At(kPelvisYaw, 0.0);
  for (const int side : {kLeft, kRight}) {
    const double across = SideSign(side) * half_width;
    const double ahead = stage.Tall(stage.Uniform(-0.012, 0.006));
    stage.Add(Of(kFootX, side), stage.At(kPelvisX, 0.0) + std::cos(yaw) * ahead - std::sin(yaw) * across);
    stage.Add(Of(kFootY, side), stage.At(kPelvisY, 0.0) + std::sin(yaw) * ahead + std::cos(yaw) * across);
    stage.Add(Of(kFootYaw, side), yaw + SideSign(side) * stage.style().toe_out);
  }
}

void LookAround(Stage& stage, double from, double to, double every_seconds) {
  const double home_flex = stage.Final(kNeckFlex);
  double t = from + stage.Uniform(0.0, 1.0) * every_seconds;
  while (t < to) {
    const bool back = stage.Chance(0.35);
    const double twist = back ? 0.0 : RadFromDeg(stage.Uniform(-62.0, 62.0));
    const double duration = stage.Beat(0.5);
    stage.MoveTo(kNeckTwist, t, duration, 0.75 * twist);
    stage.MoveTo(kNeckFlex, t, duration, home_flex + (back ? 0.0 : RadFromDeg(stage.Uniform(-20.0, 28.0))));
    stage.MoveTo(kNeckSide, t, duration, back ? 0.0 : RadFromDeg(stage.Uniform(-14.0, 14.0)));
    stage.MoveBy(kTrunkTwist, t, duration * 1.2, 0.2 * twist);
    stage.MoveBy(kTrunkTwist, t + duration + 0.4, 0.9, -0.2 * twist);
    t += every_seconds * stage.Uniform(0.5, 1.6);
  }
}

}  // namespace canonpose
