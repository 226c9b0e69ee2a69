// Calibrations as other programs write them; the texts here were written by hand after their documentation.
#include "canonpose/data/readers/calibration.h"

#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::Shared;
using testing::TemporaryFolder;

std::map<std::string, CalibratedCamera> Read(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / name, text);
  return ReadCalibration(folder / name);
}

std::string ReadError(const std::string& name, const std::string& text) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(name, text); });
}

/// A quarter turn about x: the camera looks along the world's y with the world's z up.
void ExpectQuarterTurn(const CalibratedCamera& calibrated) {
  const Camera& camera = calibrated.camera;
  EXPECT_EQ(camera.K(0, 0), 1000.0);
  EXPECT_EQ(camera.K(1, 1), 1010.0);
  EXPECT_EQ(camera.K(0, 2), 320.5);
  EXPECT_EQ(camera.K(1, 2), 240.25);
  Eigen::Matrix3d expected;
  expected << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  EXPECT_LT((camera.camera_from_world_rotation - expected).norm(), 1e-12);
  EXPECT_LT((camera.camera_from_world_translation - Eigen::Vector3d(100, 1200, 3000)).norm(), 1e-9);
  EXPECT_THAT(camera.distortion, ::testing::ElementsAre(-0.1, 0.2, 0.001, -0.002, 0.0));
}

std::string TomlCamera(const std::string& more, const std::string& translation) {
  return "name = \"left view\"\nsize = [ 640.0, 480.0]\n"
         "matrix = [ [ 1000.0, 0.0, 320.5], [ 0.0, 1010.0, 240.25], [ 0.0, 0.0, 1.0]]\n"
         "distortions = [ -0.1, 0.2, 0.001, -0.002]\nrotation = [ 1.5707963267948966, 0.0, 0.0]\ntranslation = " +
         translation + "\n" + more;
}

TEST(CalibrationToml, Pose2SimIsInMetres) {
  const auto cameras = Read("Calib.toml", "[cam_01]\n" + TomlCamera("fisheye = false\n", "[ 0.1, 1.2, 3.0]") +
                                              "\n[metadata]\nadjusted = false\nerror = 0.5\n");
  ASSERT_EQ(cameras.size(), 1U);
  ExpectQuarterTurn(cameras.at("left view"));
  EXPECT_EQ(cameras.at("left view").image_size, (std::array<int, 2>{640, 480}));
}

TEST(CalibrationToml, AniposelibSaysNoUnit) {
  const auto cameras = Read("calibration.toml", "[cam_0]\n" + TomlCamera("", "[ 100.0, 1200, 3e3]") + "[metadata]\n");
  ExpectQuarterTurn(cameras.at("left view"));
}

TEST(CalibrationToml, OurOwnUnitCounts) {
  const std::string text = "[cam_0]\n" + TomlCamera("fisheye = false\n", "[ 100.0, 1200.0, 3000.0]");
  ExpectQuarterTurn(Read("c.toml", text + "[metadata]\nunit = \"mm\"\n").at("left view"));
  EXPECT_THAT(
      ReadError("c.toml", text + "[metadata]\nunit = \"body lengths\"\n"),
      AllOf(HasSubstr("metadata.unit: expected \"mm\" or \"m\", found \"body lengths\""), HasSubstr("`height`")));
}

TEST(CalibrationToml, ErrorsNameThePlace) {
  EXPECT_THAT(ReadError("c.toml", "[cam\n"), HasSubstr("line 1: expected TOML"));
  EXPECT_THAT(ReadError("c.toml", "a = 1\n"), HasSubstr("expected a table for each camera"));
  EXPECT_THAT(ReadError("c.toml", "[cam_0]\n" + TomlCamera("fisheye = true\n", "[0, 0, 1]")),
              HasSubstr("cam_0.fisheye: expected false, found true; cameras with a fisheye lens"));
  EXPECT_THAT(ReadError("c.toml", "[cam_0]\n" + TomlCamera("", "[0, 1]")),
              HasSubstr("cam_0.translation: expected 3 finite values, found 2 values"));
  EXPECT_THAT(ReadError("c.toml", "[cam_0]\n" + TomlCamera("", "\"far\"")),
              HasSubstr("cam_0.translation: expected an array of numbers"));
  EXPECT_THAT(ReadError("c.toml", "[a]\n" + TomlCamera("", "[0, 0, 1]") + "[b]\n" + TomlCamera("", "[0, 0, 1]")),
              HasSubstr("a second camera left view"));
  EXPECT_THAT(ReadError("c.toml", "[cam_0]\nmatrix = [1, 2]\nrotation = [0, 0, 0]\n"),
              HasSubstr("cam_0.matrix: expected [[fx"));
}

