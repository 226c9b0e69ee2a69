#include "canonpose/solve/solver.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/median.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/scene/stature.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/windows.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Four cameras of different focal lengths and heights, their principal points in the image centres.
constexpr const char* kRig = R"({"cameras": [
  {"name": "a", "image_size": [1000, 1000], "position_m": [4, 1, 1.5], "look_at_m": [0, 0, 1], "focal_px": 1100},
  {"name": "b", "image_size": [1280, 720], "position_m": [-1, 5, 2.5], "look_at_m": [0, 0, 0.9], "focal_px": 1000},
  {"name": "c", "image_size": [1920, 1080], "position_m": [-5, -1, 1], "look_at_m": [0, 0, 1], "focal_px": 1500},
  {"name": "d", "image_size": [1000, 1000], "position_m": [1, -4, 3], "look_at_m": [0, 0, 0.8], "focal_px": 900}]})";

Dataset ExactCapture() {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "rig.json") << kRig;
  SimulationOptions options = testing::SmallSimulation();
  options.rig.kind = folder / "rig.json";
  options.detector.noise = 0.0;
  options.activities = {Activity::kDance};
  options.clips = 1;
  return testing::Simulate(options).dataset;
}

/// Distances of `solved` from the truth in mm, both relative to the root, with one scale for the whole sequence.
std::vector<double> ErrorsMm(const Sequence& sequence, const Skeleton& skeleton) {
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  std::vector<Eigen::Vector3d> solved;
  std::vector<Eigen::Vector3d> truth;
  double product = 0.0;
  double squares = 0.0;
  for (const CameraView& view : sequence.cameras) {
    for (std::size_t i = 0; i < view.truth.positions().size() / 3; ++i) {
      const std::size_t root = i / joints * joints + static_cast<std::size_t>(skeleton.root);
      const auto at = [](const std::vector<float>& p, std::size_t k) {
        return Eigen::Vector3d(p[3 * k], p[3 * k + 1], p[3 * k + 2]);
      };
      const Eigen::Vector3d s = at(view.solved.positions(), i) - at(view.solved.positions(), root);
      const Eigen::Vector3d t = at(view.truth.positions(), i) - at(view.truth.positions(), root);
      if (!s.allFinite() || !t.allFinite()) continue;
      solved.push_back(s);
      truth.push_back(t);
      product += s.dot(t);
      squares += s.squaredNorm();
    }
  }
  std::vector<double> errors;
  for (std::size_t i = 0; i < solved.size(); ++i) errors.push_back((product / squares * solved[i] - truth[i]).norm());
  return errors;
}

TEST(Solve, ExactKeypointsOfAStaticRigGiveTheTruth) {
  Dataset dataset = ExactCapture();
  const SolveReport report = Solve(dataset, testing::NoisyTruth(dataset), {});
  ASSERT_THAT(report.captures, SizeIs(1));
  EXPECT_THAT(report.captures[0].failure, IsEmpty());
  EXPECT_EQ(report.captures[0].mirror, "kept");
  const std::vector<double> errors = ErrorsMm(dataset.sequences[0], dataset.skeleton);
  ASSERT_GT(errors.size(), 1000U);
  RecordProperty("largest_mm", std::to_string(*std::max_element(errors.begin(), errors.end())));
  EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 1.0);
  for (const CameraView& view : dataset.sequences[0].cameras) {
    ASSERT_THAT(view.solved_calibration, SizeIs(1));
    EXPECT_NEAR(view.solved_calibration[0].K(0, 0) / view.calibration[0].K(0, 0), 1.0, 1e-3) << view.name;
    EXPECT_EQ(view.solved.unit, LengthUnit::kBodyLengths);
    EXPECT_EQ(view.solved.coordinate_frame, (CoordinateFrame{CoordinateFrame::Kind::kCamera, view.name}));
    EXPECT_FALSE(LacksUncertainty(view.solved));
    for (int t = 0; t < view.solved.frame_count(); ++t) {
      for (int j = 0; j < view.solved.joint_count(); ++j) {
        const auto i = static_cast<std::size_t>(t * view.solved.joint_count() + j);
        ASSERT_EQ(view.solved.confidence()[i], view.solved.IsKnown(t, j) ? 1.0F : 0.0F);
      }
    }
  }
}

