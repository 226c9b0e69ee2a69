#include "canonpose/data/readers/mediapipe_layout.h"

#include <gtest/gtest.h>

#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

TEST(MediapipeLayout, PlacesAreMediapipes) {
  const Skeleton& layout = MediapipeLayout();
  EXPECT_EQ(layout.joint_count(), 33);
  EXPECT_EQ(layout.Problem(), "");
  EXPECT_EQ(layout.Find("LShoulder"), 11);
  EXPECT_EQ(layout.Find("RWrist"), 16);
  EXPECT_EQ(layout.Find("LHip"), 23);
  EXPECT_EQ(layout.Find("RHeel"), 30);
  for (std::size_t k = 1; k < 33; ++k) EXPECT_NE(layout.mirror[k], static_cast<int>(k)) << layout.joints[k];
}

TEST(MediapipeLayout, MapsAsOtherLayoutsDo) {
  const LayoutMapping mapping = MapLayout(MediapipeLayout(), *FindSkeleton("h36m-17"));
  EXPECT_EQ(mapping.Describe(0), "Hip = mean(LHip, RHip)");
  EXPECT_EQ(mapping.Describe(8), "Thorax = mean(LShoulder, RShoulder)");
  EXPECT_EQ(mapping.Describe(10), "Head = mean(LEye, REye)");
  EXPECT_EQ(mapping.Describe(6), "LAnkle");
  EXPECT_EQ(FindPart(MediapipeLayout(), "lbigtoe"), 31);
  EXPECT_EQ(FindPart(MediapipeLayout(), "rheel"), 30);
  EXPECT_EQ(FindPart(MediapipeLayout(), "lwrist"), 15);
}

TEST(MediapipeLayout, LandmarksAreFoundByTheirNames) {
  EXPECT_EQ(FindLandmark("LEFT_FOOT_INDEX"), 31);
  EXPECT_EQ(FindLandmark("left eye (inner)"), 1);
  EXPECT_EQ(FindLandmark("MOUTH_RIGHT"), 10);
  EXPECT_EQ(FindLandmark("rknee"), 26);
  EXPECT_FALSE(FindLandmark("pelvis").has_value());
  EXPECT_FALSE(FindLandmark("").has_value());
}

}  // namespace
}  // namespace canonpose
