#include "canonpose/export/calibration.h"

#include <cstdlib>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/calibration.h"
#include "canonpose/export/scene_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::Lines;
using testing::PlaceOfJoint;
using testing::Split;
using testing::StaticScene;
using testing::TemporaryFolder;
using testing::UnknownScene;

std::filesystem::path Export(const std::filesystem::path& path, CalibrationFormat format, const Scene& scene,
                             UpAxis up = UpAxis::kZ, FileUnit unit = FileUnit::kMetres) {
  WriteCalibration(path, format, scene, {scene, up, unit});
  return path;
}

/// That a file has the cameras of a scene in millimetres, in axes that `space` gives.
void ExpectSameCameras(const std::filesystem::path& path, const Scene& scene, const FileSpace& space) {
  SCOPED_TRACE(path.string());
  const std::map<std::string, CalibratedCamera> cameras = ReadCalibration(path);
  ASSERT_EQ(cameras.size(), scene.cameras.size());
  for (const SceneCamera& camera : scene.cameras) {
    ASSERT_TRUE(cameras.contains(camera.name)) << camera.name;
    const CalibratedCamera& read = cameras.at(camera.name);
    const Camera expected = space.InFile(camera.calibration.front());
    EXPECT_EQ(read.image_size, camera.image_size_px);
    EXPECT_EQ(read.camera.K, expected.K);
    EXPECT_EQ(read.camera.distortion, expected.distortion);
    EXPECT_LT((read.camera.camera_from_world_rotation - expected.camera_from_world_rotation).norm(), 1e-12);
    EXPECT_LT((read.camera.camera_from_world_translation - expected.camera_from_world_translation).norm(), 1e-9);
  }
}

TEST(CalibrationExport, IsReadBackTheSame) {
  const TemporaryFolder folder;
  const Scene scene = StaticScene();
  for (const UpAxis up : {UpAxis::kZ, UpAxis::kY}) {
    const FileSpace expected(scene, up, FileUnit::kMillimetres);
    using enum CalibrationFormat;
    ExpectSameCameras(Export(folder / "Calib.toml", kPose2Sim, scene, up), scene, expected);
    for (const FileUnit unit : {FileUnit::kMetres, FileUnit::kMillimetres}) {
      ExpectSameCameras(Export(folder / "calibration.toml", kAniposelib, scene, up, unit), scene, expected);
      ExpectSameCameras(Export(folder / "calibration.yml", kOpenCv, scene, up, unit), scene, expected);
      ExpectSameCameras(Export(folder / "calibration.json", kJson, scene, up, unit), scene, expected);
    }
  }
}

TEST(CalibrationExport, AniposelibsKeysSortAsNumbers) {
  const TemporaryFolder folder;
  Scene scene = StaticScene();
  for (int i = 0; i < 9; ++i) scene.cameras.push_back(testing::StaticCamera(fmt::format("more{}", i), 0.1 * i));
  const std::string text = ReadFile(Export(folder / "c.toml", CalibrationFormat::kAniposelib, scene));
  std::vector<std::string> keys;
  for (const std::string& line : Lines(text)) {
    if (line.starts_with("[cam_")) keys.push_back(line);
  }
  ASSERT_EQ(keys.size(), 12U);
  EXPECT_EQ(keys[0], "[cam_00]");
  EXPECT_EQ(keys[11], "[cam_11]");
  EXPECT_TRUE(std::ranges::is_sorted(keys));
}

TEST(CalibrationExport, UnknownSizeIsNotCalledMetres) {
  const TemporaryFolder folder;
  const Scene scene = UnknownScene();
  using enum CalibrationFormat;
  for (const auto& [name, format] : {std::pair("c.toml", kPose2Sim), std::pair("d.toml", kAniposelib),
                                     std::pair("c.yml", kOpenCv), std::pair("c.json", kJson)}) {
    const std::filesystem::path path = Export(folder / name, format, scene);
    EXPECT_THAT(ReadFile(path), HasSubstr("body lengths")) << name;
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadCalibration(path); }), HasSubstr("body lengths")) << name;
  }
  EXPECT_THAT(ReadFile(Export(folder / "colmap", kColmap, scene) / "images.txt"),
              HasSubstr("# unit: body lengths, up: unknown"));
}

