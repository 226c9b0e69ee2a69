#include "canonpose/skeleton/skeleton.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

char Lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

bool SameText(std::string_view a, std::string_view b, bool dash_is_underscore) {
  const auto fold = [&](char c) { return dash_is_underscore && c == '_' ? '-' : Lower(c); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return fold(x) == fold(y); });
}

/// A joint and the name of its parent; the root has none.
struct NamedJoint {
  const char* name;
  const char* parent;
};

/// The left-right partner of a built-in joint is the one whose name differs only in the leading letter or word.
int MirrorOf(const Skeleton& skeleton, int joint) {
  std::string partner = skeleton.joints[static_cast<std::size_t>(joint)];
  if (partner.starts_with("left_")) return skeleton.Find("right_" + partner.substr(5)).value_or(joint);
  if (partner.starts_with("right_")) return skeleton.Find("left_" + partner.substr(6)).value_or(joint);
  static constexpr std::string_view kSides = "LRlr";
  static constexpr std::string_view kPartners = "RLrl";
  const std::size_t side = kSides.find(partner.front());
  if (side == std::string_view::npos) return joint;
  partner.front() = kPartners[side];
  return skeleton.Find(partner).value_or(joint);
}

Skeleton MakeSkeleton(const char* name, const std::vector<NamedJoint>& joints) {
  Skeleton skeleton;
  skeleton.name = name;
  for (const NamedJoint& joint : joints) skeleton.joints.emplace_back(joint.name);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string_view parent = joints[static_cast<std::size_t>(j)].parent;
    skeleton.parents.push_back(parent.empty() ? -1 : skeleton.Find(parent).value());
    if (parent.empty()) skeleton.root = j;
    skeleton.mirror.push_back(MirrorOf(skeleton, j));
  }
  CANONPOSE_CHECK(skeleton.Problem().empty(), "{}: {}", name, skeleton.Problem());
  return skeleton;
}

Skeleton MakeHuman36m() {
  return MakeSkeleton("h36m-17", {{"Hip", ""},
                                  {"RHip", "Hip"},
                                  {"RKnee", "RHip"},
                                  {"RFoot", "RKnee"},
                                  {"LHip", "Hip"},
                                  {"LKnee", "LHip"},
                                  {"LFoot", "LKnee"},
                                  {"Spine", "Hip"},
                                  {"Thorax", "Spine"},
                                  {"Nose", "Thorax"},
                                  {"Head", "Nose"},
                                  {"LShoulder", "Thorax"},
                                  {"LElbow", "LShoulder"},
                                  {"LWrist", "LElbow"},
                                  {"RShoulder", "Thorax"},
                                  {"RElbow", "RShoulder"},
                                  {"RWrist", "RElbow"}});
}

Skeleton MakeCanonPose16() {
  return MakeSkeleton("canonpose-16", {{"rhip", "root"},
                                       {"rknee", "rhip"},
                                       {"rfoot", "rknee"},
                                       {"lhip", "root"},
                                       {"lknee", "lhip"},
                                       {"lfoot", "lknee"},
                                       {"root", ""},
                                       {"neck", "root"},
                                       {"nose", "neck"},
                                       {"top_head", "nose"},
                                       {"rsho", "neck"},
                                       {"relb", "rsho"},
                                       {"rhand", "relb"},
                                       {"lsho", "neck"},
                                       {"lelb", "lsho"},
                                       {"lhand", "lelb"}});
}

Skeleton MakeBody25() {
  return MakeSkeleton(
      "body_25", {{"Nose", "Neck"},         {"Neck", "MidHip"},    {"RShoulder", "Neck"},   {"RElbow", "RShoulder"},
                  {"RWrist", "RElbow"},     {"LShoulder", "Neck"}, {"LElbow", "LShoulder"}, {"LWrist", "LElbow"},
                  {"MidHip", ""},           {"RHip", "MidHip"},    {"RKnee", "RHip"},       {"RAnkle", "RKnee"},
                  {"LHip", "MidHip"},       {"LKnee", "LHip"},     {"LAnkle", "LKnee"},     {"REye", "Nose"},
                  {"LEye", "Nose"},         {"REar", "REye"},      {"LEar", "LEye"},        {"LBigToe", "LAnkle"},
                  {"LSmallToe", "LBigToe"}, {"LHeel", "LAnkle"},   {"RBigToe", "RAnkle"},   {"RSmallToe", "RBigToe"},
                  {"RHeel", "RAnkle"}});
}