/// The same capture through lenses that distort more than a sports camera's.
Dataset DistortedCapture() {
  Dataset dataset = ExactCapture();
  for (CameraView& view : dataset.sequences[0].cameras) {
    view.calibration[0].distortion = {-0.3, 0.1, 0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < view.truth.positions().size() / 3; ++i) {
      if (!(view.confidence[i] > 0.0F)) continue;
      const float* p = &view.truth.positions()[3 * i];
      const Eigen::Vector2d pixel = view.calibration[0].ProjectFromCamera({p[0], p[1], p[2]});
      Eigen::Map<Eigen::Vector2f>(&view.keypoints[2 * i]) = pixel.cast<float>();
    }
  }
  return dataset;
}

TEST(Solve, FindsHowLensesDistort) {
  Dataset dataset = DistortedCapture();
  const StartPoses start = testing::NoisyTruth(dataset);
  Dataset pinhole = dataset;
  SolveOptions without;
  without.distortion = "none";
  Solve(pinhole, start, without);
  const SolveReport report = Solve(dataset, start, {});
  EXPECT_THAT(report.ToText(), HasSubstr("  a           the lens moves the corner of the image inwards by "));
  const double pinhole_mm = Median(ErrorsMm(pinhole.sequences[0], pinhole.skeleton));
  const double found_mm = Median(ErrorsMm(dataset.sequences[0], dataset.skeleton));
  EXPECT_GT(pinhole_mm, 2.0);
  EXPECT_LT(found_mm, 0.2 * pinhole_mm);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(pinhole.sequences[0].cameras[v].solved_calibration[0].distortion, (std::array<double, 5>{}));
    const CameraView& view = dataset.sequences[0].cameras[v];
    ASSERT_THAT(view.solved_calibration, SizeIs(1));
    const Camera& solved = view.solved_calibration[0];
    EXPECT_NEAR(solved.K(0, 0) / view.calibration[0].K(0, 0), 1.0, 0.01) << view.name;
    EXPECT_NEAR(solved.distortion[0], -0.3, 0.1) << view.name;
    // The solved poses are where the solved cameras show the keypoints.
    std::vector<double> errors_px;
    for (std::size_t i = 0; i < view.solved.positions().size() / 3; ++i) {
      const float* p = &view.solved.positions()[3 * i];
      const Eigen::Vector2d keypoint = Eigen::Map<const Eigen::Vector2f>(&view.keypoints[2 * i]).cast<double>();
      const double error_px = (solved.ProjectFromCamera({p[0], p[1], p[2]}) - keypoint).norm();
      if (std::isfinite(error_px)) errors_px.push_back(error_px);
    }
    EXPECT_LT(Median(errors_px), 0.5) << view.name;
  }
}

TEST(Solve, SameLensNamesCamerasOfTheData) {
  Dataset dataset = ExactCapture();
  const auto error_of = [&](std::vector<std::vector<std::string>> same_lens) {
    SolveOptions options;
    options.same_lens = std::move(same_lens);
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { options.RequireSizesOf(dataset); });
  };
  EXPECT_THAT(error_of({{"a", "nobody"}}), AllOf(HasSubstr("`same_lens`"), HasSubstr("nobody")));
  EXPECT_THAT(error_of({{"a"}}), HasSubstr("two cameras or more"));
  EXPECT_THAT(error_of({{"a", "b"}, {"c", "a"}}), HasSubstr("a twice"));
  SolveOptions options;
  options.same_lens = {{"all"}};
  options.RequireSizesOf(dataset);
  options.distortion = "fisheye";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { options.Validate(); }), HasSubstr("auto or none"));
}

