#include "canonpose/solve/report.h"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/solve/exact_rig_testing.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MakeExactRig;
using ::testing::Not;

/// Frames 10 .. 29 of the truth could not be solved; frames 25 .. 29 one camera alone sees anyway.
struct HalfSolved {
  ExactRig rig = MakeExactRig();
  Solution solution;
  WindowsSummary windows;

  HalfSolved() {
    solution.estimate = rig.truth;
    solution.calibration_summary = {AdjustmentEnding::kConverged, "Function tolerance reached", 12, 50.0, 2.5};
    windows.windows = 4;
    windows.stopped_early = 3;
    windows.failed = {{0, 10, 20, "Residual and Jacobian evaluation failed"}};
    for (int n = 10; n < 30; ++n) {
      for (int j = 0; j < rig.capture.joint_count(); ++j) {
        solution.estimate.Joint(n, j).setConstant(std::nan(""));
        for (int v = 1; n >= 25 && v < rig.capture.view_count(); ++v) testing::Hide(rig.capture, n, v, j);
      }
    }
  }
};

nlohmann::json JsonOf(const CaptureReport& report) {
  return nlohmann::json::parse(SolveReport{{report}}.ToJson())["captures"][0];
}

TEST(Report, CountsFramesOfFailedWindowsAndSaysWhy) {
  const HalfSolved half;
  const CaptureReport report = MakeReport(half.rig.capture, half.solution, half.windows, "auto");
  EXPECT_EQ(report.frames, 40);
  EXPECT_EQ(report.frames_solved, 20);
  EXPECT_EQ(report.frames_in_failed_windows, 15);
  EXPECT_EQ(report.frames_too_few_views, 5);
  const std::string text = SolveReport{{report}}.ToText();
  EXPECT_THAT(text, HasSubstr("20 of 40 solved"));
  EXPECT_THAT(text, HasSubstr("15 frames are not solved: the bundle adjustment of 1 of 4 windows failed (Residual and "
                              "Jacobian evaluation failed)"));
}

TEST(Report, JsonHasTheAdjustments) {
  const HalfSolved half;
  const nlohmann::json json = JsonOf(MakeReport(half.rig.capture, half.solution, half.windows, "auto"));
  EXPECT_EQ(json["frames_in_failed_windows"], 15);
  EXPECT_EQ(json["calibration"]["ending"], "converged");
  EXPECT_EQ(json["calibration"]["reason"], "Function tolerance reached");
  EXPECT_EQ(json["calibration"]["iterations"], 12);
  EXPECT_EQ(json["calibration"]["initial_cost"], 50.0);
  EXPECT_EQ(json["calibration"]["final_cost"], 2.5);
  EXPECT_EQ(json["windows"]["count"], 4);
  EXPECT_EQ(json["windows"]["stopped_early"], 3);
  EXPECT_EQ(json["windows"]["failed"], 1);
  EXPECT_EQ(json["windows"]["failures"][0]["clip"], 0);
  EXPECT_EQ(json["windows"]["failures"][0]["first_frame"], 10);
  EXPECT_EQ(json["windows"]["failures"][0]["frames"], 20);
}

TEST(Report, SaysWhatTheLensesDo) {
  HalfSolved half;
  half.rig.capture.cameras[1].lens = {{-0.2, 0.05}};  // of half a diagonal of 707 px: 106 px
  half.rig.capture.cameras[2].lens = {{0.03, 0.0}};
  half.rig.capture.cameras[3].lens = {{0.001, 0.0}};
  const CaptureReport report = MakeReport(half.rig.capture, half.solution, half.windows, "auto");
  const std::string text = SolveReport{{report}}.ToText();
  EXPECT_THAT(text, HasSubstr("  camera1     the lens moves the corner of the image inwards by 106 px\n"));
  EXPECT_THAT(text, HasSubstr("  camera2     the lens moves the corner of the image outwards by 21 px\n"));
  EXPECT_THAT(text, Not(HasSubstr("camera0     the lens")));
  EXPECT_THAT(text, Not(HasSubstr("camera3     the lens")));  // less than a pixel
  EXPECT_NEAR(JsonOf(report)["cameras"][1]["corner_shift_px"], -0.15 * std::hypot(500.0, 500.0), 1e-9);
}

