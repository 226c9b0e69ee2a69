#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/simulate/figure_testing.h"
#include "canonpose/simulate/rig.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::WalkInCircle;
using Json = nlohmann::json;

Json Matrix(const Eigen::Matrix3d& m) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2)});
  return rows;
}

Json Vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// A rig in the form of its file: parts that change are arrays over frames.
Json RigJson(const std::vector<FilmingCamera>& filming) {
  Json cameras = Json::array();
  for (const FilmingCamera& camera : filming) {
    Json json{{"name", camera.name}, {"image_size", camera.image_size}};
    if (camera.cameras.size() == 1) {
      json["K"] = Matrix(camera.cameras[0].K);
      json["R"] = Matrix(camera.cameras[0].camera_from_world_rotation);
      json["t"] = Vector(camera.cameras[0].camera_from_world_translation);
      json["distortion"] = camera.cameras[0].distortion;
    } else {
      for (const Camera& now : camera.cameras) {
        json["K"].push_back(Matrix(now.K));
        json["R"].push_back(Matrix(now.camera_from_world_rotation));
        json["t"].push_back(Vector(now.camera_from_world_translation));
      }
    }
    cameras.push_back(json);
  }
  return {{"cameras", cameras}};
}

class RigFile : public ::testing::Test {
 protected:
  std::unique_ptr<Rig> ReadText(const std::string& text) {
    std::ofstream(folder_ / "rig.json") << text;
    RigOptions options;
    options.kind = (folder_ / "rig.json").string();
    return MakeRig(options, Rng(0));
  }
  std::unique_ptr<Rig> Read(const Json& json) { return ReadText(json.dump()); }

  /// The message for a valid file after a change; without the folder.
  template <typename Change>
  std::string Refusal(Change&& change) {
    Json json = good_;
    change(json);
    const std::string message = ErrorOf(ErrorKind::kBadInput, [&] { Read(json); });
    const std::string file = (folder_ / "rig.json").string();
    EXPECT_THAT(message, HasSubstr(file));
    return message.substr(std::min(message.size(), file.size() + 2));
  }

  static std::vector<FilmingCamera> Filmed(const char* kind, const LandmarkTrack& track) {
    RigOptions options;
    options.kind = kind;
    options.distortion = options.kind == "studio" ? 1.0 : 0.0;
    return MakeRig(options, Rng(3))->Film(track, Rng(4));
  }

  TemporaryFolder folder_;
  const LandmarkTrack track_ = WalkInCircle(6, 25.0);
  const Json good_ = RigJson(Filmed("studio", track_));
};

TEST_F(RigFile, ReadsTheCamerasThatWereWritten) {
  for (const char* kind : {"studio", "ptz"}) {
    const std::vector<FilmingCamera> written = Filmed(kind, track_);
    const std::unique_ptr<Rig> rig = Read(RigJson(written));
    EXPECT_EQ(rig->is_static(), kind == std::string("studio"));
    const std::vector<FilmingCamera> read = rig->Film(track_, Rng(0));
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].name, written[i].name);
      EXPECT_EQ(read[i].image_size, written[i].image_size);
      ASSERT_EQ(read[i].cameras.size(), written[i].cameras.size());
      for (std::size_t t = 0; t < read[i].cameras.size(); ++t) {
        const Camera& a = read[i].cameras[t];
        const Camera& b = written[i].cameras[t];
        EXPECT_EQ(a.K, b.K);
        EXPECT_EQ(a.camera_from_world_rotation, b.camera_from_world_rotation);
        EXPECT_EQ(a.camera_from_world_translation, b.camera_from_world_translation);
        EXPECT_EQ(a.distortion, b.distortion);
      }
    }
  }
}

TEST_F(RigFile, TakesPositionAndTarget) {
  const auto cameras = ReadText(R"({"cameras": [
      {"name": "a", "image_size": [1000, 800], "position_m": [4, 0, 1.5], "look_at_m": [0, 0, 1.5], "focal_px": 1000},
      {"name": "b", "image_size": [1000, 800], "position_m": [0, 4, 1.5], "look_at_m": [0, 0, 1.5], "focal_px": 1000,
       "roll_deg": 90}]})")
                           ->Film(track_, Rng(0));
  // Half a metre up and half a metre to the left, facing +x, at 4 m: 125 px.
  EXPECT_NEAR((cameras[0].cameras[0].Project({0, 500, 2000}) - Eigen::Vector2d(625, 275)).norm(), 0.0, 1e-9);
  // When the camera rolls clockwise, the image turns the other way: what was above is on the left.
  EXPECT_NEAR((cameras[1].cameras[0].Project({0, 0, 2000}) - Eigen::Vector2d(375, 400)).norm(), 0.0, 1e-9);
}