TEST(Solve, AHeightGivesMillimetresInAnUprightWorld) {
  Dataset dataset = ExactCapture();
  SolveOptions options;
  options.measures.heights = {{"", EstimateStature(dataset.sequences[0].cameras[0].truth)->stature}};
  const SolveReport report = Solve(dataset, testing::NoisyTruth(dataset), options);
  const CaptureReport& capture = report.captures[0];
  EXPECT_EQ(capture.unit, LengthUnit::kMillimetres);
  EXPECT_THAT(capture.world.scale.source, HasSubstr("the height given"));
  EXPECT_THAT(report.ToText(), AllOf(HasSubstr("  up          within "), HasSubstr("  floor       within "),
                                     HasSubstr("  scale       millimetres within 2.0 %")));
  EXPECT_THAT(report.ToJson(), HasSubstr("\"unit\": \"mm\""));
  for (const CameraView& view : dataset.sequences[0].cameras) {
    EXPECT_EQ(view.solved.unit, LengthUnit::kMillimetres);
    // Up and the height above the floor, in the camera's frame and at its centre, are the same in both worlds.
    const Camera& solved = view.solved_calibration[0];
    const Camera& truth = view.calibration[0];
    EXPECT_GT(solved.camera_from_world_rotation.col(2).dot(truth.camera_from_world_rotation.col(2)),
              std::cos(RadFromDeg(1.5)));
    const auto height = [](const Camera& camera) {
      return -camera.camera_from_world_rotation.col(2).dot(camera.camera_from_world_translation);
    };
    EXPECT_NEAR(height(solved), height(truth), 120.0);  // 5 m away, an angle of 1 degree is 87 mm
    for (int t = 0; t < view.solved.frame_count(); t += 20) {
      EXPECT_LT((view.solved.PoseAt(t) - view.truth.PoseAt(t)).rowwise().norm().maxCoeff(), 10.0F) << view.name;
    }
  }
}

TEST(Solve, MeasuresMustBeOfWhatTheDataShow) {
  Dataset dataset = ExactCapture();
  const StartPoses start = testing::NoisyTruth(dataset);
  SolveOptions options;
  options.measures.heights = {{"nobody", 1750.0}};
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Solve(dataset, start, options); }), HasSubstr("nobody"));
  options.calibrated_scale = true;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Solve(dataset, start, options); }), HasSubstr("give one"));
  options.measures.heights.clear();
  for (CameraView& view : dataset.sequences[0].cameras) view.calibration.clear();
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Solve(dataset, start, options); }),
              HasSubstr("with a calibration, found none"));
}

/// The mirror of the start's poses in depth.
StartPoses Mirrored(StartPoses start) {
  for (PoseSequence& view : start.sequences[0]) {
    for (int t = 0; t < view.frame_count(); ++t) view.PoseAt(t).col(2) *= -1.0F;
  }
  return start;
}

TEST(Solve, TheMirrorOfTheStartIsFound) {
  Dataset dataset = ExactCapture();
  const StartPoses start = Mirrored(testing::NoisyTruth(dataset));
  const SolveReport report = Solve(dataset, start, {});
  EXPECT_EQ(report.captures[0].mirror, "flipped");
  EXPECT_LT(Median(ErrorsMm(dataset.sequences[0], dataset.skeleton)), 1.0);
}

Dataset ExactHandheldCapture() {
  SimulationOptions options = testing::SmallSimulation();
  options.rig.kind = "handheld";
  options.detector.noise = 0.0;
  options.clips = 1;
  options.seconds = 4.0;
  return testing::Simulate(options).dataset;
}

TEST(Solve, AnUndecidedMirrorIsAGuessUnlessTheStartKnowsIt) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  options.seconds = 3.0;
  options.rig.distance_m = 300.0;  // no perspective
  Dataset dataset = testing::Simulate(options).dataset;
  StartPoses start = testing::NoisyTruth(dataset);
  SolveReport report = Solve(dataset, start, {});
  ASSERT_THAT(report.captures[0].mirror, HasSubstr("undecided"));
  EXPECT_FALSE(report.captures[0].mirror_is_a_guess);
  EXPECT_EQ(report.Doubt(), "");
  start.knows_depth_sign = false;
  report = Solve(dataset, start, {});
  EXPECT_TRUE(report.captures[0].mirror_is_a_guess);
  EXPECT_THAT(report.Doubt(), AllOf(HasSubstr("could not be decided for " + report.captures[0].name),
                                    HasSubstr("`mirror=keep`"), HasSubstr("`mirror=flip`")));
  EXPECT_THAT(report.ToJson(), HasSubstr("\"mirror_is_a_guess\": true"));
  SolveOptions by_request;
  by_request.mirror = "keep";
  EXPECT_EQ(Solve(dataset, start, by_request).Doubt(), "");
}

TEST(Solve, SaysWhatItTriesWhereACameraDoesNotFit) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = testing::SmallSimulation();
  options.activities = {Activity::kGesture};
  options.clips = 1;
  options.seconds = 10.0;
  Dataset dataset = testing::Simulate(options).dataset;
  options.activities = {Activity::kReach};
  options.seed = 6;
  dataset.sequences[0].cameras[3] = testing::Simulate(options).dataset.sequences[0].cameras[3];  // somebody else
  const StartPoses start = testing::NoisyTruth(dataset);
  std::set<std::string> details;
  Callbacks callbacks;
  callbacks.progress = [&](const ProgressState& state) { details.insert(state.detail); };
  const CallbackScope scope(callbacks);
  Solve(dataset, start, {});
  EXPECT_GT(std::ranges::count_if(details, [](const std::string& text) { return text.find("trial") != text.npos; }), 1);
}