TEST(CalibrationExport, MovingCamerasAreRefusedWhereTheFormatHasNone) {
  const TemporaryFolder folder;
  Scene scene = StaticScene(4);
  scene.cameras[1].calibration.assign(4, scene.cameras[1].calibration[0]);
  using enum CalibrationFormat;
  for (const CalibrationFormat format : {kPose2Sim, kAniposelib, kOpenCv}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Export(folder / "c", format, scene); }),
                AllOf(HasSubstr("camera cam2 moves"), HasSubstr("COLMAP")));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "c"));
}

TEST(CalibrationExport, JsonHasMovingCameras) {
  const TemporaryFolder folder;
  Scene scene = StaticScene(4);
  scene.cameras[1].calibration.assign(4, scene.cameras[1].calibration[0]);
  scene.cameras[1].calibration[2].K(0, 0) = 1300.0;
  const auto cameras = ReadCalibration(Export(folder / "c.json", CalibrationFormat::kJson, scene));
  EXPECT_TRUE(cameras.at("cam1").per_frame.empty());
  ASSERT_EQ(cameras.at("cam2").per_frame.size(), 4U);
  for (std::size_t t = 0; t < 4; ++t) {
    const Camera& read = cameras.at("cam2").per_frame[t];
    const Camera& expected = scene.cameras[1].calibration[t];
    EXPECT_EQ(read.K, expected.K);
    EXPECT_EQ(read.distortion, expected.distortion);
    EXPECT_LT((read.camera_from_world_translation - expected.camera_from_world_translation).norm(), 1e-9);
  }
}

TEST(CalibrationExport, CamerasThatAreUnknownAreLeftOut) {
  const TemporaryFolder folder;
  Scene scene = StaticScene();
  scene.cameras[1].calibration.clear();
  EXPECT_THAT(CamerasWithoutCalibration(scene), ::testing::ElementsAre("cam2"));
  EXPECT_EQ(ReadCalibration(Export(folder / "c.toml", CalibrationFormat::kPose2Sim, scene)).size(), 2U);
  scene.cameras[0].calibration.clear();
  scene.cameras[2].calibration.clear();
  EXPECT_THAT(
      ErrorOf(ErrorKind::kInvalidArgument, [&] { Export(folder / "d.toml", CalibrationFormat::kPose2Sim, scene); }),
      HasSubstr("no calibrated cameras"));
}

TEST(CalibrationExport, NamesMustFitTheFormat) {
  using enum CalibrationFormat;
  EXPECT_EQ(CalibrationFormatOf("a/Calib.toml"), kPose2Sim);
  EXPECT_EQ(CalibrationFormatOf("a.YML"), kOpenCv);
  EXPECT_EQ(CalibrationFormatOf("a/colmap"), kColmap);
  EXPECT_EQ(CalibrationFormatOf("a.json"), std::nullopt) << "a scene";
  EXPECT_NO_THROW(RequireCalibrationName("a.yaml", kOpenCv));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { RequireCalibrationName("a.toml", kColmap); }),
              HasSubstr("a calibration of COLMAP is a folder"));
  const TemporaryFolder folder;
  Scene scene = StaticScene();
  scene.cameras[0].name = "cam 10_b";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { Export(folder / "c.yml", kOpenCv, scene); }),
              HasSubstr("names of two cameras are both cam_10_b"));
}

// -------------------------------------------------------------------------------------------------------------- COLMAP

