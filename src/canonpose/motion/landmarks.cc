#include "canonpose/motion/landmarks.h"

#include <array>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

Skeleton MakeLandmarkSkeleton() {
  Skeleton skeleton = *FindSkeleton("h36m-17");
  skeleton.name = "landmarks";
  struct Extra {
    const char* name;
    Landmark parent;
    Landmark mirror;
  };
  static constexpr std::array<Extra, 11> kExtras = {{{"REye", kNose, kLEye},
                                                     {"LEye", kNose, kREye},
                                                     {"REar", kREye, kLEar},
                                                     {"LEar", kLEye, kREar},
                                                     {"UpperNeck", kThorax, kUpperNeck},
                                                     {"LBigToe", kLFoot, kRBigToe},
                                                     {"LSmallToe", kLBigToe, kRSmallToe},
                                                     {"LHeel", kLFoot, kRHeel},
                                                     {"RBigToe", kRFoot, kLBigToe},
                                                     {"RSmallToe", kRBigToe, kLSmallToe},
                                                     {"RHeel", kRFoot, kLHeel}}};
  for (const Extra& extra : kExtras) {
    skeleton.joints.emplace_back(extra.name);
    skeleton.parents.push_back(extra.parent);
    skeleton.mirror.push_back(extra.mirror);
  }
  CANONPOSE_CHECK(skeleton.Problem().empty() && skeleton.joint_count() == kLandmarkCount, "{}", skeleton.Problem());
  return skeleton;
}

}  // namespace

const Skeleton& LandmarkSkeleton() {
  static const Skeleton skeleton = MakeLandmarkSkeleton();
  return skeleton;
}

double StatureMm(const Eigen::Vector3d* p) {
  const auto length = [&](Landmark a, Landmark b) { return (p[a] - p[b]).norm(); };
  // The ankle is above the sole by about 4.5 % of the stature.
  const double right = length(kRHip, kRKnee) + length(kRKnee, kRFoot);
  const double left = length(kLHip, kLKnee) + length(kLKnee, kLFoot);
  const double above_sole = (right + left) / 2 + length(kHip, kSpine) + length(kSpine, kThorax) +
                            length(kThorax, kUpperNeck) + length(kUpperNeck, kHead);
  return above_sole / (1.0 - 0.045);
}

}  // namespace canonpose
