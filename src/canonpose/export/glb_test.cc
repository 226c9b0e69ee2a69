#include "canonpose/export/glb.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <tiny_gltf.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/export/bvh.h"
#include "canonpose/motion/channels.h"
#include "canonpose/motion/hierarchy_testing.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/readers/bvh.h"

namespace canonpose {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::AllOf;
using testing::CollectedMessages;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int kFrames = 60;

/// A camera at `position` that looks at `target`, upright; mm with z up.
SceneCamera LookAt(const std::string& name, const Vector3d& position, const Vector3d& target) {
  SceneCamera camera;
  camera.name = name;
  camera.image_size_px = {1280, 720};
  Camera calibration;
  calibration.K << 900.0, 0.0, 640.0, 0.0, 900.0, 360.0, 0.0, 0.0, 1.0;
  const Vector3d z = (target - position).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  calibration.camera_from_world_rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  calibration.camera_from_world_translation = -calibration.camera_from_world_rotation * position;
  camera.calibration.push_back(calibration);
  return camera;
}

/// People who walk on the floor, two cameras that stand and one that moves; in millimetres, up is known.
Scene MakeScene(int people) {
  Scene scene;
  scene.name = "walk";
  scene.up.source = "the test";
  scene.scale.source = "the test";
  const Skeleton& skeleton = *FindSkeleton("body_25");
  for (int i = 0; i < people; ++i) {
    HierarchyFit truth = testing::TPoseHierarchy(skeleton, JointNames::kOurs);
    testing::Animate(kFrames, 1.3 * i, truth);
    for (Vector3d& root : truth.motion.root_position_mm) root.x() += 1200.0 * i;
    scene.people.push_back(testing::PosesOf(truth, skeleton));
    scene.people.back().name = i == 0 ? "anna" : "bo/b";
  }
  scene.cameras.push_back(LookAt("left", {4000, -3000, 1600}, {300, 0, 900}));
  scene.cameras.push_back(LookAt("right", {-3000, -3500, 1500}, {300, 0, 900}));
  SceneCamera moving = LookAt("moving", {0, 5000, 1500}, {0, 0, 900});
  for (int t = 1; t < kFrames; ++t)
    moving.calibration.push_back(LookAt("", {20.0 * t, 5000, 1500}, {0, 0, 900}).calibration.front());
  scene.cameras.push_back(moving);
  return scene;
}

/// A file as tinygltf reads it, with the positions of its nodes at any frame.
class GlbFile {
 public:
  explicit GlbFile(const std::filesystem::path& path) {
    std::string error;
    std::string warning;
    EXPECT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path.string())) << error;
    EXPECT_EQ(error + warning, "");
    parents_.assign(model.nodes.size(), -1);
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
      for (const int child : model.nodes[i].children) parents_[static_cast<std::size_t>(child)] = static_cast<int>(i);
    }
  }

  [[nodiscard]] std::vector<float> Floats(int accessor_index) const {
    const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(accessor_index));
    EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
    const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
    const auto width =
        static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
    std::vector<float> values(accessor.count * width);
    std::memcpy(values.data(), &model.buffers[0].data.at(view.byteOffset + accessor.byteOffset),
                values.size() * sizeof(float));
    return values;
  }

  [[nodiscard]] int Find(const std::string& name) const {
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
      if (model.nodes[i].name == name) return static_cast<int>(i);
    }
    ADD_FAILURE() << "no node " << name;
    return 0;
  }

  /// world_from_node; in the rest pose where frame < 0.
  [[nodiscard]] Isometry3d At(int node, int frame) const {
    const tinygltf::Node& own = model.nodes.at(static_cast<std::size_t>(node));
    Vector3d translation = Vector3d::Zero();
    Quaterniond rotation = Quaterniond::Identity();
    if (!own.translation.empty()) translation = Vector3d(own.translation.data());
    if (!own.rotation.empty()) rotation = Quaterniond(own.rotation.data());
    for (const tinygltf::AnimationChannel& channel : model.animations.at(0).channels) {
      if (channel.target_node != node || frame < 0) continue;
      const std::vector<float> values =
          Floats(model.animations[0].samplers[static_cast<std::size_t>(channel.sampler)].output);
      const auto at = static_cast<std::size_t>(frame);
      if (channel.target_path == "translation") {
        translation = Eigen::Vector3f(&values.at(3 * at)).cast<double>();
      } else {
        rotation = Eigen::Quaternionf(&values.at(4 * at)).cast<double>();
      }
    }
    const Isometry3d local = Eigen::Translation3d(translation) * rotation.normalized();
    const int parent = parents_[static_cast<std::size_t>(node)];
    return parent < 0 ? local : At(parent, frame) * local;
  }

  tinygltf::Model model;

 private:
  std::vector<int> parents_;
};

