#include "canonpose/evaluate/report.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/evaluate/evaluation.h"
#include "canonpose/evaluate/reference.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> kNames = {"Hip", "A", "B", "C", "D"};
const std::vector<float> kTruth = {0, 0, 0, 100, 0, 0, 0, 200, 0, 0, 0, 300, 50, 50, 50};

EvaluationReport Sample(const ReferenceKind& reference) {
  Evaluation evaluation(kNames, 0, {});
  std::vector<float> off = kTruth;
  off[4] += 40.0F;  // joint A, so that even the best alignment leaves an error
  evaluation.Add({"walk"}, kTruth.data(), kTruth.data());
  evaluation.Add({"run"}, off.data(), kTruth.data());
  std::vector<float> unknown(15, NAN);
  evaluation.Add({"run"}, unknown.data(), kTruth.data());
  evaluation.Add({"run"}, kTruth.data(), unknown.data());
  return evaluation.Finish(reference, "a.h5");
}

TEST(ReportTest, JsonHasTheKeysOfTheContract) {
  const nlohmann::json json = nlohmann::json::parse(ReportAsJson(Sample({"truth", {}})));
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["joints"], 5);
  EXPECT_THAT(json["protocol"].get<std::string>(), AllOf(HasSubstr("all-frames"), HasSubstr("root (Hip)")));
  EXPECT_GT(json["n_mpjpe_mm"].get<double>(), 1.0);
  EXPECT_GT(json["p_mpjpe_mm"].get<double>(), 1.0);
  EXPECT_EQ(json["pck150_percent"], 100.0);
  EXPECT_GT(json["auc_percent"].get<double>(), 50.0);
  EXPECT_GT(json["cps"].get<double>(), 200.0);
  EXPECT_EQ(json["reference"], "truth");
  EXPECT_FALSE(json.contains("reference_reprojection_error_px"));
  EXPECT_EQ(json["missing_predictions"], 1);
  EXPECT_EQ(json["unusable_truths"], 1);
  EXPECT_NEAR(json["depth_extent_ratio"].get<double>(), 1.0, 0.05);
  EXPECT_NEAR(json["per_sequence"]["walk"]["n_mpjpe_mm"].get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(json["per_sequence"]["run"]["p_mpjpe_mm"].get<double>(), 2.0 * json["p_mpjpe_mm"].get<double>(), 1e-9);
  EXPECT_EQ(json["per_joint"].size(), 5U);
  double sum = 0.0;
  for (const auto& [name, errors] : json["per_joint"].items()) sum += errors["n_mpjpe_mm"].get<double>();
  EXPECT_NEAR(sum / 5.0, json["n_mpjpe_mm"].get<double>(), 1e-9);
}

TEST(ReportTest, TableStatesProtocolAndTheReferencesOwnError) {
  const std::string table = ReportAsTable(Sample({"triangulated from the calibration", ReferenceError{13.7, 18.2}}));
  EXPECT_THAT(table, AllOf(HasSubstr("Protocol: all-frames"), HasSubstr("triangulated"), HasSubstr("13.7 px"),
                           HasSubstr("1 more were not predicted"), HasSubstr("walk")));
  EXPECT_THAT(ReportAsTable(Sample({"truth", {}})), Not(HasSubstr("reprojection")));
}

TEST(ReportTest, JointsAreLeftOutByName) {
  Evaluation evaluation(kNames, 0, {"a"});
  std::vector<float> off = kTruth;
  off[4] += 40.0F;
  evaluation.Add({"run"}, off.data(), kTruth.data());
  const EvaluationReport report = evaluation.Finish({"truth", {}}, "a.h5");
  EXPECT_NEAR(report.metrics.n_mpjpe_mm, 0.0, 1e-4);
  EXPECT_THAT(report.joints, ElementsAre("Hip", "B", "C", "D"));
  EXPECT_THAT(report.left_out_joints, ElementsAre("A"));
  EXPECT_THAT(report.protocol, HasSubstr("without A"));
  EXPECT_EQ(report.per_joint.size(), 4U);
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { Evaluation(kNames, 0, {"Tail"}); }), HasSubstr("Hip, A, B"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { Evaluation(kNames, 0, kNames); }), HasSubstr("all joints"));
}