std::vector<std::string> Words(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// The lines that are not comments. Those that list the points of an image are empty.
std::vector<std::string> WithoutComments(const std::string& text) {
  std::vector<std::string> lines = Lines(text + '\n');
  std::erase_if(lines, [](const std::string& line) { return line.starts_with('#'); });
  return lines;
}

TEST(CalibrationExport, ColmapHasAnImagePerFrameOfAMovingCamera) {
  const TemporaryFolder folder;
  Scene scene = StaticScene(3);
  scene.cameras.resize(2);
  scene.cameras[1].calibration.assign(3, scene.cameras[1].calibration[0]);
  scene.cameras[1].calibration[2].K(0, 0) = 1300.0;  // a zoom
  scene.cameras[1].calibration[1].camera_from_world_translation.x() += 100.0;
  Export(folder / "model", CalibrationFormat::kColmap, scene);
  const std::vector<std::string> cameras = WithoutComments(ReadFile(folder / "model" / "cameras.txt"));
  ASSERT_GE(cameras.size(), 3U);
  EXPECT_EQ(cameras[0], "1 OPENCV 1920 1080 1200.125 1190.75 956.0 541.75 -0.05 0.02 0.001 -0.0005");
  EXPECT_EQ(cameras[1],
            "2 FULL_OPENCV 1920 1080 1200.125 1190.75 956.0 541.75 -0.05 0.02 0.001 -0.0005 0.01 0.0 0.0 0.0");
  EXPECT_THAT(cameras[2], ::testing::StartsWith("3 FULL_OPENCV 1920 1080 1300.0 "));
  const std::vector<std::string> images = WithoutComments(ReadFile(folder / "model" / "images.txt"));
  ASSERT_GE(images.size(), 8U);
  EXPECT_EQ(images[1], "");
  EXPECT_EQ(Words(images[0]).back(), "cam1.png");
  EXPECT_EQ(Words(images[4]).back(), "cam2/000001.png");
  EXPECT_EQ(Words(images[6]).at(8), "3") << "the zoomed lens";
  const std::vector<std::string> words = Words(images[4]);
  ASSERT_EQ(words.size(), 10U);
  const Eigen::Quaterniond q(std::stod(words[1]), std::stod(words[2]), std::stod(words[3]), std::stod(words[4]));
  const Camera& camera = scene.cameras[1].calibration[1];
  EXPECT_LT((q.matrix() - camera.camera_from_world_rotation).norm(), 1e-9);
  EXPECT_NEAR(std::stod(words[5]), 1e-3 * camera.camera_from_world_translation.x(), 1e-9);
  EXPECT_TRUE(std::filesystem::exists(folder / "model" / "points3D.txt"));
  scene.cameras[0].calibration[0].K(0, 1) = 2.0;
  EXPECT_THAT(
      ErrorOf(ErrorKind::kInvalidArgument, [&] { Export(folder / "other", CalibrationFormat::kColmap, scene); }),
      HasSubstr("camera cam1 has skew"));
}

// -------------------------------------------------------------------------------------------------------------- OpenCV

/// Reads each file with Python's and OpenCV's own readers, and prints the pixels of points for every camera.
constexpr const char* kProjectWithOpenCv = R"(
import json, sys, tomllib
import cv2, numpy as np
folder, points = sys.argv[1], np.loadtxt(sys.argv[1] + "/points.txt")

def show(name, rotation, translation, matrix, distortion, shift=0.0):
    pixels, _ = cv2.projectPoints(points, np.array(rotation, float), np.array(translation, float),
                                  np.array(matrix, float), np.array(distortion, float))
    print(name, *["%.6f" % (value - shift) for value in pixels.ravel()], sep="\t")

for file in ("pose2sim.toml", "anipose.toml"):
    with open(f"{folder}/{file}", "rb") as stream:
        calibration = tomllib.load(stream)
    for key, camera in calibration.items():
        if key != "metadata":
            show(camera["name"], camera["rotation"], camera["translation"], camera["matrix"], camera["distortions"])

storage = cv2.FileStorage(f"{folder}/opencv.yml", cv2.FILE_STORAGE_READ)
names = storage.getNode("names")
for i in range(names.size()):
    name = names.at(i).string()
    key = name.replace(" ", "_").replace(".", "_")
    vector, matrix = storage.getNode("R_" + key).mat(), storage.getNode("Rot_" + key).mat()
    assert np.abs(cv2.Rodrigues(vector)[0] - matrix).max() < 1e-9
    assert (int(storage.getNode("W_" + key).real()), int(storage.getNode("H_" + key).real())) == (1920, 1080)
    show(name, vector, storage.getNode("T_" + key).mat(), storage.getNode("K_" + key).mat(),
         storage.getNode("dist_" + key).mat())

with open(f"{folder}/ours.json") as stream:
    for name, camera in json.load(stream)["cameras"].items():
        show(name, cv2.Rodrigues(np.array(camera["R"]))[0], camera["t"], camera["K"], camera["distortion"])

lenses = {}
for line in open(f"{folder}/colmap/cameras.txt"):
    if not line.startswith("#"):
        number, model, width, height, *values = line.split()
        fx, fy, cx, cy, *distortion = map(float, values)
        lenses[number] = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]]), distortion
