#include "canonpose/motion/landmarks.h"

#include <gtest/gtest.h>

#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

TEST(Landmarks, MakeEveryBuiltinLayout) {
  for (const Skeleton& layout : BuiltinSkeletons()) {
    const LayoutMapping mapping = MapLayout(LandmarkSkeleton(), layout);
    EXPECT_EQ(mapping.joints.size(), layout.joints.size());
    for (std::size_t j = 0; j < layout.joints.size(); ++j) {
      EXPECT_EQ(mapping.joints[j].sources.size(), 1U) << layout.name << " " << mapping.Describe(static_cast<int>(j));
    }
  }
}

}  // namespace
}  // namespace canonpose
