#include "canonpose/simulate/people/body.h"

#include <algorithm>
#include <string>

#include "canonpose/base/error.h"
#include "canonpose/base/random.h"

namespace canonpose {
namespace {

constexpr std::uint64_t kBodyStream = 0xb0d7;

// A factor around 1, limited to 2.5 standard deviations.
double Factor(Rng& rng, double deviation) { return 1.0 + deviation * std::clamp(rng.Normal(), -2.5, 2.5); }

struct Build {
  double stature;
  double head_factor;
  double shoulder_share;
  double hip_share;
};

Build MakeBuild(Rng& rng) {
  const bool child = rng.Uniform() < 0.1;
  const bool female = rng.Uniform() < 0.5;
  const double normal = std::clamp(rng.Normal(), -2.6, 2.6);
  const double shoulder = female ? 0.208 : 0.220;
  const double hip = female ? 0.103 : 0.098;
  // Means and deviations of adults' stature in mm; the children are about 9 to 13 years old.
  if (child) return {1450.0 + 80.0 * std::clamp(normal, -2.0, 2.0), 1.12, 0.208, 0.100};
  const double stature = female ? 1645.0 + 68.0 * normal : 1780.0 + 74.0 * normal;
  return {stature, 1.0, shoulder, hip};
}

class TreeBuilder {
 public:
  explicit TreeBuilder(std::vector<MotionJoint>& joints) : joints_(joints) { joints_.reserve(kBodyJointCount); }
  void Add(int joint, const std::string& name, int parent, const Eigen::Vector3d& offset_mm) {
    CANONPOSE_CHECK(joint == static_cast<int>(joints_.size()), "{} is out of order", name);
    joints_.push_back({name, parent, offset_mm});
  }