TEST(Solve, TheMirrorOfTheStartIsFoundWithMovingCameras) {
  Dataset dataset = ExactHandheldCapture();
  const SolveReport report = Solve(dataset, Mirrored(testing::NoisyTruth(dataset)), {});
  EXPECT_EQ(report.captures[0].mirror, "flipped");
  EXPECT_LT(Median(ErrorsMm(dataset.sequences[0], dataset.skeleton)), 25.0);
}

TEST(Solve, MovingCamerasNearTheTruth) {
  Dataset dataset = ExactHandheldCapture();
  const SolveReport report = Solve(dataset, testing::NoisyTruth(dataset), {});
  EXPECT_THAT(report.captures[0].failure, IsEmpty());
  EXPECT_LT(Median(ErrorsMm(dataset.sequences[0], dataset.skeleton)), 25.0);
}

bool SameBits(const Dataset& a, const Dataset& b) {
  for (std::size_t s = 0; s < a.sequences.size(); ++s) {
    for (std::size_t c = 0; c < a.sequences[s].cameras.size(); ++c) {
      const std::vector<float>& x = a.sequences[s].cameras[c].solved.positions();
      const std::vector<float>& y = b.sequences[s].cameras[c].solved.positions();
      if (x.size() != y.size() || std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) != 0) return false;
    }
  }
  return true;
}

TEST(Solve, TheNumberOfThreadsDoesNotMatter) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  for (const char* rig : {"studio", "ptz"}) {
    SimulationOptions options = testing::SmallSimulation();
    options.rig.kind = rig;
    options.rig.cameras = 3;
    options.clips = 1;
    options.seconds = 2.0;
    Dataset one = testing::Simulate(options).dataset;
    Dataset three = one;
    SolveOptions solve;
    solve.window_frames = 20;
    solve.threads = 1;
    Solve(one, testing::NoisyTruth(one), solve);
    solve.threads = 3;
    Solve(three, testing::NoisyTruth(three), solve);
    EXPECT_TRUE(one.HasSolved());
    EXPECT_TRUE(SameBits(one, three)) << rig;
  }
}

TEST(Solve, WindowsGiveWhatOneLargeWindowGives) {
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  Dataset small = testing::Simulate(options).dataset;
  Dataset large = small;
  SolveOptions solve;
  solve.window_frames = 40;
  Solve(small, testing::NoisyTruth(small), solve);
  solve.window_frames = 1000;
  Solve(large, testing::NoisyTruth(large), solve);
  std::vector<double> differences;
  for (std::size_t c = 0; c < small.sequences[0].cameras.size(); ++c) {
    const std::vector<float>& x = small.sequences[0].cameras[c].solved.positions();
    const std::vector<float>& y = large.sequences[0].cameras[c].solved.positions();
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::isfinite(x[i])) differences.push_back(std::abs(x[i] - y[i]));
    }
  }
  std::sort(differences.begin(), differences.end());
  // The unit is about 4.5 m; keypoints are off by about 4e-3.
  EXPECT_LT(differences[differences.size() / 2], 5e-5);
  EXPECT_LT(differences[differences.size() * 99 / 100], 5e-4);
}

/// Calls change(view, i) for every keypoint i of some joints in some cameras.
template <typename Change>
void ChangeKeypoints(const std::vector<std::string>& joints, const std::vector<std::size_t>& cameras, Dataset& dataset,
                     Change&& change) {
  for (const std::size_t c : cameras) {
    CameraView& view = dataset.sequences[0].cameras[c];
    for (std::size_t i = 0; i < view.confidence.size(); ++i) {
      const std::string& name = dataset.skeleton.joints[i % dataset.skeleton.joints.size()];
      if (std::ranges::find(joints, name) != joints.end()) change(view, i);
    }
  }
}