// This layout has no pelvis: the upper neck connects the tree.
Skeleton MakeBody25b() {
  return MakeSkeleton(
      "body_25b",
      {{"Nose", "UpperNeck"},    {"LEye", "Nose"},           {"REye", "Nose"},           {"LEar", "LEye"},
       {"REar", "REye"},         {"LShoulder", "UpperNeck"}, {"RShoulder", "UpperNeck"}, {"LElbow", "LShoulder"},
       {"RElbow", "RShoulder"},  {"LWrist", "LElbow"},       {"RWrist", "RElbow"},       {"LHip", "UpperNeck"},
       {"RHip", "UpperNeck"},    {"LKnee", "LHip"},          {"RKnee", "RHip"},          {"LAnkle", "LKnee"},
       {"RAnkle", "RKnee"},      {"UpperNeck", ""},          {"HeadTop", "UpperNeck"},   {"LBigToe", "LAnkle"},
       {"LSmallToe", "LBigToe"}, {"LHeel", "LAnkle"},        {"RBigToe", "RAnkle"},      {"RSmallToe", "RBigToe"},
       {"RHeel", "RAnkle"}});
}

Skeleton MakeCoco18() {
  return MakeSkeleton("coco-18", {{"Nose", "Neck"},
                                  {"Neck", ""},
                                  {"RShoulder", "Neck"},
                                  {"RElbow", "RShoulder"},
                                  {"RWrist", "RElbow"},
                                  {"LShoulder", "Neck"},
                                  {"LElbow", "LShoulder"},
                                  {"LWrist", "LElbow"},
                                  {"RHip", "Neck"},
                                  {"RKnee", "RHip"},
                                  {"RAnkle", "RKnee"},
                                  {"LHip", "Neck"},
                                  {"LKnee", "LHip"},
                                  {"LAnkle", "LKnee"},
                                  {"REye", "Nose"},
                                  {"LEye", "Nose"},
                                  {"REar", "REye"},
                                  {"LEar", "LEye"}});
}

/// The feet of COCO's whole bodies, in their order.
std::vector<NamedJoint> CocoFeet() {
  return {{"LBigToe", "LAnkle"}, {"LSmallToe", "LBigToe"}, {"LHeel", "LAnkle"},
          {"RBigToe", "RAnkle"}, {"RSmallToe", "RBigToe"}, {"RHeel", "RAnkle"}};
}

/// COCO's 17 joints. The trunk is connected by `pelvis` and `neck`, or where these are missing by nose and shoulders.
std::vector<NamedJoint> Coco17Joints(bool has_trunk) {
  return {{"Nose", has_trunk ? "Neck" : ""},
          {"LEye", "Nose"},
          {"REye", "Nose"},
          {"LEar", "LEye"},
          {"REar", "REye"},
          {"LShoulder", has_trunk ? "Neck" : "Nose"},
          {"RShoulder", has_trunk ? "Neck" : "Nose"},
          {"LElbow", "LShoulder"},
          {"RElbow", "RShoulder"},
          {"LWrist", "LElbow"},
          {"RWrist", "RElbow"},
          {"LHip", has_trunk ? "Hip" : "LShoulder"},
          {"RHip", has_trunk ? "Hip" : "RShoulder"},
          {"LKnee", "LHip"},
          {"RKnee", "RHip"},
          {"LAnkle", "LKnee"},
          {"RAnkle", "RKnee"}};
}

Skeleton MakeCoco23() {
  std::vector<NamedJoint> joints = Coco17Joints(false);
  const std::vector<NamedJoint> feet = CocoFeet();
  joints.insert(joints.end(), feet.begin(), feet.end());
  return MakeSkeleton("coco-23", joints);
}