Vector3d MmInFile(const Vector3d& z_up_mm) { return 0.001 * YUpFromZUp(z_up_mm); }

TEST(WriteSceneGlb, JointsAreWhereTheHierarchiesHaveThem) {
  const Scene scene = MakeScene(2);
  const TemporaryFolder folder;
  WriteSceneGlb(folder / "walk.glb", scene, {JointNames::kMixamo});
  const GlbFile file(folder / "walk.glb");
  const SceneMotion motion = MakeSceneMotion(scene, {JointNames::kMixamo});
  ASSERT_EQ(file.model.skins.size(), 2U);
  std::vector<Vector3d> positions;
  std::vector<Quaterniond> rotations;
  for (std::size_t person = 0; person < 2; ++person) {
    const HierarchyFit& fit = motion.people[person];
    const tinygltf::Skin& skin = file.model.skins[person];
    EXPECT_EQ(skin.name, person == 0 ? "anna" : "bo/b");
    ASSERT_EQ(skin.joints.size(), fit.motion.joints.size());
    const std::vector<float> binds = file.Floats(skin.inverseBindMatrices);
    for (const int frame : {0, 17, kFrames - 1}) {
      ForwardKinematics(fit.motion, frame, positions, rotations);
      for (std::size_t j = 0; j < positions.size(); ++j) {
        EXPECT_EQ(file.model.nodes[static_cast<std::size_t>(skin.joints[j])].name, fit.motion.joints[j].name);
        const Isometry3d node = file.At(skin.joints[j], frame);
        EXPECT_LT((node.translation() - MmInFile(positions[j])).norm(), 1e-5) << fit.motion.joints[j].name;
      }
    }
    for (std::size_t j = 0; j < positions.size(); ++j) {
      const Isometry3d rest = file.At(skin.joints[j], -1);
      const Eigen::Matrix4d bind = Eigen::Map<const Eigen::Matrix4f>(&binds[16 * j]).cast<double>();
      EXPECT_TRUE((bind * rest.matrix()).isIdentity(1e-6)) << j;
    }
  }
}

TEST(WriteSceneGlb, TimesRiseAndChannelsAreUnique) {
  Scene scene = MakeScene(1);
  for (int t = 0; t < kFrames; ++t) scene.people[0].time_seconds.push_back(12.5 + 0.02 * t + (t > 30 ? 0.01 : 0.0));
  const TemporaryFolder folder;
  WriteSceneGlb(folder / "walk.glb", scene, {});
  const GlbFile file(folder / "walk.glb");
  ASSERT_EQ(file.model.animations.size(), 1U);
  std::map<std::pair<int, std::string>, int> channels;
  for (const tinygltf::AnimationChannel& channel : file.model.animations[0].channels)
    EXPECT_EQ(++channels[std::pair(channel.target_node, channel.target_path)], 1);
  const int input = file.model.animations[0].samplers[0].input;
  const std::vector<float> times = file.Floats(input);
  ASSERT_EQ(times.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(times[0], 0.0F);
  EXPECT_NEAR(times[40], 0.81, 1e-5);
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end(), std::less_equal<>()));
  const tinygltf::Accessor& accessor = file.model.accessors[static_cast<std::size_t>(input)];
  EXPECT_EQ(accessor.minValues, std::vector<double>{times.front()});
  EXPECT_EQ(accessor.maxValues, std::vector<double>{times.back()});
}