TEST_F(RigFile, RefusesInvalidCameras) {
  EXPECT_EQ(
      Refusal([](Json& j) {
        for (int c = 0; c < 3; ++c) j["cameras"][2]["R"][1][c] = -j["cameras"][2]["R"][1][c].get<double>();
      }),
      "cameras[2].R: expected a rotation with determinant +1, found a reflection (determinant -1); flip one axis: x "
      "points right, y down, z forward");
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][1]["R"][0][0] = 3.0; }),
              HasSubstr("cameras[1].R: expected a rotation"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][1]["R"][0] = {1.0, 2.0}; }), HasSubstr("cameras[1].R[0]"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0]["K"][0][0] = -1000.0; }),
              HasSubstr("cameras[0].K: expected focal"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0]["K"][1][0] = 2.0; }), HasSubstr("cameras[0].K"));
  EXPECT_THAT(Refusal([](Json& j) {
                j["cameras"][3]["image_size"] = {0, 100};
              }),
              HasSubstr("cameras[3].image_size[0]"));
  EXPECT_THAT(Refusal([](Json& j) {
                j["cameras"][0]["t"] = {1.0, 2.0};
              }),
              HasSubstr("cameras[0].t: expected 3 values"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0]["t"][1] = "x"; }), HasSubstr("cameras[0].t[1]"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0].erase("t"); }), HasSubstr("t"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0]["distortion"] = {1.0}; }), HasSubstr("cameras[0].distortion"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][1]["name"] = j["cameras"][0]["name"]; }),
              HasSubstr("cameras[1].name: expected another name"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"].erase(1), j["cameras"].erase(1), j["cameras"].erase(1); }),
              HasSubstr("cameras: expected at least 2 cameras, found 1"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"] = 3; }), HasSubstr("cameras"));
  EXPECT_THAT(Refusal([](Json& j) { j = Json::array(); }), HasSubstr("expected"));
  EXPECT_THAT(Refusal([](Json& j) { j["cameras"][0]["position_m"] = {1, 2, 3}; }), HasSubstr("cameras[0].K"));
  EXPECT_THAT(Refusal([](Json& j) {
                j["cameras"][0] = {{"name", "x"},
                                   {"image_size", {10, 10}},
                                   {"focal_px", 0},
                                   {"position_m", {0, 0, 1}},
                                   {"look_at_m", {1, 0, 1}}};
              }),
              HasSubstr("cameras[0].focal_px"));
  EXPECT_THAT(Refusal([](Json& j) {
                j["cameras"][0] = {{"name", "x"},
                                   {"image_size", {10, 10}},
                                   {"focal_px", 10},
                                   {"position_m", {0, 0, 1}},
                                   {"look_at_m", {0, 0, 1}}};
              }),
              HasSubstr("cameras[0].look_at_m"));
  ErrorOf(ErrorKind::kBadInput, [&] { ReadText(R"({"cameras": [NaN]})"); });
  ErrorOf(ErrorKind::kBadInput, [&] { ReadText(""); });
  RigOptions absent;
  absent.kind = (folder_ / "absent.json").string();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeRig(absent, Rng(0)); }), HasSubstr("absent.json"));
}

TEST_F(RigFile, RefusesMovingCamerasWithTooFewFrames) {
  const Json moving = RigJson(Filmed("ptz", track_));
  Json uneven = moving;
  uneven["cameras"][1]["t"].erase(0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Read(uneven); }), HasSubstr("cameras[1].t: expected 6 frames"));
  Json others = moving;
  for (const char* part : {"K", "R", "t"}) others["cameras"][2][part].erase(0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { Read(others); }), HasSubstr("cameras[2]: expected 6 frames"));
  const std::unique_ptr<Rig> rig = Read(moving);
  EXPECT_EQ(rig->Film(WalkInCircle(4, 25.0), Rng(0))[0].cameras.size(), 4U);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { (void)rig->Film(WalkInCircle(7, 25.0), Rng(0)); }),
              HasSubstr("cameras[0]: expected at least the 7 frames of clip circle, found 6"));
}

}  // namespace
}  // namespace canonpose