/// As cv::FileStorage writes it, with floats that end in a point and matrices over several lines.
constexpr const char* kIntrinsics =
    "K_01: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1000., 0., 3.2050000000000000e+02, 0.,\n"
    "       1010., 240.25, 0., 0., 1. ]\n"
    "dist_01: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.1, 0.2, 0.001, -0.002, 0. ]\n"
    "W_01: 640\nH_01: 480\n";
constexpr const char* kExtrinsics =
    "R_01: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 1.5707963267948966, 0., 0. ]\n"
    "T_01: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 100., 1200., 3000. ]\n";
constexpr const char* kNames = "%YAML:1.0\n---\nnames:\n   - \"01\"\n";

TEST(CalibrationOpenCv, OneFileOrTwo) {
  const auto cameras = Read("c.yml", std::string(kNames) + kIntrinsics + kExtrinsics);
  ExpectQuarterTurn(cameras.at("01"));
  EXPECT_EQ(cameras.at("01").image_size, (std::array<int, 2>{640, 480}));

  const TemporaryFolder folder;
  WriteFileAtomically(folder / "intri.yml", std::string(kNames) + kIntrinsics);
  WriteFileAtomically(folder / "extri.yml", std::string(kNames) + kExtrinsics);
  ExpectQuarterTurn(ReadCalibration(folder / "intri.yml").at("01"));
}

TEST(CalibrationOpenCv, MatrixOrVectorOfRotationAndUnit) {
  const std::string rotation =
      "Rot_01: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 0., -1., 0., 1., 0. ]\n"
      "T_01: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 0.1, 1.2, 3. ]\nunit: \"m\"\n";
  ExpectQuarterTurn(Read("c.yaml", std::string(kNames) + kIntrinsics + rotation).at("01"));
}

TEST(CalibrationOpenCv, ErrorsNameThePlace) {
  EXPECT_THAT(ReadError("c.yml", "%YAML:1.0\n---\n[ 1, 2\n"), HasSubstr("expected YAML as OpenCV's FileStorage"));
  EXPECT_THAT(ReadError("c.yml", "%YAML:1.0\n---\ncamera_matrix: 3\n"), HasSubstr("names: expected a list of names"));
  EXPECT_THAT(ReadError("c.yml", std::string(kNames) + kIntrinsics), HasSubstr("R_01: expected an !!opencv-matrix"));
  EXPECT_THAT(ReadError("c.yml", std::string(kNames) + "K_01: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n" +
                                     "   data: [ 1., x ]\n"),
              HasSubstr("K_01: expected a number"));
  EXPECT_THAT(ReadError("c.yml", std::string(kNames) + "K_01: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n" +
                                     "   data: [ 1., 2. ]\n"),
              HasSubstr("as many values as rows times cols"));
}

/// A camera of Qualisys Track Manager: 64ths of a pixel, axes right, up and back, columns before rows.
std::string QualisysFile(const std::string& transform) {
  return "<?xml version='1.0'?>\n<calibration><cameras><camera serial=\"cam_01\" model=\"Miqus Video\">"
         "<fov_video left=\"0\" top=\"0\" right=\"639\" bottom=\"479\"/>" +
         transform +
         "<intrinsic focalLengthU=\"64000\" focalLengthV=\"64640\" centerPointU=\"20512\" centerPointV=\"15376\" "
         "radialDistortion1=\"-0.1\" radialDistortion2=\"0.2\" radialDistortion3=\"0.0\" "
         "tangentalDistortion1=\"0.001\" tangentalDistortion2=\"-0.002\" skew=\"0.0\"/>"
         "</camera></cameras></calibration>\n";
}

TEST(CalibrationQualisys, AxesAndUnits) {
  // The centre is -R^T t = (-100, -3000, 1200).
  const auto cameras =
      Read("c.qca.txt", QualisysFile("<transform x=\"-100\" y=\"-3000\" z=\"1200\" r11=\"1\" r12=\"0\" "
                                     "r13=\"0\" r21=\"0\" r22=\"0\" r23=\"1\" r31=\"0\" r32=\"-1\" "
                                     "r33=\"0\"/>"));
  ASSERT_EQ(cameras.size(), 1U);
  ExpectQuarterTurn(cameras.at("cam_01"));
  EXPECT_EQ(cameras.at("cam_01").image_size, (std::array<int, 2>{640, 480}));
}

