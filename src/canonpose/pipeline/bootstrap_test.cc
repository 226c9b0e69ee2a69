#include "canonpose/pipeline/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

Dataset SmallCapture(const std::string& rig) {
  SimulationOptions options = testing::SmallSimulation();
  options.clips = 1;
  options.seconds = 2.0;
  options.rig.kind = rig;
  return testing::Simulate(options).dataset;
}

/// The same recording of a body whose joints nobody has heard of.
Dataset OfAnAnimal(Dataset dataset) {
  for (std::size_t j = 0; j < dataset.skeleton.joints.size(); ++j) {
    dataset.skeleton.joints[j] = "point " + std::to_string(j);
  }
  dataset.skeleton.name.clear();
  return dataset;
}

/// The share of frames of all views for which there is a start.
double ShareStarted(const StartPoses& start) {
  double started = 0.0;
  double count = 0.0;
  for (const auto& sequence : start.sequences) {
    for (const std::vector<float>& view : sequence) {
      started += static_cast<double>(std::ranges::count_if(view, [](float value) { return std::isfinite(value); }));
      count += static_cast<double>(view.size());
    }
  }
  return started / count;
}

TEST(Bootstrap, TakesTheStarterForPeople) {
  const Dataset dataset = SmallCapture("studio");
  const StartPoses start = Bootstrap(dataset, "data.h5", {});
  ASSERT_EQ(start.sequences.size(), 1U);
  ASSERT_EQ(start.sequences[0].size(), dataset.sequences[0].cameras.size());
  EXPECT_EQ(start.sequences[0][0].size(), dataset.sequences[0].cameras[0].truth.size());
  EXPECT_GT(ShareStarted(start), 0.9);
  // Poses are centred on the root.
  const auto root = 3 * static_cast<std::size_t>(dataset.skeleton.root);
  EXPECT_NEAR(start.sequences[0][0][root], 0.0F, 1e-6);
}

TEST(Bootstrap, FactorisesOtherBodiesBeforeStaticCameras) {
  const Dataset animal = OfAnAnimal(SmallCapture("studio"));
  EXPECT_GT(ShareStarted(Bootstrap(animal, "data.h5", {})), 0.9);
}

TEST(Bootstrap, RefusesTheStarterForOtherBodies) {
  const Dataset animal = OfAnAnimal(SmallCapture("studio"));
  BootstrapOptions options;
  options.kind = "starter";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Bootstrap(animal, "animal.h5", options); }),
              AllOf(HasSubstr("animal.h5"), HasSubstr("`bootstrap`")));
}

TEST(Bootstrap, RefusesFactorisationBeforeMovingCameras) {
  BootstrapOptions options;
  options.kind = "factorisation";
  const Dataset moving = SmallCapture("handheld");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Bootstrap(moving, "moving.h5", options); }),
              HasSubstr("static cameras"));
}

TEST(Bootstrap, TrainingALifterForItCanBeStopped) {
  BootstrapOptions options;
  options.kind = "method";
  int polls = 0;
  Callbacks callbacks;
  callbacks.stop = [&] { return ++polls > 3; };
  const CallbackScope scope(callbacks);
  const Dataset dataset = SmallCapture("studio");
  EXPECT_THAT(ErrorOf(ErrorKind::kStopped, [&] { Bootstrap(dataset, "data.h5", options); }), HasSubstr("stopped"));
}

}  // namespace
}  // namespace canonpose