Skeleton MakeHalpe26() {
  std::vector<NamedJoint> joints = Coco17Joints(true);
  joints.insert(joints.end(), {{"Head", "Neck"},
                               {"Neck", "Hip"},
                               {"Hip", ""},
                               {"LBigToe", "LAnkle"},
                               {"RBigToe", "RAnkle"},
                               {"LSmallToe", "LBigToe"},
                               {"RSmallToe", "RBigToe"},
                               {"LHeel", "LAnkle"},
                               {"RHeel", "RAnkle"}});
  return MakeSkeleton("halpe-26", joints);
}

Skeleton MakeMpi28() {
  return MakeSkeleton("3dhp-28", {{"spine3", "spine2"},
                                  {"spine4", "spine3"},
                                  {"spine2", "spine"},
                                  {"spine", "pelvis"},
                                  {"pelvis", ""},
                                  {"neck", "spine4"},
                                  {"head", "neck"},
                                  {"head_top", "head"},
                                  {"left_clavicle", "spine4"},
                                  {"left_shoulder", "left_clavicle"},
                                  {"left_elbow", "left_shoulder"},
                                  {"left_wrist", "left_elbow"},
                                  {"left_hand", "left_wrist"},
                                  {"right_clavicle", "spine4"},
                                  {"right_shoulder", "right_clavicle"},
                                  {"right_elbow", "right_shoulder"},
                                  {"right_wrist", "right_elbow"},
                                  {"right_hand", "right_wrist"},
                                  {"left_hip", "pelvis"},
                                  {"left_knee", "left_hip"},
                                  {"left_ankle", "left_knee"},
                                  {"left_foot", "left_ankle"},
                                  {"left_toe", "left_foot"},
                                  {"right_hip", "pelvis"},
                                  {"right_knee", "right_hip"},
                                  {"right_ankle", "right_knee"},
                                  {"right_foot", "right_ankle"},
                                  {"right_toe", "right_foot"}});
}

Skeleton MakeMpi17() {
  return MakeSkeleton("3dhp-17", {{"head_top", "head"},
                                  {"neck", "spine"},
                                  {"right_shoulder", "neck"},
                                  {"right_elbow", "right_shoulder"},
                                  {"right_wrist", "right_elbow"},
                                  {"left_shoulder", "neck"},
                                  {"left_elbow", "left_shoulder"},
                                  {"left_wrist", "left_elbow"},
                                  {"right_hip", "pelvis"},
                                  {"right_knee", "right_hip"},
                                  {"right_ankle", "right_knee"},
                                  {"left_hip", "pelvis"},
                                  {"left_knee", "left_hip"},
                                  {"left_ankle", "left_knee"},
                                  {"pelvis", ""},
                                  {"spine", "pelvis"},
                                  {"head", "neck"}});
}

Skeleton MakeMpii16() {
  return MakeSkeleton("mpii-16", {{"rankle", "rknee"},
                                  {"rknee", "rhip"},
                                  {"rhip", "pelvis"},
                                  {"lhip", "pelvis"},
                                  {"lknee", "lhip"},
                                  {"lankle", "lknee"},
                                  {"pelvis", ""},
                                  {"neck", "pelvis"},
                                  {"nose", "neck"},
                                  {"top_head", "nose"},
                                  {"rwrist", "relbow"},
                                  {"relbow", "rshoulder"},
                                  {"rshoulder", "neck"},
                                  {"lshoulder", "neck"},
                                  {"lelbow", "lshoulder"},
                                  {"lwrist", "lelbow"}});
}

}  // namespace

std::optional<int> Skeleton::Find(std::string_view joint) const {
  for (int j = 0; j < joint_count(); ++j) {
    if (SameText(joints[static_cast<std::size_t>(j)], joint, false)) return j;
  }
  return std::nullopt;
}