/// What a detector does that always writes all joints: joints that it does not see are anywhere, with low confidence.
void Invent(const std::vector<std::string>& joints, const std::vector<std::size_t>& cameras, Dataset& dataset) {
  Rng rng(5);
  ChangeKeypoints(joints, cameras, dataset, [&](CameraView& view, std::size_t i) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto middle = static_cast<double>(view.image_size[axis]) / 2.0;
      view.keypoints[2 * i + axis] = static_cast<float>(middle + 150.0 * rng.Normal());
    }
    view.confidence[i] = static_cast<float>(rng.Uniform(0.05, 0.2));
  });
}

void HideJoints(const std::vector<std::string>& joints, const std::vector<std::size_t>& cameras, Dataset& dataset) {
  ChangeKeypoints(joints, cameras, dataset, [](CameraView& view, std::size_t i) {
    view.keypoints[2 * i] = view.keypoints[2 * i + 1] = std::nanf("");
    view.confidence[i] = 0.0F;
  });
}

double MeanErrorMm(const Dataset& dataset) {
  const std::vector<double> errors = ErrorsMm(dataset.sequences[0], dataset.skeleton);
  return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
}

TEST(Solve, AnInventedLimbCostsNoMoreThanAHiddenOne) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  Dataset hidden = testing::Simulate(options).dataset;
  const StartPoses start = testing::NoisyTruth(hidden);
  Dataset invented = hidden;
  HideJoints({"LElbow", "LWrist"}, {0, 1}, hidden);
  Invent({"LElbow", "LWrist"}, {0, 1}, invented);
  Solve(hidden, start, {});
  Solve(invented, start, {});
  EXPECT_LT(MeanErrorMm(invented), 1.05 * MeanErrorMm(hidden));
}

TEST(Solve, AJointThatIsInventedEverywhereIsMissing) {
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  options.detector.swaps = 0.0;  // corrected, they make the right wrist the left one
  Dataset dataset = testing::Simulate(options).dataset;
  Invent({"LWrist"}, {0, 1, 2, 3}, dataset);
  Solve(dataset, testing::NoisyTruth(dataset), {});
  const auto wrist =
      static_cast<int>(std::ranges::find(dataset.skeleton.joints, "LWrist") - dataset.skeleton.joints.begin());
  for (const CameraView& view : dataset.sequences[0].cameras) {
    int known = 0;
    for (int t = 0; t < view.solved.frame_count(); ++t) {
      known += view.solved.IsKnown(t, wrist) ? 1 : 0;
      EXPECT_TRUE(view.solved.IsKnown(t, wrist + 1)) << t;
    }
    EXPECT_EQ(known, 0) << view.name;
  }
}

/// Delays a camera: its frame n becomes what its frame n - frames was.
void Delay(CameraView& view, int joints, int frames) {
  const auto delay = [&](std::vector<float>& values, std::size_t width, float none) {
    values.insert(values.begin(), width * static_cast<std::size_t>(joints * frames), none);
    values.resize(values.size() - width * static_cast<std::size_t>(joints * frames));
  };
  delay(view.keypoints, 2, std::nanf(""));
  delay(view.confidence, 1, 0.0F);
  delay(view.truth.positions(), 3, std::nanf(""));
}

TEST(Solve, ADelayedCameraIsSolvedAtItsOwnFrames) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  options.seconds = 12.0;
  Dataset delayed = testing::Simulate(options).dataset;
  Delay(delayed.sequences[0].cameras[2], delayed.skeleton.joint_count(), 5);
  const std::vector<float> keypoints = delayed.sequences[0].cameras[2].keypoints;
  SolveOptions solve;
  solve.mirror = "keep";
  solve.calibration_frames = 150;
  const SolveReport report = Solve(delayed, testing::NoisyTruth(delayed), solve);
  ASSERT_THAT(report.captures[0].offsets, SizeIs(1));
  EXPECT_EQ(report.captures[0].offsets[0].camera, delayed.sequences[0].cameras[2].name);
  EXPECT_EQ(report.captures[0].offsets[0].frames, -5);
  EXPECT_THAT(report.ToText(), HasSubstr("5 frames later"));
  EXPECT_EQ(
      std::memcmp(keypoints.data(), delayed.sequences[0].cameras[2].keypoints.data(), keypoints.size() * sizeof(float)),
      0);
  // The truth was delayed with the keypoints. Without a delay the median is 22 mm.
  EXPECT_LT(Median(ErrorsMm(delayed.sequences[0], delayed.skeleton)), 24.0);
}

}  // namespace
}  // namespace canonpose