/// Where a camera of the file sees a point, as a viewer computes it: pixels of an image of this size.
Eigen::Vector2d PixelInViewer(const GlbFile& file, const std::string& name, int frame, const Vector3d& metres,
                              double width, double height) {
  const int node = file.Find(name);
  const tinygltf::PerspectiveCamera& lens =
      file.model.cameras.at(static_cast<std::size_t>(file.model.nodes[static_cast<std::size_t>(node)].camera))
          .perspective;
  const Vector3d in_camera = file.At(node, frame).inverse() * metres;
  const double focal = 1.0 / std::tan(0.5 * lens.yfov);
  const double x = focal / lens.aspectRatio * in_camera.x() / -in_camera.z();
  const double y = focal * in_camera.y() / -in_camera.z();
  return {0.5 * width * (1.0 + x), 0.5 * height * (1.0 - y)};
}

TEST(WriteSceneGlb, CamerasSeeWhatOursSee) {
  const Scene scene = MakeScene(1);
  const TemporaryFolder folder;
  WriteSceneGlb(folder / "walk.glb", scene, {});
  const GlbFile file(folder / "walk.glb");
  const Vector3d point(250, 130, 1200);
  for (const SceneCamera& camera : scene.cameras) {
    for (const int frame : {0, 45}) {
      const Eigen::Vector2d ours = camera.At(frame).Project(point);
      const Eigen::Vector2d theirs = PixelInViewer(file, camera.name, frame, MmInFile(point), 1280, 720);
      EXPECT_LT((ours - theirs).norm(), 0.05) << camera.name << " " << frame;
    }
  }
}

TEST(WriteSceneGlb, LeftIsBlueAndRightVermilion) {
  const TemporaryFolder folder;
  WriteSceneGlb(folder / "walk.glb", MakeScene(1), {});
  const GlbFile file(folder / "walk.glb");
  const auto mesh = static_cast<std::size_t>(file.model.nodes[static_cast<std::size_t>(file.Find("anna body"))].mesh);
  const Vector3d root = file.At(file.Find("Hip"), -1).translation();
  int sides = 0;
  for (const tinygltf::Primitive& primitive : file.model.meshes[mesh].primitives) {
    const tinygltf::Material& material = file.model.materials[static_cast<std::size_t>(primitive.material)];
    const std::vector<float> positions = file.Floats(primitive.attributes.at("POSITION"));
    double mean = 0.0;
    for (std::size_t i = 0; i < positions.size(); i += 3) mean += (positions[i] - root.x()) * 3.0 / positions.size();
    const std::vector<double>& colour = material.pbrMetallicRoughness.baseColorFactor;
    if (material.name == "left") {
      EXPECT_GT(mean, 0.1);  // looking along z, the left is x
      EXPECT_GT(colour[2], 4.0 * colour[0]);
      ++sides;
    } else if (material.name == "right") {
      EXPECT_LT(mean, -0.1);
      EXPECT_GT(colour[0], 4.0 * colour[2]);
      ++sides;
    }
  }
  EXPECT_EQ(sides, 2);
}