 private:
  std::vector<MotionJoint>& joints_;
};

void AddTrunkAndHead(const Body& body, double head_factor, Rng& rng, TreeBuilder& tree) {
  const double h = body.stature;
  const double spine = body.trunk * 0.5 * Factor(rng, 0.03);
  const double lumbar = 0.035 * h;
  tree.Add(kBHip, "Hip", -1, {0, 0, 0});
  tree.Add(kBLumbar, "Lumbar", kBHip, {-0.008 * h, 0, lumbar});
  tree.Add(kBSpine, "Spine", kBLumbar, {0, 0, spine - lumbar});
  tree.Add(kBThorax, "Thorax", kBSpine, {0.004 * h, 0, body.trunk - spine});
  // The neck leans forward; eyes, ears and nose are around the middle of the head.
  const double neck = 0.020 * h * Factor(rng, 0.08);
  const double upper = 0.034 * h * Factor(rng, 0.12);
  const double skull = h * head_factor;
  const double crown = skull * 0.132 * Factor(rng, 0.04);
  const double half_face = skull * 0.0185 * Factor(rng, 0.05);
  const double depth = skull * 0.058 * Factor(rng, 0.06);
  const double eyes = crown * 0.50 * Factor(rng, 0.05);
  tree.Add(kBNeck, "Neck", kBThorax, {-0.006 * h, 0, neck});
  tree.Add(kBUpperNeck, "UpperNeck", kBNeck, {0.010 * h, 0, upper});
  tree.Add(kBHead, "Head", kBUpperNeck, {0.004 * h, 0, crown});
  tree.Add(kBNose, "Nose", kBUpperNeck, {depth * 1.20, 0, eyes * 0.62});
  tree.Add(kBREye, "REye", kBUpperNeck, {depth * 0.92, -half_face, eyes});
  tree.Add(kBLEye, "LEye", kBUpperNeck, {depth * 0.92, half_face, eyes});
  tree.Add(kBREar, "REar", kBUpperNeck, {0.0, -2.3 * half_face, eyes * 0.85});
  tree.Add(kBLEar, "LEar", kBUpperNeck, {0.0, 2.3 * half_face, eyes * 0.85});
}

void AddArm(const Body& body, int side, TreeBuilder& tree) {
  const double h = body.stature;
  const double sign = SideSign(side);
  const std::string prefix = side == kLeft ? "L" : "R";
  const double half = body.shoulder_width / 2;
  const double inner = 0.014 * h;
  // The collar bone rotates about a point in front of the spine, slightly below the shoulders.
  const Eigen::Vector3d clavicle(0.030 * h, sign * inner, -0.006 * h);
  const int first = ArmJoint(kBLClavicle, side);
  tree.Add(first, prefix + "Clavicle", kBThorax, clavicle);
  tree.Add(first + 1, prefix + "Shoulder", first, {-clavicle.x(), sign * (half - inner), -clavicle.z()});
  tree.Add(first + 2, prefix + "Elbow", first + 1, {0, 0, -body.upper_arm[Body::Index(side)]});
  tree.Add(first + 3, prefix + "Wrist", first + 2, {0, 0, -body.forearm[Body::Index(side)]});
}

void AddLeg(const Body& body, int side, TreeBuilder& tree) {
  const std::size_t i = Body::Index(side);
  const double h = body.stature;
  const double sign = SideSign(side);
  const std::string prefix = side == kLeft ? "L" : "R";
  const int first = LegJoint(kBLHip, side);
  const double sole = -body.ankle_height[i];
  tree.Add(first, prefix + "Hip", kBHip, {0, sign * body.hip_width / 2, 0});
  tree.Add(first + 1, prefix + "Knee", first, {0, 0, -body.thigh[i]});
  tree.Add(first + 2, prefix + "Foot", first + 1, {0, 0, -body.shank[i]});
  tree.Add(first + 3, prefix + "Heel", first + 2, {-body.heel[i], 0, sole + 0.012 * h});
  tree.Add(first + 4, prefix + "Toes", first + 2, {body.ball[i], 0, sole + 0.006 * h});
  tree.Add(first + 5, prefix + "BigToe", first + 4, {0.034 * h, -sign * 0.014 * h, 0.002 * h});
  tree.Add(first + 6, prefix + "SmallToe", first + 4, {0.010 * h, sign * 0.026 * h, 0.0});
}

}  // namespace

double Body::standing_hip_height() const {
  return std::min(leg(kLeft) + ankle_height[kLeft], leg(kRight) + ankle_height[kRight]);
}

// Fractions of the stature from Drillis and Contini (1966), as in Winter, "Biomechanics and Motor Control"; joint
// centres of hips and shoulders are inside the widths of the bony landmarks.
Body MakeBody(std::uint64_t subject_seed) {
  Rng rng(subject_seed, {kBodyStream});
  const Build build = MakeBuild(rng);
  Body body;
  body.stature = build.stature;
  const double h = build.stature;
  const double leg_factor = Factor(rng, 0.030);
  const double thigh_factor = leg_factor * Factor(rng, 0.020);
  const double shank_factor = leg_factor * Factor(rng, 0.020);
  const double arm_factor = Factor(rng, 0.035);
  const double upper_arm_factor = arm_factor * Factor(rng, 0.020);
  const double forearm_factor = arm_factor * Factor(rng, 0.025);
  const double foot_factor = Factor(rng, 0.05);
  for (const int side : {kLeft, kRight}) {
    const std::size_t i = Body::Index(side);
    body.thigh[i] = 0.245 * h * thigh_factor * Factor(rng, 0.005);
    body.shank[i] = 0.246 * h * shank_factor * Factor(rng, 0.005);
    body.upper_arm[i] = 0.178 * h * upper_arm_factor * Factor(rng, 0.005);
    body.forearm[i] = 0.148 * h * forearm_factor * Factor(rng, 0.005);
    body.ankle_height[i] = 0.041 * h * foot_factor;
    body.ball[i] = 0.075 * h * foot_factor * Factor(rng, 0.005);
    body.heel[i] = 0.036 * h * foot_factor * Factor(rng, 0.005);
  }
  body.hip_width = build.hip_share * h * Factor(rng, 0.07);
  body.shoulder_width = build.shoulder_share * h * Factor(rng, 0.05);
  // At the same stature, longer legs come with a somewhat shorter trunk.
  body.trunk = (0.288 - 0.491 * (leg_factor - 1.0) * 0.7) * h * Factor(rng, 0.015);
  TreeBuilder tree(body.joints);
  AddTrunkAndHead(body, build.head_factor, rng, tree);
  AddArm(body, kLeft, tree);
  AddArm(body, kRight, tree);
  AddLeg(body, kLeft, tree);
  AddLeg(body, kRight, tree);
  return body;
}

}  // namespace canonpose
