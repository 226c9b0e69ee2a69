#include "canonpose/simulate/detector_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace canonpose {
namespace {

bool IsLeg(int landmark) {
  const tuning::JointClass* its_class = &tuning::ClassOf(landmark);
  return (its_class == &tuning::kHips && landmark != kHip) || its_class == &tuning::kKnees ||
         its_class == &tuning::kAnkles || its_class == &tuning::kToes;
}

/// Probability that left and right are swapped, relative to a back view.
double SwapChance(double facing) {
  if (facing < 0.0) return tuning::kSwapSideView + (1.0 - tuning::kSwapSideView) * std::min(1.0, -facing / 0.7);
  return tuning::kSwapSideView + (tuning::kSwapFrontView - tuning::kSwapSideView) * std::min(1.0, facing / 0.5);
}

/// The landmark of a joint; for a mean of several, the first one.
int LandmarkOf(const DetectorLayout& layout, std::size_t joint) {
  return layout.from_landmarks.joints[joint].sources.front();
}

}  // namespace

Stretches::Stretches(const tuning::Stretch& stretch, double rate, Rng& rng)
    : stretch_(stretch),
      rate_(std::min(rate, tuning::kMaxRate)),
      // Starts long enough before the clip that an interval may be in progress when the clip starts.
      end_(-2.0 * stretch.longest_seconds) {
  DrawNext(rng);
}

void Stretches::DrawNext(Rng& rng) {
  if (!(rate_ > 0.0)) {
    begin_ = end_ = std::numeric_limits<double>::infinity();
    return;
  }
  begin_ = end_ - std::log(1.0 - rng.Uniform()) / rate_;
  end_ = begin_ + rng.Uniform(stretch_.shortest_seconds, stretch_.longest_seconds);
  luck_ = rng.Uniform();
  is_decided_ = false;
}

bool Stretches::IsActive(double seconds, double chance, Rng& rng) {
  has_just_begun_ = false;
  while (end_ <= seconds) DrawNext(rng);
  if (seconds < begin_) return false;
  if (!is_decided_) {
    is_decided_ = true;
    happens_ = luck_ < chance;
    has_just_begun_ = happens_;
  }
  return happens_;
}

ErrorProcess::Joint::Joint(const tuning::JointClass& joint_class, const DetectorOptions& options, double fps,
                           Rng& noise_rng, Rng& outlier_rng, Rng& miss_rng)
    : its_class(&joint_class),
      slow_x(tuning::kSlowSeconds, fps, noise_rng),
      slow_y(tuning::kSlowSeconds, fps, noise_rng),
      fast_x(tuning::kFastSeconds, fps, noise_rng),
      fast_y(tuning::kFastSeconds, fps, noise_rng),
      scale(tuning::kScaleSeconds, fps, noise_rng),
      occluded_x(tuning::kOccludedSeconds, fps, noise_rng),
      occluded_y(tuning::kOccludedSeconds, fps, noise_rng),
      pull(tuning::kOccludedSeconds, fps, noise_rng),
      outliers(
          tuning::kOutlier,
          options.noise * options.outliers * tuning::kOutlier.rate * joint_class.outlier * tuning::kOutlierWhenOccluded,
          outlier_rng),
      misses(tuning::kMissedJoint,
             options.noise * options.missed_joints * tuning::kMissedJoint.rate * joint_class.missed *
                 tuning::kMissedWhenOccluded,
             miss_rng),
      confidence(tuning::kConfidenceSeconds, fps, noise_rng) {}

