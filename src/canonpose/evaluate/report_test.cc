#include "canonpose/evaluate/report.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/evaluate/evaluation.h"

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

TEST(ReportTest, AdviceOnMirroredPosesComesAfterADoubtfulReference) {
  EvaluationReport report = Sample({"truth", {}});
  report.mirror_advice = "train again with `mirror` flip";
  EXPECT_THAT(ReportAsTable(report), Not(HasSubstr("train again")));
  report.mirrored = report.metrics.poses;
  EXPECT_THAT(ReportAsTable(report), HasSubstr("Front and back are exchanged: train again with `mirror` flip."));
  report.reference_is_doubtful = true;
  EXPECT_THAT(ReportAsTable(report), AllOf(HasSubstr("Look at the calibration first"), Not(HasSubstr("train again"))));
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

}  // namespace
}  // namespace canonpose
