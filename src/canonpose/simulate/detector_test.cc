#include "canonpose/simulate/detector.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/simulate/figure_testing.h"
#include "canonpose/simulate/smooth_noise.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using testing::StandingFigure;
using testing::WalkInCircle;

const DetectorLayout& Human36m() {
  static const DetectorLayout layout = MakeDetectorLayout(*FindSkeleton("h36m-17"));
  return layout;
}

std::vector<FilmingCamera> Film(const std::string& kind, const LandmarkTrack& track, double distortion = 0.0) {
  RigOptions options;
  options.kind = kind;
  options.distortion = distortion;
  return MakeRig(options, Rng(6))->Film(track, Rng(7));
}

const Camera& At(const FilmingCamera& camera, int frame) {
  return camera.cameras[camera.cameras.size() == 1 ? 0 : static_cast<std::size_t>(frame)];
}

Eigen::Vector2d Keypoint(const Detections& detections, std::size_t at) {
  return {detections.keypoints[2 * at], detections.keypoints[2 * at + 1]};
}

/// The detections of all cameras of a rig: fractions of joints by kind of error, and errors (in heights) of the joints
/// found.
struct Outcome {
  double Share(DetectionErrorKind kind) const {
    int count = 0;
    for (const std::uint8_t e : errors) count += (e & kind) != 0 ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(errors.size());
  }
  double MeanSquaredError() const {
    double sum = 0.0;
    for (const Eigen::Vector2d& o : offsets) sum += o.allFinite() ? o.squaredNorm() : 0.0;
    return sum / static_cast<double>(offsets.size());
  }
  std::vector<std::uint8_t> errors;
  std::vector<Eigen::Vector2d> offsets;
  std::vector<float> confidence;
};

Outcome RunDetector(const DetectorOptions& options, int frames = 2000, const std::string& kind = "studio",
                    std::uint64_t detector_seed = 1, double fps = 50.0) {
  const LandmarkTrack track = WalkInCircle(frames, fps);
  const std::vector<Eigen::Vector3d> truth = JointPositions(track, Human36m());
  Outcome outcome;
  std::uint64_t number = 0;
  for (const FilmingCamera& camera : Film(kind, track)) {
    const Detections found = Detect(track, camera, Human36m(), options, detector_seed, Rng(5, {number++}));
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto frame = static_cast<int>(i / 17);
      const double height = ImageHeightPx(At(camera, frame), &track.At(frame, 0));
      outcome.errors.push_back(found.errors[i]);
      outcome.confidence.push_back(found.confidence[i]);
      outcome.offsets.emplace_back((Keypoint(found, i) - At(camera, frame).Project(truth[i])) / height);
    }
  }
  return outcome;
}

/// All kinds of errors switched off.
DetectorOptions Nothing() {
  DetectorOptions options;
  options.jitter = options.occlusion = options.swaps = options.outliers = 0.0;
  options.missed_joints = options.missed_frames = options.confidence = 0.0;
  return options;
}

TEST(Detect, WithoutNoiseGivesExactProjections) {
  DetectorOptions exact;
  exact.noise = 0.0;
  const LandmarkTrack track = WalkInCircle(60, 25.0);
  for (const char* kind : {"studio", "ring", "ptz", "handheld"}) {
    for (const char* name : {"h36m-17", "body_25", "coco-17"}) {
      const DetectorLayout layout = MakeDetectorLayout(*FindSkeleton(name));
      const std::vector<Eigen::Vector3d> truth = JointPositions(track, layout);
      const std::size_t count = layout.from_landmarks.joints.size();
      for (const FilmingCamera& camera : Film(kind, track, 1.0)) {
        const Detections found = Detect(track, camera, layout, exact, 1, Rng(2));
        ASSERT_EQ(found.confidence.size(), truth.size());
        for (std::size_t i = 0; i < truth.size(); ++i) {
          const Eigen::Vector2d pixel = At(camera, static_cast<int>(i / count)).Project(truth[i]);
          if ((found.errors[i] & kOutsideImage) != 0) {
            const bool is_inside = pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera.image_size[0] &&
                                   pixel.y() < camera.image_size[1];
            EXPECT_FALSE(is_inside);
            continue;
          }
          ASSERT_EQ(found.keypoints[2 * i], static_cast<float>(pixel.x()));
          ASSERT_EQ(found.keypoints[2 * i + 1], static_cast<float>(pixel.y()));
          ASSERT_EQ(found.confidence[i], 1.0F);
          ASSERT_EQ(found.errors[i], 0);
        }
      }
    }
  }
}