ErrorProcess::ErrorProcess(const DetectorLayout& layout, const DetectorOptions& options, double fps, Rng& rng)
    : options_(options),
      ramp_(1.0 - std::exp(-1.0 / (fps * tuning::kOcclusionRampSeconds))),
      noise_rng_(rng.Bits()),
      occlusion_rng_(rng.Bits()),
      outlier_rng_(rng.Bits()),
      swap_rng_(rng.Bits()),
      miss_rng_(rng.Bits()),
      missed_frame_rng_(rng.Bits()),
      confidence_rng_(rng.Bits()),
      person_scale_(tuning::kScaleSeconds, fps, noise_rng_),
      leg_swaps_(tuning::kLegSwap, options.noise * options.swaps * tuning::kLegSwap.rate, swap_rng_),
      body_swaps_(tuning::kBodySwap, options.noise * options.swaps * tuning::kBodySwap.rate, swap_rng_),
      missed_frames_(tuning::kMissedFrame, options.noise * options.missed_frames * tuning::kMissedFrame.rate,
                     missed_frame_rng_) {
  const Skeleton& target = layout.from_landmarks.target;
  for (std::size_t j = 0; j < target.joints.size(); ++j) {
    Rng own(rng.Bits());
    joints_.emplace_back(tuning::ClassOf(LandmarkOf(layout, j)), options, fps, own, outlier_rng_, miss_rng_);
    joints_.back().mirror = target.mirror[j];
    joints_.back().is_leg = IsLeg(LandmarkOf(layout, j));
  }
  unswapped_error_.resize(joints_.size());
}

void ErrorProcess::Next(const FrameView& view, FrameDetections& found) {
  found.pixels = view.pixels;
  found.errors.assign(joints_.size(), 0);
  found.confidence.assign(joints_.size(), 0.0);
  AddNoise(view, found);
  AddOutliers(view, found);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    unswapped_error_[j] = (found.pixels[j] - view.pixels[j]).norm() / view.height_px;
  }
  AddSwaps(view, found);
  KeepInImage(view, found);
  AddConfidence(view, found);
  AddMisses(view, found);
  is_first_ = false;
}

void ErrorProcess::AddNoise(const FrameView& view, FrameDetections& found) {
  const double jitter =
      options_.noise * options_.jitter * std::exp(tuning::kScaleOfPerson * person_scale_.Next(noise_rng_));
  const double occlusion = options_.noise * options_.occlusion;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const double scale = std::exp(tuning::kScaleOfJoint * joint.scale.Next(noise_rng_));
    const double blur = 1.0 + tuning::kBlur * std::min(view.speed[j], tuning::kMaxBlurSpeed);
    const Eigen::Vector2d slow(joint.slow_x.Next(noise_rng_), joint.slow_y.Next(noise_rng_));
    const Eigen::Vector2d fast(joint.fast_x.Next(noise_rng_), joint.fast_y.Next(noise_rng_));
    found.pixels[j] +=
        view.height_px * jitter * scale * blur * (joint.its_class->slow * slow + joint.its_class->fast * fast);
    joint.is_hidden = occlusion > 0.0 && view.hidden[j] != 0;
    joint.hidden += (is_first_ ? 1.0 : ramp_) * ((joint.is_hidden ? 1.0 : 0.0) - joint.hidden);
    const Eigen::Vector2d lost(joint.occluded_x.Next(occlusion_rng_), joint.occluded_y.Next(occlusion_rng_));
    const double pull = std::clamp(tuning::kPull + tuning::kPullSpread * joint.pull.Next(occlusion_rng_), 0.0, 1.0);
    if (joint.is_hidden) found.errors[j] |= kOccluded;
    if (!(occlusion > 0.0) || joint.hidden < 1e-3) continue;
    Eigen::Vector2d other = pull * (view.pixels[static_cast<std::size_t>(joint.mirror)] - view.pixels[j]);
    if (!other.allFinite()) other.setZero();
    const double length = other.norm() / view.height_px;
    if (length > tuning::kMaxPull) other *= tuning::kMaxPull / length;
    found.pixels[j] += occlusion * joint.hidden * (view.height_px * joint.its_class->occluded * scale * lost + other);
  }
}

void ErrorProcess::BeginOutlier(std::size_t j) {
  Joint& joint = joints_[j];
  const double where = outlier_rng_.Uniform();
  const double angle = outlier_rng_.Uniform(0.0, 2.0 * std::numbers::pi);
  const double distance = outlier_rng_.Uniform(tuning::kBackgroundNear, tuning::kBackgroundFar);
  const auto other = static_cast<int>(outlier_rng_.Index(joints_.size()));
  joint.outlier_joint = -1;
  joint.outlier_offset = distance * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  const bool has_mirror = joint.mirror != static_cast<int>(j);
  if (has_mirror && where < tuning::kOutlierToMirror) {
    joint.outlier_joint = joint.mirror;
  } else if (where < tuning::kOutlierToMirror + tuning::kOutlierToJoint && other != static_cast<int>(j)) {
    joint.outlier_joint = other;
  }
}

