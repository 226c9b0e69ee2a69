// C3D, read back by a reader that was written from the format's documentation alone (https://www.c3d.org), and npz.
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/codecs/npz.h"
#include "canonpose/export/c3d.h"
#include "canonpose/export/scene_npz.h"
#include "canonpose/export/scene_testing.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::MovingPerson;
using testing::PlaceOfJoint;
using testing::StaticScene;
using testing::TemporaryFolder;
using testing::UnknownScene;

// ---------------------------------------------------------------------------------------------------------------- C3D

template <typename T>
T At(const std::string& bytes, std::size_t place) {
  T value{};
  EXPECT_LE(place + sizeof(T), bytes.size());
  std::memcpy(&value, &bytes.at(place), sizeof(T));
  return value;
}

/// Word n of the header, counted from 1.
std::uint16_t HeaderWord(const std::string& bytes, std::size_t number) {
  return At<std::uint16_t>(bytes, 2 * (number - 1));
}

struct C3dParameter {
  int type = 0;
  std::vector<int> shape;
  std::string data;

  [[nodiscard]] int Word(std::size_t i = 0) const { return At<std::int16_t>(data, 2 * i); }
  [[nodiscard]] float Float(std::size_t i = 0) const { return At<float>(data, 4 * i); }
  [[nodiscard]] std::vector<std::string> Texts() const {
    std::vector<std::string> texts;
    const auto length = static_cast<std::size_t>(shape.at(0));
    for (std::size_t i = 0; i < data.size(); i += length) {
      std::string text = data.substr(i, length);
      text.erase(text.find_last_not_of(' ') + 1);
      texts.push_back(text);
    }
    return texts;
  }
};

struct C3dPoint {
  Eigen::Vector3f position;
  float residual = 0.0F;
  int cameras = 0;
};

struct C3d {
  std::map<std::string, C3dParameter> parameters;  // "POINT:USED"
  std::vector<std::vector<C3dPoint>> frames;
};

std::map<std::string, C3dParameter> ReadParameters(const std::string& bytes) {
  const std::size_t section = 512 * (static_cast<std::uint8_t>(bytes.at(0)) - 1U);
  EXPECT_EQ(bytes.at(section + 1), '\x50');
  EXPECT_EQ(static_cast<int>(bytes.at(section + 3)), 84) << "Intel";
  std::map<int, std::string> groups;
  std::map<std::string, C3dParameter> parameters;
  std::vector<std::pair<int, std::pair<std::string, C3dParameter>>> found;
  for (std::size_t at = section + 4;;) {
    const int length = std::abs(At<std::int8_t>(bytes, at));
    const int group = static_cast<int>(At<std::int8_t>(bytes, at + 1));
    if (length == 0) break;
    const std::string name = bytes.substr(at + 2, static_cast<std::size_t>(length));
    const std::size_t place = at + 2 + static_cast<std::size_t>(length);
    const int offset = At<std::int16_t>(bytes, place);
    EXPECT_GE(offset, 0);
    if (group < 0) {
      groups[-group] = name;
    } else {
      C3dParameter parameter;
      parameter.type = static_cast<int>(At<std::int8_t>(bytes, place + 2));
      std::size_t count = 1;
      const auto dimensions = static_cast<std::size_t>(At<std::uint8_t>(bytes, place + 3));
      for (std::size_t d = 0; d < dimensions; ++d) {
        parameter.shape.push_back(At<std::uint8_t>(bytes, place + 4 + d));
        count *= static_cast<std::size_t>(parameter.shape.back());
      }
      parameter.data = bytes.substr(place + 4 + dimensions, count * static_cast<std::size_t>(std::abs(parameter.type)));
      found.push_back({group, {name, parameter}});
    }
    if (offset == 0) break;
    at = place + static_cast<std::size_t>(offset);
  }
  for (const auto& [group, parameter] : found) parameters[groups.at(group) + ':' + parameter.first] = parameter.second;
  return parameters;
}