TEST(Detect, ExactPointsLieOnTheRaysOfTheJoints) {
  DetectorOptions exact;
  exact.noise = 0.0;
  const LandmarkTrack track = WalkInCircle(20, 25.0);
  const std::vector<Eigen::Vector3d> truth = JointPositions(track, Human36m());
  for (const FilmingCamera& camera : Film("ring", track, 1.0)) {
    const Detections found = Detect(track, camera, Human36m(), exact, 1, Rng(2));
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (found.confidence[i] == 0.0F) continue;
      const Camera& now = camera.cameras[0];
      const Eigen::Vector2d ray = now.Undistort(Keypoint(found, i));
      const Eigen::Vector3d in_camera = now.InCamera(truth[i]);
      EXPECT_NEAR((ray - in_camera.head<2>() / in_camera.z()).norm(), 0.0, 1e-6);
    }
  }
}

TEST(Detect, PointsOutsideTheImageAreNotFound) {
  LandmarkTrack track = WalkInCircle(10, 25.0);
  const std::vector<FilmingCamera> cameras = Film("studio", track);
  const Eigen::Vector3d centre = -cameras[0].cameras[0].camera_from_world_rotation.transpose() *
                                 cameras[0].cameras[0].camera_from_world_translation;
  // Just behind the camera.
  for (Eigen::Vector3d& p : track.positions_mm) p += 1.2 * Eigen::Vector3d(centre.x(), centre.y(), 0.0);
  for (const double noise : {0.0, 1.0}) {
    DetectorOptions options;
    options.noise = noise;
    const Detections found = Detect(track, cameras[0], Human36m(), options, 1, Rng(1));
    for (std::size_t i = 0; i < found.confidence.size(); ++i) {
      EXPECT_TRUE(std::isnan(found.keypoints[2 * i]) && std::isnan(found.keypoints[2 * i + 1]));
      EXPECT_EQ(found.confidence[i], 0.0F);
      EXPECT_EQ(found.errors[i], kOutsideImage);
    }
  }
}

TEST(Detect, RepeatsBitForBit) {
  const LandmarkTrack track = WalkInCircle(200, 50.0);
  const FilmingCamera camera = Film("ptz", track)[1];
  DetectorOptions options;
  options.joint_offset = 1.0;
  options.sync_jitter = 1.0;
  const Detections a = Detect(track, camera, Human36m(), options, 1, Rng(9));
  const Detections b = Detect(track, camera, Human36m(), options, 1, Rng(9));
  const Detections c = Detect(track, camera, Human36m(), options, 1, Rng(10));
  EXPECT_EQ(std::memcmp(a.keypoints.data(), b.keypoints.data(), a.keypoints.size() * sizeof(float)), 0);
  EXPECT_EQ(a.confidence, b.confidence);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_NE(a.confidence, c.confidence);
}

