// Random processes over time whose correlation is given in seconds, so that they do not depend on the frame rate.
#pragma once

#include <cmath>

#include "canonpose/base/random.h"

namespace canonpose {

/// First-order autoregression: mean 0, variance 1, correlation exp(-t / time constant). Rough, like tracking noise.
class RoughNoise {
 public:
  RoughNoise(double time_constant_seconds, double fps, Rng& rng)
      : keep_(std::exp(-1.0 / (fps * time_constant_seconds))),
        renew_(std::sqrt(1.0 - keep_ * keep_)),
        value_(rng.Normal()) {}

  [[nodiscard]] double value() const { return value_; }
  /// Advances by one frame.
  double Next(Rng& rng) {
    value_ = keep_ * value_ + renew_ * rng.Normal();
    return value_;
  }

 private:
  double keep_;
  double renew_;
  double value_;
};

/// RoughNoise smoothed once more with the same time constant: mean 0, variance 1. Like the motion of hands.
class SmoothNoise {
 public:
  SmoothNoise(double time_constant_seconds, double fps, Rng& rng)
      : input_(time_constant_seconds, fps, rng),
        keep_(std::exp(-1.0 / (fps * time_constant_seconds))),
        // The stationary variance of y' = keep y + (1 - keep) x over an x of variance 1 and correlation keep^|t|.
        scale_((1.0 + keep_) / std::sqrt(1.0 + keep_ * keep_)) {
    const double with_input = 1.0 / (1.0 + keep_);
    const double variance = 1.0 / (scale_ * scale_);
    state_ = with_input * input_.value() + std::sqrt(variance - with_input * with_input) * rng.Normal();
  }

  [[nodiscard]] double value() const { return scale_ * state_; }
  double Next(Rng& rng) {
    state_ = keep_ * state_ + (1.0 - keep_) * input_.Next(rng);
    return value();
  }

 private:
  RoughNoise input_;
  double keep_;
  double scale_;
  double state_ = 0.0;
};

}  // namespace canonpose
