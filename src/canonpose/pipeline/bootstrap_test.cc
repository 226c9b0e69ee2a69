#include "canonpose/pipeline/bootstrap.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/pipeline/pipeline_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::ShareStarted;
using testing::SmallCapture;

/// The same recording, of a body whose joint names are unknown.
Dataset OfAnAnimal(Dataset dataset) {
  for (std::size_t j = 0; j < dataset.skeleton.joints.size(); ++j) {
    dataset.skeleton.joints[j] = "point " + std::to_string(j);
  }
  dataset.skeleton.name.clear();
  return dataset;
}

TEST(Bootstrap, FactorisesOtherBodiesIfCamerasAreStatic) {
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

TEST(Bootstrap, RefusesFactorisationIfCamerasMove) {
  BootstrapOptions options;
  options.kind = "factorisation";
  const Dataset moving = SmallCapture("handheld");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Bootstrap(moving, "moving.h5", options); }),
              HasSubstr("static cameras"));
}

}  // namespace
}  // namespace canonpose
