#include "canonpose/data/layout_check.h"

#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/formats.h"
#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::Shared;

/// Flexion in degrees, forwards; the body faces +x, y is up.
struct Posture {
  const char* name;
  double trunk;
  double thigh;
  double knee;
  double arm;
  double elbow;
  double upside_down = 0.0;
};

constexpr std::array<Posture, 8> kPostures{{{"upright", 0, 5, 10, 10, 20},
                                            {"walking", 5, 30, 40, -20, 30},
                                            {"arms up", 0, 0, 5, 170, 10},
                                            {"sitting", 10, 85, 85, 40, 60},
                                            {"squatting", 40, 110, 120, 80, 20},
                                            {"bent", 90, 10, 15, 60, 10},
                                            {"handstand", 0, 5, 10, 170, 5, 180},
                                            {"lying", 0, 10, 20, 30, 30, 90}}};

/// In the plane x-y, `degrees` forwards of straight down.
Vector3d Down(double degrees) { return {std::sin(RadFromDeg(degrees)), -std::cos(RadFromDeg(degrees)), 0.0}; }

/// Body parts in mm, by the names of the layouts without their differences.
std::map<std::string, Vector3d> Body(const Posture& posture, Rng& rng) {
  std::map<std::string, Vector3d> parts;
  const auto jitter = [&rng] { return 12.0 * rng.Normal(); };
  const Vector3d up = -Down(-posture.trunk);
  const Vector3d front(up.y(), -up.x(), 0.0);
  const Vector3d thorax = 500.0 * up;
  parts["pelvis"] = Vector3d::Zero();
  parts["spine"] = 0.5 * thorax + 20.0 * front;
  parts["thorax"] = thorax;
  parts["neck"] = thorax + 30.0 * up;
  parts["nose"] = thorax + 150.0 * up + 110.0 * front;
  parts["head"] = thorax + 300.0 * up;
  for (const auto& [side, z] : {std::pair("L", -1.0), std::pair("R", 1.0)}) {
    const std::string s(side);
    const Vector3d across(0, 0, z);
    parts[s + "eye"] = thorax + 190.0 * up + 90.0 * front + 32.0 * across;
    parts[s + "ear"] = thorax + 175.0 * up + 75.0 * across;
    parts[s + "hip"] = 110.0 * across;
    parts[s + "shoulder"] = thorax + 190.0 * across;
    const double thigh = posture.trunk * 0.3 + posture.thigh + 12.0 * z + jitter();
    const double shank = thigh - posture.knee + jitter() * 0.5;
    parts[s + "knee"] = parts[s + "hip"] + 430.0 * Down(thigh) + 30.0 * across;
    parts[s + "ankle"] = parts[s + "knee"] + 420.0 * Down(shank);
    const Vector3d toes = Down(shank + 80.0);
    parts[s + "heel"] = parts[s + "ankle"] + 50.0 * Down(shank) - 40.0 * toes;
    parts[s + "bigtoe"] = parts[s + "ankle"] + 50.0 * Down(shank) + 170.0 * toes - 20.0 * across;
    parts[s + "smalltoe"] = parts[s + "ankle"] + 50.0 * Down(shank) + 140.0 * toes + 40.0 * across;
    const double arm = posture.arm - 15.0 * z + jitter();
    parts[s + "elbow"] = parts[s + "shoulder"] + 290.0 * Down(arm) + 60.0 * across;
    parts[s + "wrist"] = parts[s + "elbow"] + 250.0 * Down(arm + posture.elbow + jitter());
  }
  const Matrix3d turn = AngleAxisd(RadFromDeg(posture.upside_down), Vector3d::UnitZ()).toRotationMatrix();
  for (auto& [name, part] : parts) part = turn * part;
  return parts;
}

/// The part that a joint of any built-in layout is.
std::string PartOf(const std::string& joint) {
  static const std::map<std::string, std::string> parts = {
      {"Hip", "pelvis"}, {"MidHip", "pelvis"}, {"root", "pelvis"},    {"Spine", "spine"}, {"Thorax", "thorax"},
      {"Neck", "neck"},  {"neck", "neck"},     {"UpperNeck", "neck"}, {"Nose", "nose"},   {"nose", "nose"},
      {"Head", "head"},  {"HeadTop", "head"},  {"top_head", "head"},  {"foot", "ankle"},  {"sho", "shoulder"},
      {"elb", "elbow"},  {"hand", "wrist"}};
  if (const auto found = parts.find(joint); found != parts.end()) return found->second;
  std::string rest = joint.substr(1);
  for (char& c : rest) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (const auto found = parts.find(rest); found != parts.end()) rest = found->second;
  return std::string(1, static_cast<char>(std::toupper(static_cast<unsigned char>(joint[0])))) + rest;
}