C3d ReadC3d(const std::string& bytes) {
  C3d c3d;
  EXPECT_EQ(bytes.at(1), '\x50');
  c3d.parameters = ReadParameters(bytes);
  const std::size_t points = HeaderWord(bytes, 2);
  EXPECT_EQ(HeaderWord(bytes, 3), 0) << "analog";
  EXPECT_EQ(HeaderWord(bytes, 4), 1);
  EXPECT_EQ(points, static_cast<std::uint16_t>(c3d.parameters.at("POINT:USED").Word()));
  const float scale = At<float>(bytes, 12);
  EXPECT_LT(scale, 0.0F) << "floats";
  EXPECT_EQ(scale, c3d.parameters.at("POINT:SCALE").Float());
  EXPECT_EQ(At<float>(bytes, 20), c3d.parameters.at("POINT:RATE").Float());
  const std::size_t start = HeaderWord(bytes, 9);
  EXPECT_EQ(start, static_cast<std::uint16_t>(c3d.parameters.at("POINT:DATA_START").Word()));
  const C3dParameter& end = c3d.parameters.at("TRIAL:ACTUAL_END_FIELD");
  const std::size_t frames = static_cast<std::uint16_t>(end.Word(0)) + 65536U * static_cast<std::uint16_t>(end.Word(1));
  EXPECT_EQ(HeaderWord(bytes, 5), std::min<std::size_t>(frames, 65535));
  EXPECT_EQ(bytes.size(), 512 * (start - 1) + 16 * points * frames);
  std::size_t at = 512 * (start - 1);
  for (std::size_t t = 0; t < frames; ++t) {
    auto& frame = c3d.frames.emplace_back();
    for (std::size_t p = 0; p < points; ++p, at += 16) {
      C3dPoint point;
      point.position = {At<float>(bytes, at), At<float>(bytes, at + 4), At<float>(bytes, at + 8)};
      const auto word = static_cast<std::int16_t>(At<float>(bytes, at + 12));
      point.residual = word < 0 ? -1.0F : static_cast<float>(word & 0xFF) * -scale;
      point.cameras = word < 0 ? 0 : word >> 8;
      frame.push_back(point);
    }
  }
  return c3d;
}

TEST(C3dTest, HoldsPositionsGapsResidualsAndCameras) {
  const Scene scene = StaticScene(10);
  std::vector<std::uint8_t> seen(30);
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = static_cast<std::uint8_t>(i % 8);
  const C3d c3d = ReadC3d(C3dBytes(scene, {scene, UpAxis::kZ, FileUnit::kMillimetres}, {seen}));
  EXPECT_THAT(c3d.parameters.at("POINT:LABELS").Texts(), ElementsAre("Hip", "LKnee", "RKnee"));
  EXPECT_THAT(c3d.parameters.at("POINT:DESCRIPTIONS").Texts(), ::testing::SizeIs(3));
  EXPECT_THAT(c3d.parameters.at("POINT:UNITS").Texts(), ElementsAre("mm"));
  EXPECT_EQ(c3d.parameters.at("POINT:RATE").Float(), 50.0F);
  EXPECT_EQ(c3d.parameters.at("POINT:FRAMES").Word(), 10);
  EXPECT_THAT(c3d.parameters.at("POINT:Y_SCREEN").Texts(), ElementsAre("+Z"));
  EXPECT_THAT(c3d.parameters.at("CANONPOSE:PROCESSING").Texts(), ElementsAre("none"));
  EXPECT_EQ(c3d.parameters.at("ANALOG:USED").Word(), 0);
  EXPECT_TRUE(c3d.parameters.at("ANALOG:LABELS").data.empty());
  ASSERT_EQ(c3d.frames.size(), 10U);
  for (int t = 0; t < 10; ++t) {
    for (int j = 0; j < 3; ++j) {
      const C3dPoint& point = c3d.frames[static_cast<std::size_t>(t)][static_cast<std::size_t>(j)];
      if (j == 1 && t % 4 == 3) {
        EXPECT_EQ(point.residual, -1.0F);
        EXPECT_EQ(point.position, Eigen::Vector3f::Zero());
        continue;
      }
      EXPECT_LT((point.position.cast<double>() - PlaceOfJoint(t, j)).norm(), 0.1) << t << j;
      EXPECT_NEAR(point.residual, j == 2 ? 0.0 : 4.0 + 0.01 * t, 0.05) << "the standard deviation, 0 where unknown";
      EXPECT_EQ(point.cameras, (3 * t + j) % 8);
    }
  }
}

