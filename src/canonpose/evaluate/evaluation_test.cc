#include "canonpose/evaluate/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::vector<std::string> kNames = {"Hip", "RHip", "RKnee", "LHip", "Head"};
const std::vector<float> kTruth = {0, 0, 0, 100, 0, 0, 0, 200, 0, 0, 0, 300, 50, 50, 50};

Protocol ByAction() {
  Protocol protocol;
  protocol.name = "by-action";
  protocol.weighting = Weighting::kActions;
  protocol.merge_takes = true;
  return protocol;
}

std::vector<float> OffBy(float mm) {
  std::vector<float> off = kTruth;
  off[4] += mm;  // RHip, so that even the best alignment leaves an error
  return off;
}

TEST(EvaluationTest, AJointThatIsFarWorseThanTheOthersIsNamed) {
  const std::vector<std::string> names = {"Hip", "RHip", "RKnee", "LHip", "LKnee", "Thorax", "Head", "LWrist"};
  const std::vector<float> truth = {0,   0,   0,  -130, 0,    0,  -135, 440,  20, 130,  0,   0,
                                    135, 440, 10, 0,    -490, 20, 0,    -690, 0,  -230, -30, -60};
  const auto warnings = [&](float wrist_mm) {
    std::vector<float> off = truth;
    for (std::size_t i = 0; i < off.size(); ++i)
      off[i] += static_cast<float>(i % 3) * 5.0F * (i % 2 == 0 ? 1.0F : -1.0F);
    off[21] += wrist_mm;
    Evaluation evaluation(names, 0, {});
    evaluation.Add({"a"}, off.data(), truth.data());
    return evaluation.Finish({"truth", {}}, "a.h5").warnings;
  };
  EXPECT_THAT(warnings(0.0F), IsEmpty());
  EXPECT_THAT(warnings(300.0F), ElementsAre(AllOf(HasSubstr("LWrist is "), HasSubstr("times as much"),
                                                  HasSubstr("`exclude_joints=LWrist`"))));
}

TEST(EvaluationTest, ActionsHaveEqualWeights) {
  Evaluation evaluation(kNames, 0, {}, ByAction());
  const std::vector<float> off = OffBy(40.0F);
  for (const char* take : {"Walk", "Walk 1", "Walk 2"})
    evaluation.Add({"a", "c", 0, take}, kTruth.data(), kTruth.data());
  evaluation.Add({"b", "c", 0, "Run"}, off.data(), kTruth.data());
  const EvaluationReport report = evaluation.Finish({"truth", {}}, "a.h5");
  ASSERT_EQ(report.per_action.size(), 2U);
  const double of_run_mm = report.per_action.at("Run").n_mpjpe_mm;
  EXPECT_GT(of_run_mm, 1.0);
  EXPECT_NEAR(report.per_action.at("Walk").n_mpjpe_mm, 0.0, 1e-9);
  EXPECT_NEAR(report.metrics.n_mpjpe_mm, of_run_mm / 2.0, 1e-9);
  ASSERT_TRUE(report.by_pose.has_value());
  EXPECT_NEAR(report.by_pose->n_mpjpe_mm, of_run_mm / 4.0, 1e-9);
  EXPECT_THAT(report.warnings, IsEmpty());
  EXPECT_THAT(report.protocol, AllOf(HasSubstr("means over actions"), HasSubstr("headline is N-MPJPE")));
  const nlohmann::json json = nlohmann::json::parse(ReportAsJson(report));
  EXPECT_EQ(json["protocol_name"], "by-action");
  EXPECT_EQ(json["by_pose"]["pck150_percent"], 100.0);
  EXPECT_EQ(json["per_action"].size(), 2U);
  EXPECT_EQ(json["cps_curve"].size(), 300U);
  EXPECT_EQ(json["pck_curve"].size(), 300U);
  EXPECT_THAT(ReportAsTable(report), AllOf(HasSubstr("by action"), HasSubstr("(mean over poses)")));
}

TEST(EvaluationTest, WithoutActionsPosesHaveEqualWeightsWithAWarning) {
  Evaluation evaluation(kNames, 0, {}, ByAction());
  evaluation.Add({"a", "c", 0, "Walk"}, kTruth.data(), kTruth.data());
  evaluation.Add({"b"}, OffBy(40.0F).data(), kTruth.data());
  const EvaluationReport report = evaluation.Finish({"truth", {}}, "a.h5");
  EXPECT_FALSE(report.by_pose.has_value());
  EXPECT_EQ(report.per_action.size(), 1U);
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("those of all poses")));
  EXPECT_THAT(report.protocol, AllOf(HasSubstr("means over all poses"), Not(HasSubstr("actions"))));
  EXPECT_THAT(ReportAsTable(report), HasSubstr("Warning: by-action takes means over actions"));
}

TEST(EvaluationTest, SequencesHaveEqualWeights) {
  Protocol protocol = ByAction();
  protocol.weighting = Weighting::kSequences;
  Evaluation evaluation(kNames, 0, {}, protocol);
  for (int i = 0; i < 3; ++i) evaluation.Add({"a"}, kTruth.data(), kTruth.data());
  evaluation.Add({"b"}, OffBy(40.0F).data(), kTruth.data());
  const EvaluationReport report = evaluation.Finish({"truth", {}}, "a.h5");
  EXPECT_NEAR(report.metrics.p_mpjpe_mm, report.per_sequence.at("b").p_mpjpe_mm / 2.0, 1e-9);
  EXPECT_THAT(report.protocol, HasSubstr("means over sequences"));
}

TEST(EvaluationTest, PckJointsAreFoundByNameOrPart) {
  Protocol protocol = ByAction();
  protocol.weighting = Weighting::kPoses;
  protocol.pck.joints = {{"neck", "thorax"}, {"head_top", "headtop"}, {"rhip"}, {"lhip"}};
  Evaluation evaluation(kNames, 0, {"LHip"}, protocol);
  evaluation.Add({"a"}, kTruth.data(), kTruth.data());
  const EvaluationReport report = evaluation.Finish({"truth", {}}, "a.h5");
  EXPECT_THAT(report.protocol, HasSubstr("PCK and AUC over 2 joints (RHip, Head)"));
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("neck, lhip")));
  EXPECT_THAT(report.left_out_joints, ElementsAre("LHip"));
}

TEST(EvaluationTest, FrameErrorsContainEvaluatedPoses) {
  Evaluation evaluation(kNames, 0, {});
  FrameErrors frame_errors;
  evaluation.KeepFrameErrors(&frame_errors);
  const std::vector<float> unknown(15, NAN);
  EXPECT_EQ(evaluation.Add({"a"}, unknown.data(), kTruth.data()).outcome, PoseOutcome::kPredictionMissing);
  EXPECT_EQ(evaluation.Add({"a"}, kTruth.data(), kTruth.data()).scale, 1.0);
  EXPECT_EQ(frame_errors.size(), 1U);
}

}  // namespace
}  // namespace canonpose
