#include "canonpose/scene/scene.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

PoseSequence Person(const std::string& name, int frames) {
  PoseSequence person({"", {"root", "left", "right"}, {-1, 0, 0}, 0, {0, 2, 1}}, frames);
  person.name = name;
  person.unit = LengthUnit::kMillimetres;
  person.fps = 25.0;
  for (std::size_t i = 0; i < person.positions().size(); ++i) person.positions()[i] = 0.5F * static_cast<float>(i);
  person.positions()[3] = person.positions()[4] = person.positions()[5] = std::nanf("");
  person.confidence().assign(person.confidence().size(), 0.75F);
  person.confidence()[1] = 0.0F;
  person.standard_deviation()[2] = 12.0F;
  return person;
}

/// Eleven people, so that their numbers do not sort as text, a static, a moving and an unknown camera.
Scene ManyPeople() {
  Scene scene;
  scene.name = "dance";
  scene.up = {"the cameras' axes", 0.75};
  scene.floor.source = "its feet";
  for (int i = 0; i < 11; ++i) scene.people.push_back(Person("person " + std::to_string(i), 4));
  for (PoseSequence& person : scene.people) person.time_seconds = {0.0, 0.04, 0.08, 0.5};
  SceneCamera still;
  still.name = "still";
  still.image_size_px = {1920, 1080};
  still.calibration.resize(1);
  still.calibration[0].K << 1000, 0, 960, 0, 1010, 540, 0, 0, 1;
  still.calibration[0].camera_from_world_rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).matrix();
  still.calibration[0].distortion = {0.1, -0.2, 0.01, 0.02, 0.3};
  SceneCamera moving = still;
  moving.name = "moving";
  moving.time_offset_seconds = -0.02;
  moving.calibration.assign(4, still.calibration[0]);
  for (int t = 0; t < 4; ++t) moving.calibration[static_cast<std::size_t>(t)].K(0, 0) += t;
  SceneCamera lost;
  lost.name = "lost";
  lost.used = false;
  lost.why_not_used = "it saw somebody else";
  scene.cameras = {still, moving, lost};
  return scene;
}

/// Equal, NaN included.
void ExpectSame(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) << i;
  }
}

TEST(SceneFile, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const Scene written = ManyPeople();
  WriteScene(folder / "scene.h5", written);
  ASSERT_TRUE(IsSceneFile(folder / "scene.h5"));
  const Scene read = ReadScene(folder / "scene.h5");
  EXPECT_EQ(read.name, "dance");
  EXPECT_EQ(read.up.source, "the cameras' axes");
  EXPECT_EQ(read.up.uncertainty, 0.75);
  EXPECT_EQ(read.floor.source, "its feet");
  EXPECT_TRUE(std::isnan(read.floor.uncertainty));
  EXPECT_FALSE(read.scale.is_known());
  ASSERT_EQ(read.people.size(), written.people.size());
  for (std::size_t i = 0; i < read.people.size(); ++i) {
    EXPECT_EQ(read.people[i].name, written.people[i].name);
    EXPECT_EQ(read.people[i].skeleton().joints, written.people[i].skeleton().joints);
    EXPECT_EQ(read.people[i].unit, LengthUnit::kMillimetres);
    EXPECT_EQ(read.people[i].time_seconds, written.people[i].time_seconds);
    ExpectSame(read.people[i].positions(), written.people[i].positions());
    ExpectSame(read.people[i].confidence(), written.people[i].confidence());
    ExpectSame(read.people[i].standard_deviation(), written.people[i].standard_deviation());
  }
  ASSERT_EQ(read.cameras.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(read.cameras[c].name, written.cameras[c].name);
    EXPECT_EQ(read.cameras[c].image_size_px, written.cameras[c].image_size_px);
    EXPECT_EQ(read.cameras[c].time_offset_seconds, written.cameras[c].time_offset_seconds);
    EXPECT_EQ(read.cameras[c].used, written.cameras[c].used);
    EXPECT_EQ(read.cameras[c].why_not_used, written.cameras[c].why_not_used);
    ASSERT_EQ(read.cameras[c].calibration.size(), written.cameras[c].calibration.size());
    for (std::size_t t = 0; t < read.cameras[c].calibration.size(); ++t) {
      EXPECT_EQ(read.cameras[c].calibration[t].K, written.cameras[c].calibration[t].K);
      EXPECT_EQ(read.cameras[c].calibration[t].distortion, written.cameras[c].calibration[t].distortion);
    }
  }
}

TEST(SceneFile, OtherFilesAreNotScenes) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "text", "hello");
  EXPECT_FALSE(IsSceneFile(folder / "text"));
  h5::File file = h5::File::CreateAt(folder / "other.h5");
  file.root().SetString("format", "canonpose-dataset");
  file.Commit();
  EXPECT_FALSE(IsSceneFile(folder / "other.h5"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadScene(folder / "other.h5"); }), HasSubstr("canonpose-scene"));
}

TEST(SceneFile, ALaterVersionSaysSo) {
  const TemporaryFolder folder;
  h5::File file = h5::File::CreateAt(folder / "later.h5");
  file.root().SetString("format", "canonpose-scene");
  file.root().SetInt("version", 2);
  file.Commit();
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadScene(folder / "later.h5"); }), HasSubstr("newer version"));
}

TEST(Scene, PeopleMustShareUnitFramesAndTimes) {
  Scene scene;
  scene.people = {Person("a", 3), Person("b", 3)};
  EXPECT_NO_THROW(scene.Validate());
  scene.people[1].unit = LengthUnit::kBodyLengths;
  EXPECT_THROW(scene.Validate(), std::logic_error);
  scene.people[1] = Person("b", 4);
  EXPECT_THROW(scene.Validate(), std::logic_error);
  scene.people[1] = Person("b", 3);
  scene.people[1].coordinate_frame = {CoordinateFrame::Kind::kCamera, "cam1"};
  EXPECT_THROW(scene.Validate(), std::logic_error);
  scene.people.pop_back();
  scene.cameras.emplace_back().calibration.resize(2);
  EXPECT_THROW(scene.Validate(), std::logic_error);
}

}  // namespace
}  // namespace canonpose