TEST(C3dTest, YUpInMetres) {
  const Scene scene = StaticScene(2);
  const C3d c3d = ReadC3d(C3dBytes(scene, {scene, UpAxis::kY, FileUnit::kMetres}, {}));
  EXPECT_THAT(c3d.parameters.at("POINT:UNITS").Texts(), ElementsAre("m"));
  EXPECT_THAT(c3d.parameters.at("POINT:Y_SCREEN").Texts(), ElementsAre("+Y"));
  const Eigen::Vector3d place = PlaceOfJoint(1, 2);
  EXPECT_LT(
      (1000.0 * c3d.frames[1][2].position.cast<double>() - Eigen::Vector3d(place.x(), place.z(), -place.y())).norm(),
      0.1);
  EXPECT_NEAR(1000.0F * c3d.frames[1][0].residual, 4.01F, 0.05F);
}

TEST(C3dTest, SaysWhatIsUnknown) {
  const Scene scene = UnknownScene(2);
  const C3d c3d = ReadC3d(C3dBytes(scene, {scene, UpAxis::kY, FileUnit::kMetres}, {}));
  EXPECT_THAT(c3d.parameters.at("POINT:UNITS").Texts(), ElementsAre("unknown"));
  EXPECT_THAT(c3d.parameters.at("CANONPOSE:UNIT").Texts(), ElementsAre("body lengths"));
  EXPECT_THAT(c3d.parameters.at("CANONPOSE:UP").Texts(), ElementsAre("unknown"));
  EXPECT_FALSE(c3d.parameters.contains("POINT:Y_SCREEN"));
  EXPECT_LT((c3d.frames[1][2].position.cast<double>() - PlaceOfJoint(1, 2)).norm(), 0.1);
}