TEST(ReportTest, NothingToEvaluateIsAnError) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [] {
                        (void)Evaluation(kNames, 0, {}).Finish({"truth", {}}, "a.h5");
                      }),
              HasSubstr("a.h5"));
}

// ---------------------------------------------------------------------------------------------------------- reference

/// Two cameras a right angle apart that see three points exactly.
Dataset TwoCameras() {
  Dataset dataset;
  dataset.skeleton = {"", {"Hip", "L", "R"}, {-1, 0, 0}, 0, {0, 2, 1}};
  Sequence sequence{"walk", "S1", 50.0, true, "S1", 1, {}};
  for (int c = 0; c < 2; ++c) {
    Camera camera;
    camera.K << 1000, 0, 500, 0, 1000, 500, 0, 0, 1;
    camera.distortion = {-0.05, 0.01, 0.001, 0.0};
    if (c == 1) camera.camera_from_world_rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    camera.camera_from_world_translation = {0, 0, 4000};
    CameraView view;
    view.name = c == 0 ? "a" : "b";
    view.image_size = {1000, 1000};
    view.calibration = {camera};
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(200, 300, 100), Eigen::Vector3d(-100, 50, 10)}) {
      const Eigen::Vector2d pixel = camera.Project(point);
      view.keypoints.insert(view.keypoints.end(), {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
      view.confidence.push_back(0.8F);
    }
    sequence.cameras.push_back(view);
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

TEST(ReferenceTest, TriangulatesIntoTheCamerasFrames) {
  const Dataset dataset = TwoCameras();
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_TRUE(reference.triangulated());
  const std::vector<float>& a = reference.sequences()[0].poses_in_camera[0];
  const std::vector<float>& b = reference.sequences()[0].poses_in_camera[1];
  EXPECT_NEAR(a[3], 200.0F, 0.05F);
  EXPECT_NEAR(a[4], 300.0F, 0.05F);
  EXPECT_NEAR(a[5], 4100.0F, 0.05F);
  EXPECT_NEAR(b[3], 100.0F, 0.05F);
  EXPECT_NEAR(b[5], 3800.0F, 0.05F);
  ReferenceSummary summary;
  summary.Add(reference);
  EXPECT_LT(summary.Kind().reprojection_px->median_px, 0.01);
  EXPECT_EQ(summary.Kind().description, "triangulated from the calibration");
}

TEST(ReferenceTest, AJointThatOneViewMissesIsUnknown) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[1].confidence[2] = 0.0F;
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_TRUE(std::isnan(reference.sequences()[0].poses_in_camera[0][6]));
  EXPECT_EQ(reference.reprojection_errors_px().size(), 4U) << "two joints in two views";
}

TEST(ReferenceTest, RaysThatAreNearlyParallelGiveNothing) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[1] = dataset.sequences[0].cameras[0];
  dataset.sequences[0].cameras[1].calibration[0].camera_from_world_translation.x() += 50.0;
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_TRUE(std::isnan(reference.sequences()[0].poses_in_camera[0][0]));
}

TEST(ReferenceTest, TruthGoesBeforeCalibration) {
  Dataset dataset = TwoCameras();
  dataset.sequences[0].cameras[0].truth.assign(9, 1.0F);
  const ReferencePoses reference(dataset, "a.h5");
  EXPECT_FALSE(reference.triangulated());
  EXPECT_EQ(reference.sequences()[0].poses_in_camera[0].front(), 1.0F);
  EXPECT_TRUE(reference.sequences()[0].poses_in_camera[1].empty());
}

TEST(ReferenceTest, NeitherIsAnError) {
  Dataset dataset = TwoCameras();
  for (CameraView& view : dataset.sequences[0].cameras) view.calibration.clear();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReferencePoses(dataset, "a.h5"); }),
              AllOf(HasSubstr("a.h5"), HasSubstr("`calibration`")));
}

}  // namespace
}  // namespace canonpose