std::string Skeleton::Problem() const {
  const int count = joint_count();
  if (count == 0) return "there are no joints";
  if (static_cast<int>(parents.size()) != count) return fmt::format("{} parents for {} joints", parents.size(), count);
  if (static_cast<int>(mirror.size()) != count)
    return fmt::format("{} mirror entries for {} joints", mirror.size(), count);
  if (root < 0 || root >= count) return fmt::format("root {} is not one of {} joints", root, count);
  for (int j = 0; j < count; ++j) {
    const auto i = static_cast<std::size_t>(j);
    if (joints[i].empty()) return fmt::format("joint {} has no name", j);
    if (Find(joints[i]) != j) return fmt::format("there are two joints named {}", joints[i]);
    if (parents[i] < -1 || parents[i] >= count)
      return fmt::format("parent {} of {} is not a joint", parents[i], joints[i]);
    if (j == root && parents[i] != -1) return fmt::format("the root {} has a parent", joints[i]);
    if (j != root && parents[i] == -1) return fmt::format("{} has no parent but is not the root", joints[i]);
    if (mirror[i] < 0 || mirror[i] >= count || mirror[static_cast<std::size_t>(mirror[i])] != j) {
      return fmt::format("mirror entry {} of {} does not lead back", mirror[i], joints[i]);
    }
  }
  for (int j = 0; j < count; ++j) {
    int ancestor = j;
    for (int steps = 0; ancestor != root && steps < count; ++steps)
      ancestor = parents[static_cast<std::size_t>(ancestor)];
    if (ancestor != root)
      return fmt::format("the parents of {} do not lead to the root", joints[static_cast<std::size_t>(j)]);
  }
  return "";
}

bool Skeleton::SameJoints(const Skeleton& other) const {
  return root == other.root &&
         std::equal(joints.begin(), joints.end(), other.joints.begin(), other.joints.end(),
                    [](const std::string& a, const std::string& b) { return SameText(a, b, false); });
}

Skeleton Subset(const Skeleton& skeleton, const std::vector<int>& joints) {
  std::vector<int> index(skeleton.joints.size(), -1);
  for (std::size_t i = 0; i < joints.size(); ++i) index[static_cast<std::size_t>(joints[i])] = static_cast<int>(i);
  CANONPOSE_CHECK(index[static_cast<std::size_t>(skeleton.root)] >= 0, "the root is not among the joints");
  Skeleton subset;
  subset.root = index[static_cast<std::size_t>(skeleton.root)];
  for (const int joint : joints) {
    const auto j = static_cast<std::size_t>(joint);
    subset.joints.push_back(skeleton.joints[j]);
    int ancestor = skeleton.parents[j];
    while (ancestor >= 0 && index[static_cast<std::size_t>(ancestor)] < 0) {
      ancestor = skeleton.parents[static_cast<std::size_t>(ancestor)];
    }
    subset.parents.push_back(ancestor < 0 ? -1 : index[static_cast<std::size_t>(ancestor)]);
    const int partner = index[static_cast<std::size_t>(skeleton.mirror[j])];
    subset.mirror.push_back(partner < 0 ? index[j] : partner);
  }
  return subset;
}

const std::vector<Skeleton>& BuiltinSkeletons() {
  static const std::vector<Skeleton> skeletons = {MakeHuman36m(), MakeCanonPose16(),
                                                  MakeBody25(),   MakeBody25b(),
                                                  MakeCoco18(),   MakeSkeleton("coco-17", Coco17Joints(false)),
                                                  MakeHalpe26(),  MakeCoco23()};
  return skeletons;
}

const std::vector<Skeleton>& BenchmarkSkeletons() {
  static const std::vector<Skeleton> skeletons = {MakeMpi28(), MakeMpi17(), MakeMpii16()};
  return skeletons;
}

const Skeleton* FindSkeleton(std::string_view name) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    if (SameText(skeleton.name, name, true)) return &skeleton;
  }
  return nullptr;
}

std::string BuiltinSkeletonNames() {
  std::string names;
  for (const Skeleton& skeleton : BuiltinSkeletons()) names += (names.empty() ? "" : ", ") + skeleton.name;
  return names;
}

}  // namespace canonpose