TEST(Detect, EachStrengthAtZeroSwitchesItsKindOffAndMoreMeansMore) {
  struct Kind {
    double DetectorOptions::*strength;
    DetectionErrorKind kind;
    double least_growth;  ///< from 1 to 2
  };
  // kMissed counts missed joints and missed frames, so each is tested with the other switched off. Occlusion does not
  // grow.
  for (const Kind& kind :
       {Kind{&DetectorOptions::occlusion, kOccluded, 0.99}, Kind{&DetectorOptions::swaps, kSwapped, 1.4},
        Kind{&DetectorOptions::outliers, kOutlier, 1.5}, Kind{&DetectorOptions::missed_joints, kMissed, 1.5},
        Kind{&DetectorOptions::missed_frames, kMissed, 1.3}}) {
    DetectorOptions options;
    if (kind.kind == kMissed) options.missed_joints = options.missed_frames = 0.0;
    options.*kind.strength = 1.0;
    const double usual = RunDetector(options, 6000).Share(kind.kind);
    EXPECT_GT(usual, 0.002);
    options.*kind.strength = 2.0;
    EXPECT_GT(RunDetector(options, 6000).Share(kind.kind), kind.least_growth * usual);
    options.*kind.strength = 0.0;
    EXPECT_EQ(RunDetector(options).Share(kind.kind), 0.0);
  }
}

TEST(Detect, ChangingOneStrengthDoesNotChangeTheOtherErrors) {
  const Outcome usual = RunDetector(DetectorOptions{});
  for (const auto& [strength, kind] :
       {std::pair(&DetectorOptions::swaps, kSwapped), std::pair(&DetectorOptions::outliers, kOutlier),
        std::pair(&DetectorOptions::missed_joints, kMissed), std::pair(&DetectorOptions::missed_frames, kMissed)}) {
    DetectorOptions options;
    options.*strength = 0.0;
    const Outcome without = RunDetector(options);
    int changed = 0;
    for (std::size_t i = 0; i < usual.errors.size(); ++i) {
      changed += usual.errors[i] != without.errors[i] ? 1 : 0;
      if ((usual.errors[i] & kind) != 0 || (usual.errors[i] & kMissed) != 0) continue;
      EXPECT_EQ(usual.offsets[i], without.offsets[i]);
      EXPECT_EQ(usual.confidence[i], without.confidence[i]);
    }
    EXPECT_GT(changed, 100);
  }
}

TEST(Detect, AmplitudesGrowWithTheirStrengths) {
  DetectorOptions options = Nothing();
  EXPECT_EQ(RunDetector(options).Share(kOccluded), 0.0);
  // Keypoints are floats: a rounding error of 1e-4 px, with a person of hundreds of pixels.
  EXPECT_LT(RunDetector(options).MeanSquaredError(), 1e-12);
  options.jitter = 1.0;
  const double once = RunDetector(options).MeanSquaredError();
  EXPECT_GT(once, 1e-5);
  options.noise = 2.0;
  EXPECT_NEAR(RunDetector(options).MeanSquaredError() / once, 4.0, 0.05);
  options = Nothing();
  options.occlusion = 1.0;
  const double hidden = RunDetector(options).MeanSquaredError();
  EXPECT_GT(hidden, 1e-5);
  options.occlusion = 2.0;
  EXPECT_NEAR(RunDetector(options).MeanSquaredError() / hidden, 4.0, 0.1);
}

TEST(Detect, ErrorsScaleWithThePersonsSizeInTheImage) {
  DetectorOptions options = Nothing();
  options.jitter = 1.0;
  const LandmarkTrack track = WalkInCircle(2000, 50.0);
  FilmingCamera near = Film("studio", track)[0];
  FilmingCamera large = near;
  large.image_size = {3000, 3000};
  large.cameras[0].K.topRows<2>() *= 3.0;
  const Detections a = Detect(track, near, Human36m(), options, 1, Rng(1));
  const Detections b = Detect(track, large, Human36m(), options, 1, Rng(1));
  const auto exact = JointPositions(track, Human36m());
  for (std::size_t i = 0; i < exact.size(); i += 97) {
    const Eigen::Vector2d ea = Keypoint(a, i) - near.cameras[0].Project(exact[i]);
    const Eigen::Vector2d eb = Keypoint(b, i) - large.cameras[0].Project(exact[i]);
    EXPECT_NEAR((3.0 * ea - eb).norm(), 0.0, 0.01);
  }
}