TEST(WriteSceneGlb, UnknownUpAndScaleAreTakenFromThePeopleAndSaid) {
  Scene scene = MakeScene(1);
  scene.cameras.resize(1);
  // A world on its side, in a unit of 4 m.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.4, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  PoseSequence& person = scene.people[0];
  for (int t = 0; t < kFrames; ++t) {
    for (int j = 0; j < person.joint_count(); ++j) {
      const Vector3d mm = person.PoseAt(t).row(j).transpose().cast<double>();
      person.PoseAt(t).row(j) = (turn * mm / 4000.0).transpose().cast<float>();
    }
  }
  Camera& camera = scene.cameras[0].calibration[0];
  camera.camera_from_world_rotation = camera.camera_from_world_rotation * turn.transpose();
  camera.camera_from_world_translation /= 4000.0;
  person.unit = LengthUnit::kBodyLengths;
  scene.up = {};
  scene.scale = {};
  const TemporaryFolder folder;
  const CollectedMessages messages;
  WriteSceneGlb(folder / "walk.glb", scene, {});
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("1.70 m tall"), HasSubstr("which way is up")));
  const GlbFile file(folder / "walk.glb");
  EXPECT_THAT(file.model.scenes[0].extras.Get("scale").Get<std::string>(), HasSubstr("unknown"));
  for (const tinygltf::Node& node : file.model.nodes) EXPECT_NE(node.name, "floor");
  const Vector3d ankles =
      0.5 * (file.At(file.Find("LFoot"), 20).translation() + file.At(file.Find("RFoot"), 20).translation());
  const Vector3d shoulders =
      0.5 * (file.At(file.Find("LShoulder"), 20).translation() + file.At(file.Find("RShoulder"), 20).translation());
  EXPECT_GT((shoulders - ankles).normalized().y(), 0.9);
  EXPECT_NEAR(shoulders.y(), 1.3, 0.2);
  const Vector3d wrist = file.At(file.Find("LWrist"), 20).translation();
  const Eigen::Vector2d ours =
      camera.Project(person.PoseAt(20).row(*person.skeleton().Find("LWrist")).transpose().cast<double>());
  EXPECT_LT((ours - PixelInViewer(file, "left", 20, wrist, 1280, 720)).norm(), 3.0);
}

TEST(WriteSceneGlb, TheFloorIsThereWhereItIsKnown) {
  const TemporaryFolder folder;
  WriteSceneGlb(folder / "walk.glb", MakeScene(1), {});
  const GlbFile file(folder / "walk.glb");
  const auto mesh = static_cast<std::size_t>(file.model.nodes[static_cast<std::size_t>(file.Find("floor"))].mesh);
  const std::vector<float> corners = file.Floats(file.model.meshes[mesh].primitives[0].attributes.at("POSITION"));
  ASSERT_EQ(corners.size(), 12U);
  for (std::size_t i = 1; i < 12; i += 3) EXPECT_EQ(corners[i], 0.0F);
}

TEST(WriteSceneGlb, SaysWhatItNeeds) {
  const TemporaryFolder folder;
  Scene scene = MakeScene(1);
  scene.people[0].unit = LengthUnit::kEachItsOwn;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteSceneGlb(folder / "a.glb", scene, {}); }),
              AllOf(HasSubstr("walk"), HasSubstr("`height`")));
  scene = MakeScene(1);
  std::fill(scene.people[0].positions().begin(), scene.people[0].positions().end(), std::nanf(""));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteSceneGlb(folder / "a.glb", scene, {}); }), HasSubstr("nobody"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.glb"));
}

TEST(WriteSceneBvh, OneFileForEachPerson) {
  const Scene scene = MakeScene(2);
  const TemporaryFolder folder;
  const std::vector<std::filesystem::path> files = WriteSceneBvh(folder / "walk.bvh", scene, {JointNames::kOurs});
  EXPECT_THAT(files, ::testing::ElementsAre(folder / "walk-anna.bvh", folder / "walk-bo_b.bvh"));
  const SceneMotion motion = MakeSceneMotion(scene, {JointNames::kOurs});
  for (std::size_t i = 0; i < 2; ++i) {
    const ArticulatedMotion read = ReadBvh(files[i], 10.0);
    ASSERT_EQ(read.frame_count(), kFrames);
    EXPECT_NEAR(read.fps, 50.0, 1e-6);
    const LandmarkTrack ours = MakeLandmarkTrack(motion.people[i].motion, "ours");
    const LandmarkTrack theirs = MakeLandmarkTrack(read, "theirs");
    for (std::size_t k = 0; k < ours.positions_mm.size(); ++k)
      EXPECT_LT((ours.positions_mm[k] - theirs.positions_mm[k]).norm(), 0.1);
  }
  EXPECT_THAT(WriteSceneBvh(folder / "one.bvh", MakeScene(1), {}), ::testing::ElementsAre(folder / "one.bvh"));
}

