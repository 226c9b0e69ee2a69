#include "canonpose/train/starter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

// Machines differ in the last bits of their results, and some steps of training amplify that.
constexpr double kRelativeTolerance = 2e-3;

TEST(Starter, IsWhatItsRecipeMakes) {
  const StarterCard shipped = BuiltinStarterCard();
  const StarterRecipe recipe = StarterRecipe::Default();
  const ModelFile starter = BuiltinStarter();
  constexpr const char* kRemedy = "run scripts/make-starter and commit what it writes";
  ASSERT_EQ(shipped.recipe, recipe.ToJson()) << "the recipe changed: " << kRemedy;
  const StarterCard now = MakeStarterCard(recipe, starter);
  const auto expect_near = [&](double value, double expected, const char* what) {
    EXPECT_NEAR(value, expected, kRelativeTolerance * expected) << what << " changed: " << kRemedy;
  };
  ASSERT_EQ(now.people.size(), shipped.people.size());
  for (std::size_t i = 0; i < now.people.size(); ++i) expect_near(now.people[i], shipped.people[i], "the people");
  expect_near(now.brief_loss, shipped.brief_loss, "training");
  ASSERT_EQ(now.unseen_error.size(), shipped.unseen_error.size());
  for (std::size_t i = 0; i < now.unseen_error.size(); ++i) {
    expect_near(now.unseen_error[i], shipped.unseen_error[i], "the starter itself");
  }
}

TEST(Starter, WasTrainedAsItsRecipeSays) {
  const ModelInfo info = BuiltinStarter().info;
  EXPECT_TRUE(info.skeleton.SameJoints(StarterSkeleton()));
  EXPECT_EQ(info.options, StarterRecipe::Default().training.ToJson(/*only_what_changes_results=*/true));
  EXPECT_EQ(info.preset, "starter");
}

TEST(Starter, TheSameRecipeGivesTheSameBits) {
  StarterRecipe recipe = StarterRecipe::Default();
  recipe.layouts = {"", "coco-17"};
  recipe.capture.clips = 4;
  recipe.capture.frames = 10;
  recipe.training.width = 16;
  recipe.training.epochs = 2;
  const TemporaryFolder folder;
  ASSERT_TRUE(TrainStarter(recipe, folder / "a"));
  ASSERT_TRUE(TrainStarter(recipe, folder / "b"));
  const auto weights = [&](const char* name) {
    return ReadModelFile(folder / name).parameters.at("pose3d.weight").values;
  };
  EXPECT_EQ(weights("a"), weights("b"));
  recipe.capture.seed = 1;
  ASSERT_TRUE(TrainStarter(recipe, folder / "c"));
  EXPECT_NE(weights("a"), weights("c"));
}

// A random guess is wrong by 1.4, a mean pose by about 1, in units of the pose's norm spread over its joints.
TEST(Starter, KnowsUnseenPeopleWithEveryLayout) {
  const StarterCard card = BuiltinStarterCard();
  ASSERT_EQ(card.unseen_error.size(), StarterRecipe::Default().layouts.size());
  for (const double error : card.unseen_error) {
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, 0.06);
  }
}

TEST(Starter, KnowsPeopleOnly) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) EXPECT_TRUE(StarterKnows(skeleton)) << skeleton.name;
  for (const Skeleton& skeleton : BenchmarkSkeletons()) EXPECT_TRUE(StarterKnows(skeleton)) << skeleton.name;
  const Skeleton bird{"", {"crop", "beak", "left wing", "right wing"}, {-1, 0, 0, 0}, 0, {0, 1, 3, 2}};
  EXPECT_FALSE(StarterKnows(bird));
}

TEST(Starter, ADamagedCardIsRefused) {
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [] { StarterCard::FromJson("{}", "starter.json"); }),
              HasSubstr("starter.json"));
}

}  // namespace
}  // namespace canonpose