TEST(Detect, HiddenJointsStayWrongFromFrameToFrame) {
  DetectorOptions options = Nothing();
  options.occlusion = 1.0;
  const Outcome outcome = RunDetector(options, 4000);
  // Correlation of the error of a hidden joint with that of the same joint 0.1 s later, also hidden.
  double both = 0.0;
  double square = 0.0;
  const std::size_t lag = 5 * 17;
  for (std::size_t i = 0; i + lag < outcome.offsets.size(); ++i) {
    if ((outcome.errors[i] & outcome.errors[i + lag] & kOccluded) == 0) continue;
    both += outcome.offsets[i].dot(outcome.offsets[i + lag]);
    square += outcome.offsets[i].squaredNorm();
  }
  EXPECT_GT(both / square, 0.6) << "white noise would have 0";
}

TEST(Detect, SwapsLegsMostlyInBackViews) {
  DetectorOptions options = Nothing();
  options.swaps = 3.0;
  const LandmarkTrack track = WalkInCircle(12000, 50.0);
  int back = 0;
  int front = 0;
  std::uint64_t number = 0;
  for (const FilmingCamera& camera : Film("studio", track)) {
    const Eigen::Vector3d centre =
        -camera.cameras[0].camera_from_world_rotation.transpose() * camera.cameras[0].camera_from_world_translation;
    const Detections found = Detect(track, camera, Human36m(), options, 1, Rng(3, {number++}));
    for (int t = 0; t < track.frame_count(); ++t) {
      const std::size_t at = static_cast<std::size_t>(t) * 17;
      if ((found.errors[at + kRKnee] & kSwapped) == 0) continue;
      EXPECT_NEAR((Keypoint(found, at + kRKnee) - camera.cameras[0].Project(track.At(t, kLKnee))).norm(), 0.0, 1e-3);
      EXPECT_EQ(found.errors[at + kSpine] & kSwapped, 0) << "joints on the midline have no counterpart";
      const Eigen::Vector3d forward = (track.At(t, kLHip) - track.At(t, kRHip)).cross(Eigen::Vector3d::UnitZ());
      ++((centre - track.At(t, kHip)).dot(forward) > 0.0 ? front : back);
    }
  }
  EXPECT_GT(front + back, 500);
  EXPECT_GT(back, 3 * front);
}

TEST(Detect, ConfidenceThatReflectsErrorsPerfectlyFallsWithThem) {
  DetectorOptions options;
  options.confidence = 0.0;
  const Outcome outcome = RunDetector(options, 500);
  std::vector<std::pair<double, float>> pairs;
  for (std::size_t i = 0; i < outcome.offsets.size(); ++i) {
    if (outcome.confidence[i] > 0.0F) pairs.emplace_back(outcome.offsets[i].norm(), outcome.confidence[i]);
  }
  std::sort(pairs.begin(), pairs.end());
  for (std::size_t i = 1; i < pairs.size(); ++i) EXPECT_LE(pairs[i].second, pairs[i - 1].second + 1e-4F);
  EXPECT_GT(pairs.front().second, 0.9F);
  EXPECT_LT(pairs.back().second, 0.5F);
}

TEST(Detect, SharesOfErrorsDoNotDependOnTheFrameRate) {
  const Outcome slow = RunDetector(DetectorOptions{}, 6000, "studio", 1, 5.0);
  const Outcome fast = RunDetector(DetectorOptions{}, 12000, "studio", 1, 50.0);
  for (const DetectionErrorKind kind : {kSwapped, kOutlier, kMissed}) {
    EXPECT_NEAR(slow.Share(kind) / fast.Share(kind), 1.0, 0.35) << static_cast<int>(kind);
  }
}