TEST(CalibrationQualisys, ErrorsNameThePlace) {
  EXPECT_THAT(ReadError("c.qca.txt", "<calibration"), HasSubstr("expected XML"));
  EXPECT_THAT(ReadError("c.qca.txt", "<settings/>"), HasSubstr("at least one camera of Qualisys Track Manager"));
  EXPECT_THAT(ReadError("c.qca.txt", QualisysFile("")), HasSubstr("camera cam_01.transform: expected an element"));
  EXPECT_THAT(ReadError("c.qca.txt", QualisysFile("<transform x=\"near\"/>")),
              HasSubstr("camera cam_01.transform.r11: expected a number, found nothing"));
}

TEST(CalibrationQualisys, AgreesWithTheOtherCalibrationOfTheRecording) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing/Calib.qca.txt");
  const auto cameras = ReadCalibration(Shared("data/balancing/Calib.qca.txt"));
  const auto expected = ReadCalibration(Shared("data/balancing/calibration.json"));
  ASSERT_EQ(cameras.size(), expected.size());
  for (const auto& [name, other] : expected) {
    const CalibratedCamera& calibrated = FindCalibration(cameras, name, "Calib.qca.txt");  // cam_01 for cam01
    EXPECT_EQ(calibrated.image_size, other.image_size) << name;
    EXPECT_LT((calibrated.camera.K - other.camera.K).norm(), 1e-6) << name;
    EXPECT_LT((calibrated.camera.camera_from_world_rotation - other.camera.camera_from_world_rotation).norm(), 1e-9);
    EXPECT_LT((calibrated.camera.camera_from_world_translation - other.camera.camera_from_world_translation).norm(),
              0.01)
        << name;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(calibrated.camera.distortion[i], other.camera.distortion[i], 1e-9) << name << i;
    }
  }
}

TEST(Calibration, NamesMayDifferInPunctuationUnlessThatIsAmbiguous) {
  std::map<std::string, CalibratedCamera> cameras;
  cameras["cam_01"].camera.K(0, 0) = 1.0;
  cameras["Cam 02"].camera.K(0, 0) = 2.0;
  EXPECT_EQ(FindCalibration(cameras, "cam01", "c").camera.K(0, 0), 1.0);
  EXPECT_EQ(FindCalibration(cameras, "CAM-02", "c").camera.K(0, 0), 2.0);
  cameras["cam-01"].camera.K(0, 0) = 3.0;
  EXPECT_EQ(FindCalibration(cameras, "cam_01", "c").camera.K(0, 0), 1.0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindCalibration(cameras, "cam01", "c"); }),
              HasSubstr("expected camera cam01, found Cam 02, cam-01, cam_01"));
}

TEST(CalibrationJson, CamerasMayMove) {
  const std::string R = "[[1,0,0],[0,1,0],[0,0,1]]";
  const std::string head =
      R"({"units":"m","cameras":{"a":{"K":[[1000,0,320],[0,1000,240],[0,0,1]],"R":[)" + R + "," + R;
  const auto cameras = Read("c.json", head + R"(],"t":[[1,2,3],[1,2,4]],"distortion":[0.1,0,0,0]}}})");
  const CalibratedCamera& camera = cameras.at("a");
  ASSERT_EQ(camera.per_frame.size(), 2U);
  EXPECT_EQ(camera.per_frame[1].camera_from_world_translation, Eigen::Vector3d(1000, 2000, 4000));
  EXPECT_EQ(camera.per_frame[1].K(0, 2), 320.0);
  EXPECT_EQ(camera.per_frame[1].distortion[0], 0.1);
  EXPECT_THAT(ReadError("c.json", head + R"(],"t":[[1,2,3],[1,2,4],[1,2,5]]}}})"),
              HasSubstr("cameras.a: expected one value or 3 values of each of K, R, t and distortion, found 2 of one"));
  EXPECT_THAT(ReadError("c.json", head + R"(],"t":[[1,2,3],[1,2]]}}})"),
              HasSubstr("cameras.a.t[1]: expected 3 finite"));
}

}  // namespace
}  // namespace canonpose
