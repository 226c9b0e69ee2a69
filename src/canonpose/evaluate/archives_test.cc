#include "canonpose/evaluate/archives.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/evaluate/report.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::Contains;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// Two poses of 16 joints, the second with the joint `moved` shifted by 1000 mm times `scale`.
void WritePoses(const std::filesystem::path& path, float scale, int moved, const std::vector<std::string>& joints) {
  std::vector<float> poses;
  for (int i = 0; i < 2 * 16; ++i) {
    const auto joint = static_cast<float>(i % 16);
    poses.insert(poses.end(), {scale * 50.0F * joint, scale * joint * joint, scale * (i % 3 == 0 ? 100.0F : -60.0F)});
  }
  if (moved >= 0) poses[static_cast<std::size_t>(3 * (16 + moved))] += 1000.0F * scale;
  NpzWriter writer(path);
  writer.Add("pose3d", poses, {2, 16, 3});
  if (!joints.empty()) writer.AddStrings("joints", joints);
  writer.Commit();
}

TEST(ArchivesTest, ScaleDoesNotMatter) {
  const TemporaryFolder folder;
  WritePoses(folder / "truth.npz", 1.0F, -1, {});
  WritePoses(folder / "predicted.npz", 0.001F, -1, {});
  const EvaluationReport report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", {});
  EXPECT_EQ(report.metrics.poses, 2);
  EXPECT_LT(report.metrics.n_mpjpe_mm, 0.01);
  EXPECT_NEAR(report.metrics.cps, 300.0, 0.1);
  EXPECT_EQ(report.joints.front(), "0");
  EXPECT_EQ(report.per_sequence.count("truth"), 1U);
}

TEST(ArchivesTest, TheRootComesFromTheNamesOrTheUser) {
  const TemporaryFolder folder;
  const std::vector<std::string> joints = FindSkeleton("canonpose-16")->joints;
  WritePoses(folder / "truth.npz", 1.0F, -1, joints);
  WritePoses(folder / "predicted.npz", 1.0F, 6, {});
  EvaluationReport report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", {});
  EXPECT_THAT(report.protocol, HasSubstr("root (root)"));
  EXPECT_LT(report.per_joint[6].second.n_mpjpe_mm, 1e-6) << "the root has no error of its own";
  ArchiveOptions options;
  options.root = 3;
  report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", options);
  EXPECT_GT(report.per_joint[6].second.n_mpjpe_mm, 100.0);
  options.root = 16;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] { EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", options); }),
              HasSubstr("0 to 15"));
}

TEST(ArchivesTest, RowsAndJointsAreChosen) {
  const TemporaryFolder folder;
  WritePoses(folder / "truth.npz", 1.0F, -1, {});
  WritePoses(folder / "predicted.npz", 1.0F, 5, {});
  ArchiveOptions options;
  options.frames = {0, 0};
  EvaluationReport report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", options);
  EXPECT_EQ(report.metrics.poses, 1);
  EXPECT_LT(report.metrics.n_mpjpe_mm, 1e-6);
  options.frames = {};
  options.left_out = {"5"};
  report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", options);
  EXPECT_LT(report.metrics.n_mpjpe_mm, 1e-6);
  options.frames = {2, 9};
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", options); }),
      HasSubstr("poses from 2 on"));
}

TEST(ArchivesTest, ArchivesThatDoNotMatchAreRefused) {
  const TemporaryFolder folder;
  std::vector<std::string> joints = FindSkeleton("canonpose-16")->joints;
  WritePoses(folder / "truth.npz", 1.0F, -1, joints);
  std::swap(joints[0], joints[3]);
  WritePoses(folder / "other.npz", 1.0F, -1, joints);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateArchives(folder / "other.npz", folder / "truth.npz", {}); }),
              HasSubstr("same order"));
  NpzWriter fewer(folder / "fewer.npz");
  fewer.Add("pose3d", std::vector<float>(48, 1.0F), {1, 16, 3});
  fewer.Commit();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateArchives(folder / "fewer.npz", folder / "truth.npz", {}); }),
              AllOf(HasSubstr("(2, 16, 3)"), HasSubstr("(1, 16, 3)")));
  NpzWriter flat(folder / "flat.npz");
  flat.Add("pose3d", std::vector<float>(48, 1.0F), {1, 48});
  flat.Commit();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadPoseArchive(folder / "flat.npz"); }), HasSubstr("(1, 48)"));
}

TEST(ArchivesTest, PosesThatAreNaNAreCountedAsMissing) {
  const TemporaryFolder folder;
  WritePoses(folder / "truth.npz", 1.0F, -1, {});
  PoseArchive poses = ReadPoseArchive(folder / "truth.npz");
  std::fill_n(poses.poses.begin(), 3 * 16, NAN);
  const auto write = [&](const char* name) {
    NpzWriter writer(folder / name);
    writer.Add("pose3d", poses.poses, {2, 16, 3});
    writer.Commit();
  };
  write("half.npz");
  const EvaluationReport report = EvaluateArchives(folder / "half.npz", folder / "truth.npz", {});
  EXPECT_EQ(report.metrics.poses, 1);
  EXPECT_EQ(report.missing_predictions, 1);
  EXPECT_THAT(ReportAsTable(report), HasSubstr("Poses: 1; 1 more were not predicted"));
  std::fill(poses.poses.begin(), poses.poses.end(), NAN);
  write("none.npz");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { EvaluateArchives(folder / "none.npz", folder / "truth.npz", {}); }),
              HasSubstr("none.npz"));
}

TEST(ArchivesTest, TruthInMetresIsReadAsSuch) {
  const TemporaryFolder folder;
  WritePoses(folder / "truth.npz", 0.001F, -1, {});
  WritePoses(folder / "predicted.npz", 1.0F, 5, {});
  const CollectedMessages messages;
  const EvaluationReport report = EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", {});
  EXPECT_THAT(messages.text(), HasSubstr("truth.npz: the truth is in metres"));
  EXPECT_GT(report.metrics.n_mpjpe_mm, 10.0);
}

TEST(ArchivesTest, PredictionsInAnotherFrameAreNamed) {
  const TemporaryFolder folder;
  WritePoses(folder / "truth.npz", 1.0F, -1, {});
  PoseArchive poses = ReadPoseArchive(folder / "truth.npz");
  for (std::size_t i = 0; i < poses.poses.size(); i += 3) {  // y up, and towards the camera
    poses.poses[i] *= -1.0F;
    poses.poses[i + 1] *= -1.0F;
  }
  NpzWriter writer(folder / "predicted.npz");
  writer.Add("pose3d", poses.poses, {2, 16, 3});
  writer.Commit();
  EXPECT_THAT(EvaluateArchives(folder / "predicted.npz", folder / "truth.npz", {}).warnings,
              Contains(HasSubstr("rotated by 180 degrees")));
  EXPECT_THAT(EvaluateArchives(folder / "truth.npz", folder / "truth.npz", {}).warnings, ::testing::IsEmpty());
}

}  // namespace
}  // namespace canonpose
