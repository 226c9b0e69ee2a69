#include "canonpose/scene/world.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/scene/world_testing.h"

namespace canonpose {
namespace {

using testing::Disguise;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::Hide;
using testing::MakeCameras;
using testing::MakePerson;
using ::testing::Not;
using testing::Posture;
using testing::Walk;

constexpr double kStatureMm = 1750.0;

Scene MakeScene(const std::vector<Posture>& postures, std::vector<SceneCamera> cameras) {
  Scene scene;
  scene.people = {MakePerson(postures, kStatureMm)};
  scene.cameras = std::move(cameras);
  return scene;
}

WorldPlacement Find(const Scene& scene, const WorldMeasures& measures = {}) {
  return FindWorld(std::span(&scene, 1), measures);
}

WorldMeasures OfHeight(double mm) { return {{{"", mm}}, {}}; }

/// The angle between the up that was found and the true one, which is z before the scene was hidden.
double UpErrorDeg(const WorldPlacement& world, int frame = 0, const Disguise& disguise = {}) {
  return DegFromRad(std::acos(std::min(1.0, (world.RotationAt(frame) * disguise.rotation.col(2)).z())));
}

/// How high the point of the true floor below a place is in the world that was found, mm if the scale is right.
double FloorErrorMm(const WorldPlacement& world, const Eigen::Vector2d& place_mm, const Disguise& disguise = {}) {
  const Eigen::Vector3d on_floor(place_mm.x(), place_mm.y(), 0.0);
  return world.Apply(0, disguise.scale * disguise.rotation * on_floor + disguise.translation).z() /
         (world.scale * disguise.scale);
}

TEST(World, IsFoundExactlyInAnExactScene) {
  const WorldPlacement world = Find(Hide(MakeScene(Walk(), MakeCameras())), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 0.01);
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(-1000, -1000), Eigen::Vector2d(1000, 1000)}) {
    EXPECT_NEAR(FloorErrorMm(world, place), 0.0, 0.5);
  }
  EXPECT_NEAR(world.scale * Disguise().scale, 1.0, 1e-5);
  EXPECT_EQ(world.unit, LengthUnit::kMillimetres);
  EXPECT_THAT(world.known.up.source, HasSubstr("feet that stand still"));
  EXPECT_THAT(world.known.floor.source, HasSubstr("a foot stands still"));
  EXPECT_THAT(world.known.floor.source, HasSubstr("only ankles are known"));
  EXPECT_THAT(world.known.scale.source, HasSubstr("1.75 m"));
  EXPECT_LT(world.known.up.uncertainty, 1.5);
  EXPECT_LT(world.known.floor.uncertainty, 20.0);
}

TEST(World, PeopleAndCamerasMoveTogether) {
  const Scene truth = MakeScene(Walk(), MakeCameras());
  Scene placed = Hide(truth);
  PlaceInWorld(Find(placed, OfHeight(kStatureMm)), placed);
  placed.Validate();
  const PoseSequence& person = placed.people[0];
  EXPECT_EQ(person.unit, LengthUnit::kMillimetres);
  EXPECT_NEAR(person.standard_deviation()[0], 5.0F, 1e-3F);
  // Below the first pose is the origin, on the floor stand the feet, and x is to the right in the first camera.
  const int root = person.skeleton().root;
  EXPECT_NEAR(person.PoseAt(0)(root, 0), 0.0F, 0.1F);
  EXPECT_NEAR(person.PoseAt(0)(root, 1), 0.0F, 0.1F);
  EXPECT_NEAR(person.PoseAt(0)(root, 2), 0.53F * kStatureMm, 1.0F);
  const Eigen::Vector3d right = placed.cameras[0].calibration[0].camera_from_world_rotation.row(0);
  EXPECT_NEAR(right.x(), 1.0, 1e-3);
  for (const int t : {0, 77, person.frame_count() - 1}) {
    for (int j = 0; j < person.joint_count(); ++j) {
      const auto pixel = [&](const Scene& scene) {
        return scene.cameras[2].calibration[0].Project(scene.people[0].PoseAt(t).row(j).transpose().cast<double>());
      };
      EXPECT_LT((pixel(placed) - pixel(truth)).norm(), 0.05) << t << " " << j;
    }
  }
  // Where she walks is in it: two metres from the first place to the second.
  const int second = 39;
  EXPECT_NEAR((person.PoseAt(second).row(root) - person.PoseAt(0).row(root)).norm(), 2000.0F, 1.0F);
}