/// What a camera at an azimuth and an elevation sees of frames of a posture, 5 m away, joints in the order of a layout.
KeypointClip Watch(const Skeleton& layout, const Posture& posture, double azimuth, double elevation, int frames) {
  KeypointClip clip;
  clip.name = "cam";
  clip.path = fmt::format("{} at {}, {}", posture.name, azimuth, elevation);
  clip.keypoint_count = layout.joint_count();
  const Matrix3d rotation =
      (AngleAxisd(RadFromDeg(elevation), Vector3d::UnitX()) * AngleAxisd(RadFromDeg(azimuth), Vector3d::UnitY()))
          .toRotationMatrix();
  Rng rng(11);
  for (int t = 0; t < frames; ++t) {
    clip.frame_numbers.push_back(t);
    const std::map<std::string, Vector3d> body = Body(posture, rng);
    for (const std::string& joint : layout.joints) {
      const Vector3d point = rotation * body.at(PartOf(joint));
      const double scale = 1000.0 / (5000.0 + point.z());
      clip.keypoints.push_back(static_cast<float>(500.0 + scale * point.x() + rng.Normal()));
      clip.keypoints.push_back(static_cast<float>(500.0 - scale * point.y() + rng.Normal()));
      clip.confidence.push_back(0.8F);
    }
  }
  return clip;
}

/// Two cameras a quarter turn apart.
std::vector<KeypointClip> WatchByTwo(const Skeleton& layout, const Posture& posture, double azimuth, double elevation,
                                     int frames = 30) {
  return {Watch(layout, posture, azimuth, elevation, frames),
          Watch(layout, posture, azimuth + 90.0, elevation, frames)};
}

KeypointClip Reordered(const KeypointClip& clip, const std::vector<std::size_t>& order) {
  KeypointClip result = clip;
  for (std::size_t t = 0; t < clip.frame_numbers.size(); ++t) {
    for (std::size_t k = 0; k < order.size(); ++k) {
      const std::size_t to = t * order.size() + k;
      const std::size_t from = t * order.size() + order[k];
      result.keypoints[2 * to] = clip.keypoints[2 * from];
      result.keypoints[2 * to + 1] = clip.keypoints[2 * from + 1];
      result.confidence[to] = clip.confidence[from];
    }
  }
  return result;
}

void ForEachView(const std::function<void(const Skeleton&, const Posture&, double, double)>& action) {
  for (const Skeleton& layout : BuiltinSkeletons()) {
    for (const Posture& posture : kPostures) {
      for (const double azimuth : {10.0, 55.0, 100.0, 200.0}) {
        for (const double elevation : {0.0, 20.0, 45.0}) action(layout, posture, azimuth, elevation);
      }
    }
  }
}

TEST(CheckLayout, FindsEveryLayoutInEveryPosture) {
  ForEachView([](const Skeleton& layout, const Posture& posture, double azimuth, double elevation) {
    const std::vector<KeypointClip> clips = WatchByTwo(layout, posture, azimuth, elevation);
    try {
      EXPECT_EQ(CheckLayout(clips, "").name, layout.name) << clips[0].path;
      EXPECT_EQ(CheckLayout(clips, layout.name).name, layout.name);
    } catch (const Error& error) {
      ADD_FAILURE() << layout.name << ": " << error.what();
    }
  });
}

TEST(CheckLayout, RefusesEveryOtherLayoutOfAsManyJoints) {
  int refused = 0;
  ForEachView([&](const Skeleton& layout, const Posture& posture, double azimuth, double elevation) {
    for (const Skeleton& other : BuiltinSkeletons()) {
      if (other.joint_count() != layout.joint_count() || other.name == layout.name) continue;
      const std::vector<KeypointClip> clips = WatchByTwo(layout, posture, azimuth, elevation);
      EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, other.name); }),
                  HasSubstr(fmt::format("use `layout` {}", layout.name)));
      ++refused;
    }
  });
  EXPECT_EQ(refused, 4 * 8 * 12);
}

TEST(CheckLayout, RefusesShuffledJoints) {
  Rng rng(3);
  int accepted = 0;
  int total = 0;
  ForEachView([&](const Skeleton& layout, const Posture& posture, double azimuth, double elevation) {
    const std::vector<std::size_t> order = rng.Permutation(layout.joints.size());
    std::vector<KeypointClip> clips = WatchByTwo(layout, posture, azimuth, elevation);
    for (KeypointClip& clip : clips) clip = Reordered(clip, order);
    ++total;
    try {
      CheckLayout(clips, "");
      ++accepted;
    } catch (const Error&) {
    }
  });
  // A chance order may come near the right one, but seldom.
  EXPECT_LT(accepted, total / 100);
}

