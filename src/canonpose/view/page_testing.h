// For tests only: reading a page, and scenes with what a page can show.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "canonpose/skeleton/skeleton.h"
#include "canonpose/view/page_content.h"

namespace canonpose::testing {

inline std::string FromBase64(const std::string& text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string::npos) continue;
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<char>(bits >> count & 0xFF));
  }
  return bytes;
}

inline std::string Gunzip(const std::string& compressed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(compressed.size());
  std::string bytes;
  int state = Z_OK;
  while (state == Z_OK) {
    std::string part(1 << 16, '\0');
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    state = inflate(&stream, Z_NO_FLUSH);
    bytes.append(part, 0, part.size() - stream.avail_out);
  }
  EXPECT_EQ(state, Z_STREAM_END);
  inflateEnd(&stream);
  return bytes;
}

/// What stands between `begin` and the next `end`.
inline std::string Between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t first = text.find(begin);
  EXPECT_NE(first, std::string::npos) << begin;
  if (first == std::string::npos) return "";
  return text.substr(first + begin.size(), text.find(end, first + begin.size()) - first - begin.size());
}

struct PageData {
  nlohmann::ordered_json json;
  std::string arrays;
};

inline PageData DataOf(const std::string& page) {
  return {nlohmann::ordered_json::parse(Between(page, "id=\"canonpose-data\">", "</script>")),
          Gunzip(FromBase64(Between(page, "id=\"canonpose-arrays\">", "</script>")))};
}

/// A person who walks in a circle of 1 m about `centre`, in millimetres, z up.
inline PoseSequence Walker(const std::string& name, int frames, const Eigen::Vector3d& centre_mm) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  PoseSequence person(skeleton, frames);
  person.name = name;
  person.unit = LengthUnit::kMillimetres;
  person.fps = 25.0;
  // Joints of a standing person who looks along x: their left is y.
  const auto standing = [&](const std::string& joint, double swing) -> Eigen::Vector3d {
    const double side = joint.front() == 'L' ? 1.0 : joint.front() == 'R' ? -1.0 : 0.0;
    const double forward = side * swing;
    const std::string part = side == 0.0 ? joint : joint.substr(1);
    if (part == "Hip") return {0, 120 * side, 900};
    if (part == "Knee") return {150 * forward, 120 * side, 480};
    if (part == "Foot" || part == "Ankle") return {250 * forward, 120 * side, 80};
    if (part == "Spine") return {0, 0, 1150};
    if (part == "Thorax") return {0, 0, 1400};
    if (part == "Shoulder") return {0, 180 * side, 1400};
    if (part == "Elbow") return {-100 * forward, 230 * side, 1150};
    if (part == "Wrist") return {-220 * forward, 240 * side, 950};
    if (joint == "Head") return {0, 0, 1650};
    return {90, 0, 1530};  // nose
  };
  for (int t = 0; t < frames; ++t) {
    const double angle = 0.02 * t;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (int j = 0; j < person.joint_count(); ++j) {
      const Eigen::Vector3d local = standing(skeleton.joints[static_cast<std::size_t>(j)], std::sin(0.25 * t));
      person.PoseAt(t).row(j) = (centre_mm + turn * (Eigen::Vector3d(0, -1000, 0) + local)).transpose().cast<float>();
    }
  }
  person.TrustKnownJoints();
  person.standard_deviation().assign(person.confidence().size(), 14.0F);
  return person;
}

/// A level camera 4 m from the origin, 1.5 m high, that looks at it from `angle`.
inline SceneCamera CameraAt(const std::string& name, double angle) {
  SceneCamera camera;
  camera.name = name;
  camera.image_size_px = {1920, 1080};
  Camera calibration;
  calibration.K << 1400, 0, 960, 0, 1400, 540, 0, 0, 1;
  const Eigen::Vector3d position(4500 * std::cos(angle), 4500 * std::sin(angle), 1500);
  const Eigen::Vector3d forward = (Eigen::Vector3d(0, 0, 900) - position).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  calibration.camera_from_world_rotation.row(0) = right;
  calibration.camera_from_world_rotation.row(1) = forward.cross(right);
  calibration.camera_from_world_rotation.row(2) = forward;
  calibration.camera_from_world_translation = -calibration.camera_from_world_rotation * position;
  camera.calibration = {calibration};
  return camera;
}

/// The keypoints that a camera without errors finds.
inline ViewKeypoints SeenExactly(const SceneCamera& camera, const PoseSequence& person) {
  ViewKeypoints keypoints;
  for (int t = 0; t < person.frame_count(); ++t) {
    for (int j = 0; j < person.joint_count(); ++j) {
      const Eigen::Vector2d pixel = camera.At(t).Project(person.PoseAt(t).row(j).transpose().cast<double>());
      keypoints.keypoints.insert(keypoints.keypoints.end(),
                                 {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
      keypoints.confidence.push_back(pixel.allFinite() ? 0.9F : 0.0F);
    }
  }
  return keypoints;
}

/// People who walk before four cameras that see them exactly.
inline ShownScene WalkingScene(int people, int frames) {
  ShownScene shown;
  shown.scene.name = "walk";
  shown.scene.up.source = "the test";
  for (int p = 0; p < people; ++p) {
    shown.scene.people.push_back(Walker("Person " + std::to_string(p + 1), frames, {900.0 * p, 300.0 * p, 0.0}));
  }
  for (int c = 0; c < 4; ++c) shown.scene.cameras.push_back(CameraAt("cam" + std::to_string(c + 1), 0.4 + 1.5 * c));
  for (const PoseSequence& person : shown.scene.people) {
    std::vector<ViewKeypoints>& seen = shown.detections.emplace_back();
    for (const SceneCamera& camera : shown.scene.cameras) seen.push_back(SeenExactly(camera, person));
  }
  return shown;
}

}  // namespace canonpose::testing
