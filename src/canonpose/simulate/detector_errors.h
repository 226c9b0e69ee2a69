// The random processes behind a simulated detector's errors, frame by frame. Internal to simulate/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "canonpose/base/random.h"
#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/detector_tuning.h"
#include "canonpose/simulate/smooth_noise.h"

namespace canonpose {

/// Intervals of time in which something goes wrong. They start at random, at a rate that depends on circumstances, and
/// are drawn in continuous time, so that they affect the same fraction of frames at every frame rate.
class Stretches {
 public:
  /// `rate` is the maximum number of starts per second; each start happens with the probability passed to IsActive().
  Stretches(const tuning::Stretch& stretch, double rate, Rng& rng);
  /// Whether the frame at a time is in such an interval. Times must not decrease; the probability only matters where an
  /// interval may start.
  bool IsActive(double seconds, double chance, Rng& rng);
  /// True in the first frame of an interval.
  [[nodiscard]] bool has_just_begun() const { return has_just_begun_; }

 private:
  void DrawNext(Rng& rng);

  tuning::Stretch stretch_;
  double rate_;
  double begin_ = 0.0;
  double end_ = 0.0;
  double luck_ = 1.0;  ///< the interval happens if the probability exceeds this
  bool is_decided_ = false;
  bool happens_ = false;
  bool has_just_begun_ = false;
};

/// What a frame's errors depend on. K joints.
struct FrameView {
  std::array<int, 2> image_size{0, 0};
  double seconds = 0.0;
  double height_px = 0.0;               ///< of the person in the image
  double facing = 0.0;                  ///< cosine between the body's front and the camera; -1 is a back view
  std::vector<Eigen::Vector2d> pixels;  ///< exact; NaN behind the camera
  std::vector<std::uint8_t> hidden;     ///< by the body itself
  std::vector<double> speed;            ///< in the image, statures per second
};

/// What the detector finds, (K) each.
struct FrameDetections {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> confidence;
  std::vector<std::uint8_t> errors;
};

class ErrorProcess {
 public:
  ErrorProcess(const DetectorLayout& layout, const DetectorOptions& options, double fps, Rng& rng);
  /// The detections of the next frame.
  void Next(const FrameView& view, FrameDetections& found);

 private:
  struct Joint {
    Joint(const tuning::JointClass& joint_class, const DetectorOptions& options, double fps, Rng& noise_rng,
          Rng& outlier_rng, Rng& miss_rng);
    const tuning::JointClass* its_class;
    int mirror = 0;
    bool is_leg = false;
    SmoothNoise slow_x, slow_y;
    RoughNoise fast_x, fast_y;
    SmoothNoise scale;
    SmoothNoise occluded_x, occluded_y, pull;
    bool is_hidden = false;
    double hidden = 0.0;  ///< 0..1, rises and falls within kOcclusionRampSeconds
    Stretches outliers;
    Stretches misses;
    int outlier_joint = -1;                                    ///< the joint that it is mistaken for; -1: background
    Eigen::Vector2d outlier_offset = Eigen::Vector2d::Zero();  ///< from the joint, in heights
    RoughNoise confidence;
  };

  void AddNoise(const FrameView& view, FrameDetections& found);
  void AddOutliers(const FrameView& view, FrameDetections& found);
  void BeginOutlier(std::size_t joint);
  void AddSwaps(const FrameView& view, FrameDetections& found);
  /// Points that errors move out of the image end up at its edge.
  static void KeepInImage(const FrameView& view, FrameDetections& found);
  void AddConfidence(const FrameView& view, FrameDetections& found);
  void AddMisses(const FrameView& view, FrameDetections& found);

  DetectorOptions options_;
  double ramp_;
  // One stream for each kind of error, so that changing one option does not change the other errors.
  Rng noise_rng_, occlusion_rng_, outlier_rng_, swap_rng_, miss_rng_, missed_frame_rng_, confidence_rng_;
  SmoothNoise person_scale_;
  std::vector<Joint> joints_;
  Stretches leg_swaps_, body_swaps_, missed_frames_;
  std::vector<double> unswapped_error_;  ///< (K) heights, before swaps
  bool is_first_ = true;
};

}  // namespace canonpose