/// Runs a script of the project; 77 where what it runs is not installed.
int RunScript(const std::string& command) {
  const int status = std::system((testing::TestData("../scripts/").string() + command).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// What check-in-blender compares with: every joint in some frames.
void WriteExpected(const std::filesystem::path& path, const std::vector<HierarchyFit>& people) {
  std::string text = "person,joint,seconds,x,y,z\n";
  std::vector<Vector3d> positions;
  std::vector<Quaterniond> rotations;
  for (const HierarchyFit& fit : people) {
    for (const int frame : {0, 1, 23, kFrames - 1}) {
      ForwardKinematics(fit.motion, frame, positions, rotations);
      for (std::size_t j = 0; j < positions.size(); ++j) {
        // Blender makes no bone of an end site.
        if (fit.motion.joints[j].name.ends_with("_end")) continue;
        const Vector3d metres = 0.001 * positions[j];
        text += fmt::format("{},{},{:.9f},{:.6f},{:.6f},{:.6f}\n", fit.motion.name, fit.motion.joints[j].name,
                            frame / fit.motion.fps, metres.x(), metres.y(), metres.z());
      }
    }
  }
  WriteFileAtomically(path, text);
}

TEST(InBlender, JointsOfGlbAndBvhAreWithinAMillimetre) {
  for (const int people : {1, 2}) {
    const JointNames names = people == 1 ? JointNames::kOurs : JointNames::kMixamo;
    const TemporaryFolder folder;
    const Scene scene = MakeScene(people);
    const SceneMotion motion = MakeSceneMotion(scene, {names});
    WriteSceneGlb(folder / "walk.glb", scene, {names});
    WriteExpected(folder / "all.csv", motion.people);
    const auto check = [&](const std::filesystem::path& file, const std::filesystem::path& expected) {
      return RunScript(fmt::format("check-in-blender {} {} 50 > {} 2>&1", file.string(), expected.string(),
                                   (folder / "log.txt").string()));
    };
    const int result = check(folder / "walk.glb", folder / "all.csv");
    if (result == 77) GTEST_SKIP() << "Blender is not installed";
    EXPECT_EQ(result, 0) << ReadFile(folder / "log.txt");
    const std::vector<std::filesystem::path> files = WriteSceneBvh(folder / "walk.bvh", scene, {names});
    for (std::size_t i = 0; i < files.size(); ++i) {
      WriteExpected(folder / "one.csv", {motion.people[i]});
      EXPECT_EQ(check(files[i], folder / "one.csv"), 0) << files[i] << ReadFile(folder / "log.txt");
    }
  }
}

TEST(GltfValidator, FindsNoErrorInOurFiles) {
  const TemporaryFolder folder;
  for (const int people : {1, 2}) {
    WriteSceneGlb(folder / "walk.glb", MakeScene(people), {});
    const int result =
        RunScript(fmt::format("check-glb {} > {} 2>&1", (folder / "walk.glb").string(), (folder / "log.txt").string()));
    if (result == 77) GTEST_SKIP() << "gltf-validator is not installed";
    EXPECT_EQ(result, 0);
    EXPECT_THAT(ReadFile(folder / "log.txt"), HasSubstr("0 errors, 0 warnings"));
  }
}

}  // namespace
}  // namespace canonpose