TEST(Detect, SystematicOffsetBelongsToTheDetector) {
  DetectorOptions options;
  options.noise = 0.0;
  options.joint_offset = 1.0;
  const Outcome one = RunDetector(options, 400, "studio", 1);
  const Outcome again = RunDetector(options, 400, "studio", 1);
  const Outcome other = RunDetector(options, 400, "studio", 2);
  EXPECT_EQ(one.offsets[3], again.offsets[3]);
  EXPECT_GT((one.offsets[1] - other.offsets[1]).norm(), 1e-3);
  const auto mean = [&](int joint) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double length = 0.0;
    int count = 0;
    for (std::size_t i = static_cast<std::size_t>(joint); i < one.offsets.size(); i += 17, ++count) {
      sum += one.offsets[i];
      length += one.offsets[i].norm();
    }
    return std::pair(Eigen::Vector2d(sum / count), length / count);
  };
  EXPECT_LT(mean(kRHip).first.y(), -0.01) << "hips are found higher, in all views";
  EXPECT_GT(mean(kRHip).second, 0.02);
  EXPECT_LT(mean(kRHip).second, 0.06);
  EXPECT_LT(mean(kRKnee).second, 0.04);
}

TEST(Detect, UnsynchronisedCamerasShowMovingJointsElsewhere) {
  // Stands still except for the right wrist, which rises at 1 m/s.
  LandmarkTrack track{"raise", "figure", 50.0, {}};
  for (int t = 0; t < 100; ++t) {
    auto figure = StandingFigure();
    figure[kRWrist].z() += 10.0 * t;
    track.positions_mm.insert(track.positions_mm.end(), figure.begin(), figure.end());
  }
  DetectorOptions options;
  options.noise = 0.0;
  options.sync_jitter = 2.0;
  const FilmingCamera camera = Film("studio", track)[0];
  const Detections found = Detect(track, camera, Human36m(), options, 1, Rng(12));
  const auto exact = JointPositions(track, Human36m());
  double late_frames = 0.0;
  for (int t = 30; t < 70; ++t) {
    const std::size_t at = static_cast<std::size_t>(t) * 17;
    for (std::size_t j = 0; j < 17; ++j) {
      const Eigen::Vector2d error = Keypoint(found, at + j) - camera.cameras[0].Project(exact[at + j]);
      if (j != kRWrist) {
        EXPECT_LT(error.norm(), 1e-3);
        continue;
      }
      const Eigen::Vector2d step =
          camera.cameras[0].Project(exact[at + 17 + j]) - camera.cameras[0].Project(exact[at + j]);
      const double late = error.dot(step) / step.squaredNorm();
      if (t > 30) {
        EXPECT_NEAR(late, late_frames, 0.1) << "the same for the whole clip";
      }
      late_frames = late;
    }
  }
  EXPECT_GT(std::abs(late_frames), 0.1);
}

TEST(DetectorOptions, RefusesInvalidValues) {
  for (const double value : {-1.0, 11.0, static_cast<double>(NAN)}) {
    DetectorOptions options;
    options.missed_joints = value;
    EXPECT_NE(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }).find("`missed_joints`"),
              std::string::npos);
  }
  DetectorOptions{}.Validate();
}

TEST(SmoothNoise, HasUnitVarianceFromTheFirstFrameAndTheRequestedCorrelation) {
  Rng rng(1);
  double first = 0.0;
  double last = 0.0;
  double together = 0.0;
  double rough = 0.0;
  constexpr int kRuns = 20000;
  for (int i = 0; i < kRuns; ++i) {
    SmoothNoise noise(0.2, 50.0, rng);
    const double begin = noise.value();
    first += begin * begin / kRuns;
    for (int t = 0; t < 9; ++t) noise.Next(rng);
    const double end = noise.Next(rng);
    last += end * end / kRuns;
    together += begin * end / kRuns;
    RoughNoise other(0.2, 50.0, rng);
    const double start = other.value();
    for (int t = 0; t < 10; ++t) other.Next(rng);
    rough += start * other.value() / kRuns;
  }
  EXPECT_NEAR(first, 1.0, 0.04);
  EXPECT_NEAR(last, 1.0, 0.04);
  EXPECT_NEAR(rough, std::exp(-1.0), 0.03);
  // Twice smoothed: (1 + t) exp(-t) for continuous time.
  EXPECT_NEAR(together, 2.0 * std::exp(-1.0), 0.04);
}

}  // namespace
}  // namespace canonpose