lines = [line for line in open(f"{folder}/colmap/images.txt") if not line.startswith("#")]
originals = iter(["cam1", "cam2", "cam 10.b"])
for line in lines[::2]:
    number, *pose, lens, name = line.split()
    w, x, y, z, *translation = map(float, pose)
    rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    show(next(originals), cv2.Rodrigues(rotation)[0], translation, *lenses[lens], shift=0.5)
)";

/// A Python with OpenCV; empty where there is none.
std::string PythonWithOpenCv() {
  for (const char* const python : {"python3", "/usr/bin/python3"}) {
    if (std::system(fmt::format("{} -c 'import cv2, numpy, tomllib' 2>/dev/null", python).c_str()) == 0) return python;
  }
  return "";
}

TEST(CalibrationExport, OpenCvProjectsThePosesWhereWeDo) {
  const std::string python = PythonWithOpenCv();
  if (python.empty()) GTEST_SKIP() << "there is no python3 with cv2: apt-get install python3-opencv";
  const TemporaryFolder folder;
  const Scene scene = StaticScene();
  using enum CalibrationFormat;
  Export(folder / "pose2sim.toml", kPose2Sim, scene);
  Export(folder / "anipose.toml", kAniposelib, scene);
  Export(folder / "opencv.yml", kOpenCv, scene);
  Export(folder / "ours.json", kJson, scene);
  Export(folder / "colmap", kColmap, scene);
  std::vector<Eigen::Vector3d> points;
  std::string text;
  for (int t = 0; t < 3; ++t) {
    for (int j = 0; j < 3; ++j) {
      points.push_back(PlaceOfJoint(t, j));
      text += fmt::format("{} {} {}\n", 1e-3 * points.back().x(), 1e-3 * points.back().y(), 1e-3 * points.back().z());
    }
  }
  WriteFileAtomically(folder / "points.txt", text);
  WriteFileAtomically(folder / "project.py", kProjectWithOpenCv);
  ASSERT_EQ(
      std::system(fmt::format("{0} {1}/project.py {1} >{1}/out 2>{1}/errors", python, (folder / "").string()).c_str()),
      0)
      << ReadFile(folder / "errors");
  const std::vector<std::string> lines = Lines(ReadFile(folder / "out"));
  ASSERT_EQ(lines.size(), 5 * scene.cameras.size());
  for (const std::string& line : lines) {
    const std::vector<std::string> fields = Split(line, '\t');
    const auto camera = std::ranges::find(scene.cameras, fields.at(0), &SceneCamera::name);
    ASSERT_NE(camera, scene.cameras.end()) << line;
    ASSERT_EQ(fields.size(), 1 + 2 * points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Eigen::Vector2d found(std::stod(fields[1 + 2 * p]), std::stod(fields[2 + 2 * p]));
      EXPECT_LT((found - camera->calibration[0].Project(points[p])).norm(), 1e-3) << line;
    }
  }
}

}  // namespace
}  // namespace canonpose