TEST(Report, OfACaptureThatFailedSaysHowFarItCame) {
  CaptureReport report;
  report.failure = "the cameras could not be found: nothing to start from";
  EXPECT_TRUE(JsonOf(report)["calibration"].is_null());
  EXPECT_TRUE(JsonOf(report)["windows"].is_null());
  report.calibration.emplace().reason = "nothing to start from";
  const nlohmann::json calibration = JsonOf(report)["calibration"];
  EXPECT_EQ(calibration["ending"], "failed");
  EXPECT_EQ(calibration["reason"], "nothing to start from");
  EXPECT_TRUE(calibration["final_cost"].is_null());
  EXPECT_THAT(SolveReport{{report}}.ToText(), HasSubstr("not solved: the cameras could not be found"));
}

TEST(Report, NamesMayBeAnyBytes) {
  CaptureReport report;
  report.name = "walk \xff";
  report.cameras.emplace_back().name = "cam \xc3";
  EXPECT_THAT(JsonOf(report)["name"].get<std::string>(), ::testing::StartsWith("walk "));
}

TEST(Report, IsQuietWhereNothingWentWrong) {
  const ExactRig rig = MakeExactRig();
  Solution solution;
  solution.estimate = rig.truth;
  WindowsSummary windows;
  windows.windows = windows.converged = 4;
  const CaptureReport report = MakeReport(rig.capture, solution, windows, "auto");
  EXPECT_EQ(report.frames_solved, 40);
  EXPECT_THAT(report.warnings, IsEmpty());
  EXPECT_THAT(SolveReport{{report}}.ToText(), Not(HasSubstr("adjustment")));
}

TEST(Report, WhoIsNotThereIsNotMissed) {
  ExactRig rig = MakeExactRig();
  Solution solution;
  solution.estimate = rig.truth;
  const auto report_without = [&](int frame, int views) {
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      solution.estimate.Joint(frame, j).setConstant(std::nan(""));
      for (int v = 0; v < views; ++v) testing::Hide(rig.capture, frame, v, j);
    }
    return MakeReport(rig.capture, solution, {}, "auto");
  };
  const CaptureReport away = report_without(5, 4);
  EXPECT_EQ(away.frames_too_few_views, 1);
  EXPECT_EQ(away.frames_unseen, 1);
  EXPECT_THAT(away.Trust(), Not(HasSubstr("have no pose")));
  const CaptureReport hidden = report_without(7, 3);
  EXPECT_EQ(hidden.frames_too_few_views, 2);
  EXPECT_EQ(hidden.frames_unseen, 1);
  EXPECT_THAT(hidden.Trust(), HasSubstr("1 of 39 frames have no pose"));
}

CaptureReport WithOutliers(const std::vector<double>& percents) {
  CaptureReport report;
  for (const double percent : percents) {
    CameraReport& camera = report.cameras.emplace_back();
    camera.name = fmt::format("cam{}", report.cameras.size());
    camera.outlier_percent = percent;
  }
  return report;
}

TEST(Report, CamerasOfWhichHalfContradictTheOthersSayNothing) {
  EXPECT_THAT(WithOutliers({3.0, 4.0, 21.0, 29.0}).Contradiction(),
              HasSubstr("21 % of cam3's keypoints, 29 % of cam4's keypoints do not fit"));
  EXPECT_THAT(WithOutliers({3.0, 4.0, 5.0, 29.0}).Contradiction(), IsEmpty());  // the other three agree
  EXPECT_THAT(WithOutliers({11.0, 11.0, 11.0}).Contradiction(), IsEmpty());
  EXPECT_THAT(WithOutliers({29.0, 29.0}).Contradiction(), IsEmpty());  // of two cameras none is in the minority
  CaptureReport poor = WithOutliers({4.0, 13.0, 5.0, 18.0});
  EXPECT_THAT(poor.Contradiction(), IsEmpty());
  poor.agrees_poorly = true;
  EXPECT_THAT(poor.Contradiction(), HasSubstr("13 % of cam2's keypoints, 18 % of cam4's keypoints do not fit"));
  CaptureReport one_left_out = WithOutliers({29.0, 29.0, 0.0});
  one_left_out.cameras[2].used = false;
  EXPECT_THAT(one_left_out.Contradiction(), IsEmpty());
}

}  // namespace
}  // namespace canonpose