TEST(C3dTest, SeventyThousandFrames) {
  Scene scene = StaticScene(0);
  scene.people = {MovingPerson("anna", 70'000)};
  const C3d c3d = ReadC3d(C3dBytes(scene, {scene, UpAxis::kZ, FileUnit::kMillimetres}, {}));
  EXPECT_EQ(c3d.parameters.at("POINT:FRAMES").Word(), -1);
  EXPECT_EQ(c3d.parameters.at("POINT:LONG_FRAMES").Float(), 70'000.0F);
  ASSERT_EQ(c3d.frames.size(), 70'000U);
  EXPECT_LT((c3d.frames.back()[0].position.cast<double>() - PlaceOfJoint(69'999, 0)).norm(), 0.1);
  EXPECT_EQ(c3d.frames.back()[1].residual, -1.0F);
}

TEST(C3dTest, ManyPointsWithLongNames) {
  Scene scene = StaticScene(2);
  scene.people.clear();
  Skeleton skeleton;
  for (int j = 0; j < 150; ++j) {
    skeleton.joints.push_back(std::string(130, 'x') + std::to_string(j));
    skeleton.parents.push_back(j - 1);
    skeleton.mirror.push_back(j);
  }
  for (const char* const name : {"anna", "béla", ""}) {
    PoseSequence& person = scene.people.emplace_back(skeleton, 2);
    person.name = name;
    person.fps = 50.0;
    person.unit = LengthUnit::kMillimetres;
    for (float& value : person.positions()) value = static_cast<float>(scene.people.size());
  }
  const C3d c3d = ReadC3d(C3dBytes(scene, {scene, UpAxis::kZ, FileUnit::kMillimetres}, {}));
  std::vector<std::string> labels = c3d.parameters.at("POINT:LABELS").Texts();
  EXPECT_EQ(labels.size(), 255U);
  const std::vector<std::string> more = c3d.parameters.at("POINT:LABELS2").Texts();
  EXPECT_EQ(more.size(), 195U);
  labels.insert(labels.end(), more.begin(), more.end());
  EXPECT_THAT(labels[0], ::testing::StartsWith("anna:xxx"));
  EXPECT_THAT(labels[150], ::testing::StartsWith("b__la:xxx"));
  EXPECT_THAT(labels[300], ::testing::StartsWith("person3:xxx"));
  for (const std::string& label : labels) EXPECT_LE(label.size(), 127U);
  EXPECT_EQ(std::set<std::string>(labels.begin(), labels.end()).size(), 450U);
  EXPECT_EQ(c3d.frames[1][449].position.x(), 3.0F);
}

// ---------------------------------------------------------------------------------------------------------------- npz

TEST(SceneNpz, ArraysOfPeopleAndCameras) {
  const TemporaryFolder folder;
  Scene scene = StaticScene(4);
  scene.people.push_back(MovingPerson("béla", 4, 300.0));
  scene.cameras[2].calibration.clear();
  WriteSceneNpz(folder / "a.npz", scene, {scene, UpAxis::kZ, FileUnit::kMetres});
  const NpzReader reader(folder / "a.npz");
  std::vector<std::size_t> shape;
  const std::vector<float> positions = reader.ReadFloats("positions", &shape);
  EXPECT_THAT(shape, ElementsAre(2, 4, 3, 3));
  EXPECT_NEAR(positions[36 + 9 * 2], 1e-3 * (PlaceOfJoint(2, 0).x() + 300.0), 1e-6);
  EXPECT_TRUE(std::isnan(positions[9 * 3 + 3]));
  EXPECT_NEAR(reader.ReadFloats("standard_deviation", &shape)[0], 0.004, 1e-7);
  EXPECT_THAT(shape, ElementsAre(2, 4, 3));
  EXPECT_THAT(reader.ReadStrings("people"), ElementsAre("anna", "béla"));
  EXPECT_THAT(reader.ReadStrings("unit"), ElementsAre("m"));
  EXPECT_THAT(reader.ReadStrings("up"), ElementsAre("z"));
  EXPECT_THAT(reader.ReadFloats("time", &shape), ElementsAre(0.0F, 0.02F, 0.04F, 0.06F));
  const std::vector<float> K = reader.ReadFloats("K", &shape);
  EXPECT_THAT(shape, ElementsAre(3, 3, 3));
  EXPECT_EQ(K[2], 955.5F);
  EXPECT_TRUE(std::isnan(K[18]));
  scene.cameras[1].calibration.assign(4, scene.cameras[1].calibration[0]);
  WriteSceneNpz(folder / "b.npz", scene, {scene, UpAxis::kZ, FileUnit::kMetres});
  (void)NpzReader(folder / "b.npz").ReadFloats("t", &shape);
  EXPECT_THAT(shape, ElementsAre(3, 4, 3)) << "one of the cameras moves";
}

TEST(SceneNpz, DifferentJointsAreRefused) {
  const TemporaryFolder folder;
  Scene scene = StaticScene(4);
  scene.people.emplace_back(Skeleton{"", {"Head"}, {-1}, 0, {0}}, 4);
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] {
                        WriteSceneNpz(folder / "a.npz", scene, {scene, UpAxis::kZ, FileUnit::kMetres});
                      }),
              HasSubstr("`person`"));
}

}  // namespace
}  // namespace canonpose
