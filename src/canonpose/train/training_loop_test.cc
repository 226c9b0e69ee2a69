#include "canonpose/train/training_loop.h"

#include <limits>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// Moves x towards 3, five steps per epoch, and records which of its functions are called.
class Toy : public TrainingTask {
 public:
  explicit Toy(std::int64_t steps) : steps_(steps) {}

  LoopState& state() override { return state_; }
  std::int64_t steps() const override { return steps_; }
  std::int64_t steps_per_epoch() const override { return 5; }
  const Adam& optimiser() const override { return adam_; }
  bool IsDecisionDue() override { return state_.step == decision_step; }
  void Decide() override { calls.emplace_back("decide"); }
  Losses Forward() override {
    calls.emplace_back("forward");
    Losses losses;
    losses.total = (x_ - 3.0).square() * (state_.step == bad_step ? std::numeric_limits<double>::quiet_NaN() : 1.0);
    return losses;
  }
  void OnGradients() override {
    calls.emplace_back("gradients");
    if (bad_step < 0) {
      EXPECT_EQ(x_.grad().item<double>(), 2.0 * (x_.item<double>() - 3.0)) << "of the parameters as they were";
    }
    x_.mutable_grad().mul_(gradient_factor);
  }
  void Update() override {
    calls.emplace_back("update");
    adam_.Step(0.1);
  }
  void EndEpoch(const EpochSums& sums) override {
    calls.emplace_back("epoch");
    epoch_sums.push_back(sums);
  }
  double ProbeLoss() override { return (x_ - 3.0).square().item<double>(); }
  Checkpoint MakeCheckpoint() override {
    Checkpoint checkpoint;
    checkpoint.info.width = 1;
    checkpoint.info.skeleton = *FindSkeleton("h36m-17");
    checkpoint.info.steps = state_.step;
    checkpoint.sums = state_.sums.Read();
    return checkpoint;
  }
  void Restore(const Checkpoint& checkpoint, const std::string& /*file*/) override {
    state_.step = checkpoint.info.steps;
  }
  std::string DescribeLoss(const EpochSums& /*sums*/) const override { return ""; }

  std::int64_t decision_step = -1;
  std::int64_t bad_step = -1;
  double gradient_factor = 1.0;
  std::vector<std::string> calls;
  std::vector<EpochSums> epoch_sums;
  double x() const { return x_.item<double>(); }

 private:
  std::int64_t steps_;
  torch::Tensor x_ = torch::zeros({}, torch::kFloat64).requires_grad_();
  Adam adam_{{{"x", x_}}, 0.0};
  LoopState state_{0, LossSums(torch::kCPU)};
};

TEST(TrainingLoop, GradientsAreSeenBeforeTheyAreUsed) {
  Toy toy(1);
  toy.decision_step = 0;
  RunFolder none("", false, false);
  EXPECT_TRUE(TrainingLoop(toy, none, "toy", 0.0).Run());
  EXPECT_THAT(toy.calls, ElementsAre("decide", "forward", "gradients", "update"));
  EXPECT_NEAR(toy.x(), 0.1, 1e-6);
  // What is done to the gradients counts: Adam's first step is the rate, with the gradient's sign.
  Toy uphill(1);
  uphill.gradient_factor = -1.0;
  EXPECT_TRUE(TrainingLoop(uphill, none, "toy", 0.0).Run());
  EXPECT_NEAR(uphill.x(), -0.1, 1e-6);
}

TEST(TrainingLoop, SumsAreThoseOfTheEpoch) {
  Toy toy(11);
  RunFolder none("", false, false);
  EXPECT_TRUE(TrainingLoop(toy, none, "toy", 0.0).Run());
  ASSERT_EQ(toy.epoch_sums.size(), 2U);
  EXPECT_EQ(toy.epoch_sums[0].steps, 5);
  EXPECT_EQ(toy.epoch_sums[1].steps, 5);
  EXPECT_LT(toy.epoch_sums[1].Mean().total, toy.epoch_sums[0].Mean().total);
  EXPECT_EQ(toy.state().sums.Read().steps, 1);
}

TEST(TrainingLoop, ALossThatIsNotFiniteIsFoundByTheEndOfItsEpochAndNeverSaved) {
  const TemporaryFolder folder;
  RunFolder run(folder / "run", false, false);
  Toy toy(20);
  toy.bad_step = 6;
  TrainingLoop loop(toy, run, "toy", 1e6);
  loop.StartOrResume();
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { loop.Run(); }),
              AllOf(HasSubstr("nan between steps 6 and"), HasSubstr("of step 0"), HasSubstr("`learning_rate`")));
  EXPECT_LE(toy.state().step, 10);
  EXPECT_EQ(ReadCheckpoint(folder / "run/checkpoint.h5").info.steps, 0);

  // Saved after every step, it is found at once.
  Toy careful(20);
  careful.bad_step = 6;
  RunFolder other(folder / "other", false, false);
  TrainingLoop careful_loop(careful, other, "toy", 0.0);
  EXPECT_THAT(ErrorOf(ErrorKind::kComputation, [&] { careful_loop.Run(); }),
              AllOf(HasSubstr("nan at step 7 of 20"), HasSubstr("of step 6")));
}

TEST(TrainingLoop, StopsWhereItIsAskedToAndContinuesThere) {
  const TemporaryFolder folder;
  Callbacks callbacks;
  int polls = 0;
  callbacks.stop = [&] { return ++polls == 4; };
  {
    const CallbackScope scope(callbacks);
    Toy toy(20);
    RunFolder run(folder / "run", false, false);
    EXPECT_FALSE(TrainingLoop(toy, run, "toy", 1e6).Run());
  }
  Toy toy(20);
  RunFolder run(folder / "run", /*resume=*/true, false);
  TrainingLoop loop(toy, run, "toy", 1e6);
  loop.StartOrResume();
  EXPECT_EQ(toy.state().step, 4);
  EXPECT_TRUE(loop.Run());
}

TEST(LossSums, AddAsDoublesWhateverTheLossesAre) {
  LossSums sums(torch::kCPU);
  Losses losses;
  losses.total = torch::tensor(0.1F);
  sums.Add(losses);
  losses.reprojection = torch::tensor(0.2F);
  losses.view = torch::tensor(0.3F);
  losses.camera = torch::tensor(0.4F);
  sums.Add(losses);
  const EpochSums read = sums.Read();
  EXPECT_EQ(read.total, static_cast<double>(0.1F) + static_cast<double>(0.1F));
  EXPECT_EQ(read.reprojection, static_cast<double>(0.2F));
  EXPECT_EQ(read.view, static_cast<double>(0.3F));
  EXPECT_EQ(read.camera, static_cast<double>(0.4F));
  EXPECT_EQ(read.steps, 2);
  sums.Set({1.0, 2.0, 3.0, 4.0, 5});
  EXPECT_EQ(sums.Read().Mean().camera, 3.0 / 5.0);
  EXPECT_EQ(sums.Read().Mean().total, 4.0 / 5.0);
}

}  // namespace
}  // namespace canonpose
