// Training on 3D poses that were solved from all views.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/puppet_testing.h"
#include "canonpose/train/trainer.h"
#include "canonpose/train/training_set.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::kJoints;
using testing::PuppetJob;
using testing::PuppetShow;
using testing::TemporaryFolder;

TEST(Distillation, SolvedPosesAreLearnedAsTrueOnesAre) {
  const TemporaryFolder folder;
  TrainJob truth = PuppetJob(folder.path(), "truth", "supervised");
  truth.options.epochs = 2;
  Train(truth);
  TrainJob solved = truth;
  solved.run_folder = folder / "solved";
  solved.options.supervision = Supervision::kSolved;
  for (CameraView& view : solved.datasets[0].sequences[0].cameras) {
    view.solved = view.truth;  // in another unit
    for (float& value : view.solved.positions()) value *= 0.25F;
    view.truth = {};
  }
  const TrainReport report = Train(solved);
  EXPECT_EQ(report.model.info.mirror.decision, "known from the solution");
  const ModelFile from_truth = ReadModelFile(folder / "truth");
  const ModelFile from_solved = ReadModelFile(folder / "solved");
  for (const auto& [name, array] : from_truth.parameters) {
    EXPECT_EQ(array.values, from_solved.parameters.at(name).values) << name;
  }

  // New views need cameras; what is resumed must have the same solution.
  solved.options.new_views = 0.5;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(solved); }), HasSubstr("solved cameras"));
  solved.options.new_views = 0.0;
  solved.resume = true;
  solved.datasets[0].sequences[0].cameras[0].solved.positions()[4] += 0.1F;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Train(solved); }), HasSubstr("fingerprint"));
}

TEST(Distillation, UncertainJointsCountLess) {
  Dataset dataset = PuppetShow(20, 2);
  Rng rng(1);
  for (CameraView& view : dataset.sequences[0].cameras) {
    view.solved = view.truth;
    view.solved.standard_deviation().assign(static_cast<std::size_t>(20 * kJoints), 0.02F);
    view.solved.standard_deviation()[3] = 0.06F;
    view.solved.standard_deviation()[4] = std::numeric_limits<float>::quiet_NaN();
  }
  const TrainingSplit split =
      MakeTrainingSplit({dataset}, 0.2, {TrainingTarget::kSolved, {}, /*uncertainty_weights=*/true});
  ASSERT_EQ(split.training.target_weight.size(), split.training.confidence.size());
  EXPECT_TRUE(split.validation.target_weight.empty());
  EXPECT_NEAR(split.training.target_weight[0], 0.5, 0.05);  // poses differ a little in size
  EXPECT_NEAR(split.training.target_weight[3] / split.training.target_weight[0], 0.2, 0.02);
  EXPECT_EQ(split.training.target_weight[4], 0.5F);
}

}  // namespace
}  // namespace canonpose