TEST(World, FeetOutweighCamerasThatAreNotLevel) {
  const WorldPlacement world = Find(Hide(MakeScene(Walk(), MakeCameras({4, 3, 5, 4}, 3500.0))), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 1.0);
  EXPECT_NEAR(FloorErrorMm(world, {1000, -1000}), 0.0, 25.0);
  EXPECT_THAT(world.known.up.source, HasSubstr("feet"));
}

TEST(World, ACameraOnItsSideDoesNotCount) {
  EXPECT_LT(UpErrorDeg(Find(Hide(MakeScene(Walk(), MakeCameras({0, 90, 0, 0}))))), 0.5);
}

TEST(World, PeopleOutweighTwoCamerasThatHangUpsideDown) {
  const std::vector<SceneCamera> cameras = {testing::MakeCamera("a", {5000, 0, 1500}, std::numbers::pi),
                                            testing::MakeCamera("b", {0, 5000, 1500}, std::numbers::pi)};
  EXPECT_LT(UpErrorDeg(Find(Hide(MakeScene(Walk(), cameras)))), 1.0);
}

TEST(World, SomebodySitsAllTheTime) {
  Posture sitting;
  sitting.knees_rad = std::numbers::pi / 2;
  sitting.lean_rad = RadFromDeg(20.0);
  const WorldPlacement world =
      Find(Hide(MakeScene(std::vector<Posture>(60, sitting), MakeCameras())), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 1.0);
  EXPECT_NEAR(FloorErrorMm(world, {0, 0}), 0.0, 5.0);
  EXPECT_NEAR(world.scale * Disguise().scale, 1.0, 1e-5);
  EXPECT_THAT(world.known.up.source, Not(HasSubstr("upright")));
}

TEST(World, AFootThatIsHeldUpIsNotOnTheFloor) {
  std::vector<Posture> postures(90);
  for (std::size_t t = 20; t < 90; ++t) postures[t].right_foot_mm = 300.0;
  const WorldPlacement world = Find(Hide(MakeScene(postures, MakeCameras())), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 0.5);
  EXPECT_NEAR(FloorErrorMm(world, {0, 0}), 0.0, 5.0);
}

TEST(World, WhereNoFootStandsStillTheLowestPositionsAreTheFloor) {
  std::vector<Posture> gliding;
  for (int t = 0; t < 60; ++t) gliding.push_back({{50.0 * t, 0.0}});
  const WorldPlacement world = Find(Hide(MakeScene(gliding, MakeCameras())), OfHeight(kStatureMm));
  EXPECT_NEAR(FloorErrorMm(world, {0, 0}), 0.0, 5.0);
  EXPECT_THAT(world.known.floor.source, HasSubstr("none ever stands still"));
  EXPECT_GT(world.known.floor.uncertainty, 40.0);
}

TEST(World, WithoutFeetTheFloorIsUnknown) {
  Scene scene = MakeScene(Walk(), MakeCameras());
  PoseSequence& person = scene.people[0];
  for (int t = 0; t < person.frame_count(); ++t) {
    for (const char* joint : {"LFoot", "RFoot", "LKnee", "RKnee"}) {
      person.PoseAt(t).row(*person.skeleton().Find(joint)).setConstant(std::nanf(""));
    }
  }
  const WorldPlacement world = Find(Hide(scene), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 0.5);
  EXPECT_FALSE(world.known.floor.is_known());
  EXPECT_NEAR(world.scale * Disguise().scale, 1.0, 1e-5);
  EXPECT_GT(world.known.scale.uncertainty, 3.0);
}