TEST(CheckLayout, ASingleFrameIsEnoughInMostPostures) {
  const Skeleton& layout = *FindSkeleton("body_25b");
  for (const Posture& posture : kPostures) {
    const std::vector<KeypointClip> clips{Watch(layout, posture, 40.0, 10.0, 1)};
    EXPECT_EQ(CheckLayout(clips, "").name, layout.name) << posture.name;
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, "body_25"); }), HasSubstr("body_25b"));
  }
}

TEST(CheckLayout, MissingJointsDoNotMisleadIt) {
  Rng rng(8);
  for (const char* name : {"body_25", "body_25b", "coco-17", "h36m-17"}) {
    std::vector<KeypointClip> clips = WatchByTwo(*FindSkeleton(name), kPostures[1], 30.0, 10.0);
    for (KeypointClip& clip : clips) {
      for (float& confidence : clip.confidence) confidence = rng.Uniform() < 0.3 ? 0.0F : confidence;
    }
    EXPECT_EQ(CheckLayout(clips, "").name, name);
  }
}

TEST(CheckLayout, HalfABodyIsEnough) {
  for (const char* name : {"body_25", "body_25b"}) {
    const Skeleton& layout = *FindSkeleton(name);
    std::vector<KeypointClip> clips = WatchByTwo(layout, kPostures[1], 30.0, 10.0);
    for (KeypointClip& clip : clips) {
      for (std::size_t i = 0; i < clip.confidence.size(); ++i) {
        const std::string part = PartOf(layout.joints[i % layout.joints.size()]);
        for (const char* low : {"knee", "ankle", "toe", "heel"}) {
          if (part.find(low) != std::string::npos) clip.confidence[i] = 0.0F;
        }
      }
    }
    EXPECT_EQ(CheckLayout(clips, "").name, name);
  }
}

TEST(CheckLayout, TooFewJointsLeaveItUndecided) {
  std::vector<KeypointClip> clips = WatchByTwo(*FindSkeleton("body_25"), kPostures[0], 0.0, 0.0);
  for (KeypointClip& clip : clips) {
    for (std::size_t i = 0; i < clip.confidence.size(); ++i) clip.confidence[i] = i % 25 < 4 ? 0.5F : 0.0F;
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, ""); }),
              HasSubstr("`layout` body_25 or body_25b"));
  EXPECT_EQ(CheckLayout(clips, "body_25").name, "body_25");
}

TEST(CheckLayout, OneCameraInAnotherLayoutIsRefused) {
  std::vector<KeypointClip> clips = WatchByTwo(*FindSkeleton("body_25"), kPostures[1], 0.0, 10.0);
  clips.push_back(Watch(*FindSkeleton("body_25"), kPostures[1], 45.0, 10.0, 30));
  clips.push_back(Watch(*FindSkeleton("body_25b"), kPostures[1], 200.0, 10.0, 30));
  clips.back().name = "odd";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, ""); }), HasSubstr("camera odd has another"));
}

TEST(CheckLayout, CountsAndNamesMustFit) {
  const std::vector<KeypointClip> clips = WatchByTwo(*FindSkeleton("halpe-26"), kPostures[0], 0.0, 0.0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, "body_25"); }),
              AllOf(HasSubstr("expected 25 keypoints for layout body_25, found 26"), HasSubstr("halpe-26 (26)")));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { CheckLayout(clips, "body_26"); }),
              HasSubstr("the layouts are"));
  EXPECT_EQ(CheckLayout(clips, "HALPE_26").name, "halpe-26");
  std::vector<KeypointClip> odd = clips;
  odd.resize(1);
  odd[0].keypoint_count = 13;
  odd[0].keypoints.resize(odd[0].keypoints.size() / 2);
  odd[0].confidence.resize(odd[0].confidence.size() / 2);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(odd, ""); }),
              HasSubstr("as many keypoints as a known layout"));
}

TEST(CheckLayout, TheBalancingRecordingIsBody25b) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing");
  const DetectionFormat& format = FindDetectionFormat("openpose");
  std::vector<KeypointClip> clips;
  for (const CameraInput& input : format.find_cameras(Shared("data/balancing"))) {
    clips.push_back(FollowPerson(format.read(input), 1));
  }
  EXPECT_EQ(CheckLayout(clips, "").name, "body_25b");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { CheckLayout(clips, "body_25"); }),
              HasSubstr("use `layout` body_25b"));
  const LayoutFit fit = MeasureLayout(*FindSkeleton("body_25b"), clips);
  EXPECT_NEAR(fit.tree_ratio, 1.2, 0.1);
  EXPECT_LT(fit.asymmetry, 0.06);
  EXPECT_NEAR(fit.thigh_to_shank, 1.0, 0.4);
  for (const KeypointClip& clip : clips) EXPECT_EQ(CheckLayout(std::span(&clip, 1), "").name, "body_25b");
}

}  // namespace
}  // namespace canonpose