void ErrorProcess::AddOutliers(const FrameView& view, FrameDetections& found) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const double chance = joint.is_hidden ? 1.0 : 1.0 / tuning::kOutlierWhenOccluded;
    if (!joint.outliers.IsActive(view.seconds, chance, outlier_rng_)) continue;
    if (joint.outliers.has_just_begun()) BeginOutlier(j);
    const Eigen::Vector2d noise = found.pixels[j] - view.pixels[j];
    if (joint.outlier_joint >= 0) {
      const Eigen::Vector2d& there = view.pixels[static_cast<std::size_t>(joint.outlier_joint)];
      if (!there.allFinite()) continue;
      found.pixels[j] = there + noise;
    } else {
      found.pixels[j] = view.pixels[j] + view.height_px * joint.outlier_offset + noise;
    }
    found.errors[j] |= kOutlier;
  }
}

void ErrorProcess::AddSwaps(const FrameView& view, FrameDetections& found) {
  const double chance = SwapChance(view.facing);
  const bool legs = leg_swaps_.IsActive(view.seconds, chance, swap_rng_);
  const bool body = body_swaps_.IsActive(view.seconds, chance, swap_rng_);
  if (!legs && !body) return;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto mirror = static_cast<std::size_t>(joints_[j].mirror);
    if (mirror <= j || !(body || joints_[j].is_leg)) continue;
    if (!found.pixels[j].allFinite() || !found.pixels[mirror].allFinite()) continue;
    std::swap(found.pixels[j], found.pixels[mirror]);
    // The confidence stays with the peak that is found, so it does not reveal a swap.
    std::swap(found.errors[j], found.errors[mirror]);
    std::swap(unswapped_error_[j], unswapped_error_[mirror]);
    found.errors[j] |= kSwapped;
    found.errors[mirror] |= kSwapped;
  }
}

void ErrorProcess::KeepInImage(const FrameView& view, FrameDetections& found) {
  const Eigen::Vector2d last(view.image_size[0] - 1.0, view.image_size[1] - 1.0);
  for (Eigen::Vector2d& pixel : found.pixels) {
    if (pixel.allFinite()) pixel = pixel.cwiseMax(0.0).cwiseMin(last);
  }
}

void ErrorProcess::AddConfidence(const FrameView& view, FrameDetections& found) {
  const double noise = options_.noise * options_.confidence;
  // How much a swap deceives the detector itself: not at all where confidences reflect errors perfectly.
  const double deceived = std::min(1.0, noise);
  const auto hardness = [](double error) {
    return std::log((error + tuning::kConfidenceFloor) / tuning::kConfidenceTypical);
  };
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double slow = joints_[j].confidence.Next(confidence_rng_);
    const double fast = confidence_rng_.Normal();
    const double error = (found.pixels[j] - view.pixels[j]).norm() / view.height_px;
    const double seen = (1.0 - deceived) * hardness(error) + deceived * hardness(unswapped_error_[j]);
    const double logit = tuning::kConfidenceAtTypical - tuning::kConfidenceSlope * seen +
                         noise * (tuning::kConfidenceNoiseSlow * slow + tuning::kConfidenceNoiseFast * fast);
    found.confidence[j] = std::clamp(1.0 / (1.0 + std::exp(-logit)), 0.01, 1.0);
  }
}

void ErrorProcess::AddMisses(const FrameView& view, FrameDetections& found) {
  const bool all = missed_frames_.IsActive(view.seconds, 1.0, missed_frame_rng_);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const double chance = joints_[j].is_hidden ? 1.0 : 1.0 / tuning::kMissedWhenOccluded;
    const bool is_missed = joints_[j].misses.IsActive(view.seconds, chance, miss_rng_);
    if (is_missed || all) found.errors[j] |= kMissed;
  }
}

}  // namespace canonpose