TEST(World, WithoutAHeightTheUnitStays) {
  const WorldPlacement world = Find(Hide(MakeScene(Walk(), MakeCameras())));
  EXPECT_EQ(world.scale, 1.0);
  EXPECT_EQ(world.unit, LengthUnit::kBodyLengths);
  EXPECT_FALSE(world.known.scale.is_known());
  EXPECT_TRUE(world.known.floor.is_known());
  EXPECT_LT(world.known.floor.uncertainty, 0.005);  // about 20 mm over 4321 mm
}

TEST(World, DistancesOfCamerasTellTheScale) {
  const Scene scene = Hide(MakeScene(Walk(), MakeCameras()));
  const double opposite_mm = 10000.0;
  EXPECT_NEAR(Find(scene, {{}, {{"cam1", "cam3", opposite_mm}}}).scale * Disguise().scale, 1.0, 1e-6);
  const WorldPlacement two = Find(scene, {{}, {{"cam1", "cam3", opposite_mm}, {"cam2", "cam4", 1.02 * opposite_mm}}});
  EXPECT_NEAR(two.scale * Disguise().scale, 1.01, 1e-6);
  EXPECT_NEAR(two.known.scale.uncertainty, 1.0, 0.05);
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] {
                        Find(scene, {{}, {{"cam1", "camx", 1.0}}});
                      }),
              HasSubstr("cam1, cam2, cam3, cam4"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] {
                        Find(scene, {{{"", 1750.0}}, {{"cam1", "cam3", 1.0}}});
                      }),
              HasSubstr("give one"));
}

TEST(World, HeightsOfSeveralPeopleAreWeighed) {
  Scene scene = MakeScene(Walk(), MakeCameras());
  scene.people.push_back(MakePerson(Walk(), 1600.0));
  scene.people.back().name = "Bob";
  const Scene hidden = Hide(scene);
  const WorldPlacement world = Find(hidden, {{{"Ann", 1.02 * kStatureMm}, {"Bob", 1600.0}}, {}});
  EXPECT_NEAR(world.scale * Disguise().scale, 1.01, 1e-4);
  EXPECT_THAT(world.known.scale.source, HasSubstr("1.6 m (Bob)"));
  EXPECT_NEAR(Find(hidden, {{{"Bob", 1600.0}}, {}}).scale * Disguise().scale, 1.0, 1e-5);
}

TEST(World, ClipsOfTheSameCamerasShareIt) {
  std::vector<Posture> far_away = Walk();
  for (Posture& posture : far_away) posture.place_mm += Eigen::Vector2d(500, 700);
  const std::vector<Scene> scenes = {Hide(MakeScene(Walk(), MakeCameras())), Hide(MakeScene(far_away, MakeCameras()))};
  const WorldPlacement world = FindWorld(scenes, OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 0.01);
  Scene second = scenes[1];
  PlaceInWorld(world, second);
  EXPECT_NEAR(second.people[0].PoseAt(0).row(0).head<2>().norm(), Eigen::Vector2d(500, 700).norm(), 1.0);
}

/// As the solver finds it: centred on the root in every frame, with axes that drift.
Scene SeenByMovingCameras(double degrees_per_frame, std::vector<Disguise>& disguises) {
  const std::vector<Posture> walk = Walk();
  Scene scene = MakeScene(walk, MakeCameras());
  const PoseSequence person = scene.people[0];
  for (SceneCamera& camera : scene.cameras) camera.calibration.resize(walk.size(), camera.calibration[0]);
  for (int t = 0; t < person.frame_count(); ++t) {
    Disguise now;
    const Eigen::Vector3d axis = Eigen::Vector3d(1, 0.3, 0.2).normalized();
    now.rotation = Eigen::AngleAxisd(RadFromDeg(degrees_per_frame * t), axis).toRotationMatrix() * now.rotation;
    const Eigen::Vector3d root = person.PoseAt(t).row(person.skeleton().root).transpose().cast<double>();
    now.translation = -now.scale * now.rotation * root;
    Scene frame = scene;
    frame.people[0].KeepFrames(t, t);
    for (SceneCamera& camera : frame.cameras) camera.calibration = {camera.At(t)};
    frame = Hide(frame, now);
    scene.people[0].PoseAt(t) = frame.people[0].PoseAt(0);
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      scene.cameras[c].calibration[static_cast<std::size_t>(t)] = frame.cameras[c].calibration[0];
    }
    disguises.push_back(now);
  }
  scene.people[0].unit = LengthUnit::kBodyLengths;
  return scene;
}

TEST(World, OfMovingCamerasHasUpInEveryFrameButNoFloor) {
  std::vector<Disguise> disguises;
  Scene scene = SeenByMovingCameras(0.05, disguises);
  const WorldPlacement world = Find(scene, OfHeight(kStatureMm));
  ASSERT_EQ(world.rotations.size(), disguises.size());
  for (std::size_t t = 0; t < disguises.size(); ++t) {
    EXPECT_LT(UpErrorDeg(world, static_cast<int>(t), disguises[t]), 1.0) << t;
  }
  EXPECT_THAT(world.known.up.source, HasSubstr("frame by frame"));
  EXPECT_FALSE(world.known.floor.is_known());
  EXPECT_NEAR(world.scale * Disguise().scale, 1.0, 1e-5);
  const Scene before = scene;
  PlaceInWorld(world, scene);
  scene.Validate();
  const PoseSequence& person = scene.people[0];
  for (const int t : {0, 50, person.frame_count() - 1}) {
    EXPECT_NEAR(person.PoseAt(t)(*person.skeleton().Find("LFoot"), 2), kAnkleHeight * kStatureMm, 3.0) << t;
    EXPECT_NEAR(person.PoseAt(t).row(0).head<2>().norm(), 0.0, 1e-3) << t;
    for (int j = 0; j < person.joint_count(); ++j) {
      const auto pixel = [&](const Scene& one) {
        return one.cameras[1].At(t).Project(one.people[0].PoseAt(t).row(j).transpose().cast<double>());
      };
      EXPECT_LT((pixel(scene) - pixel(before)).norm(), 0.05) << t << " " << j;
    }
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [&] {
                        Find(before, {{}, {{"cam1", "cam3", 1.0}}});
                      }),
              HasSubstr("stand still"));
}

TEST(World, OfAnAnimalIsFromTheCamerasAlone) {
  Scene scene = MakeScene(Walk(), MakeCameras());
  Skeleton dog = scene.people[0].skeleton();
  for (std::size_t j = 0; j < dog.joints.size(); ++j) dog.joints[j] = "point" + std::to_string(j);
  PoseSequence renamed(dog, scene.people[0].positions());
  scene.people[0] = renamed;
  scene.people[0].unit = LengthUnit::kMillimetres;
  const WorldPlacement world = Find(Hide(scene), OfHeight(kStatureMm));
  EXPECT_LT(UpErrorDeg(world), 0.5);
  EXPECT_EQ(world.known.up.source, "cameras held level");
  EXPECT_FALSE(world.known.floor.is_known());
  EXPECT_FALSE(world.known.scale.is_known());
}

TEST(KnownHeight, IsInMetresWithOrWithoutAName) {
  EXPECT_EQ(KnownHeight::Parse("1.75").height_mm, 1750.0);
  EXPECT_EQ(KnownHeight::Parse("1.75").person, "");
  EXPECT_EQ(KnownHeight::Parse("Ann=B=1.6").person, "Ann=B");
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { KnownHeight::Parse("175"); }), HasSubstr("give 1.75"));
  for (const char* text : {"", "tall", "=1.75", "Ann=", "1.75m", "nan"}) {
    ErrorOf(ErrorKind::kInvalidArgument, [&] { KnownHeight::Parse(text); });
  }
}

TEST(KnownDistance, IsOfTwoCameras) {
  const KnownDistance known = KnownDistance::Parse("left,right=4.25");
  EXPECT_EQ(known.camera, "left");
  EXPECT_EQ(known.other, "right");
  EXPECT_EQ(known.distance_mm, 4250.0);
  for (const char* text : {"4.2", "left=4.2", "left,left=4.2", "left,right", "left,right=0", ",right=1", "a,b=inf"}) {
    ErrorOf(ErrorKind::kInvalidArgument, [&] { KnownDistance::Parse(text); });
  }
}

}  // namespace
}  // namespace canonpose
