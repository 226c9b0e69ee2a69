#include "canonpose/view/page.h"

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/dataset.h"
#include "canonpose/simulate/simulator.h"
#include "canonpose/view/packed_arrays.h"
#include "canonpose/view/page_testing.h"

namespace canonpose {
namespace {

using testing::Between;
using testing::DataOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::PageData;
using testing::TemporaryFolder;
using testing::WalkingScene;
using Json = nlohmann::ordered_json;

ShownResult Result(ShownScene scene) { return {"walk.h5", {std::move(scene)}, "", ""}; }

/// Every position within `tolerance` of that in the scene.
void ExpectPositions(const PageData& data, const Json& json, const PoseSequence& person, double tolerance) {
  const std::vector<float> read = Unpack(data.arrays, json["positions"]);
  ASSERT_EQ(read.size(), person.positions().size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (std::isnan(person.positions()[i])) {
      ASSERT_TRUE(std::isnan(read[i])) << i;
    } else {
      ASSERT_NEAR(read[i], person.positions()[i], tolerance) << i;
    }
  }
}

TEST(Page, CarriesPositionsToATenthOfAMillimetre) {
  ShownScene scene = WalkingScene(2, 100);
  scene.scene.people[1].PoseAt(40).row(3).setConstant(std::nanf(""));
  const PageData data = DataOf(MakePage({Result(scene)}));
  const Json& shown = data.json["results"][0]["scenes"][0];
  EXPECT_EQ(shown["frames"], 100);
  EXPECT_EQ(shown["unit"], "mm");
  EXPECT_EQ(shown["people"][1]["sides"].get<std::string>().size(), 17U);
  for (std::size_t p = 0; p < 2; ++p) ExpectPositions(data, shown["people"][p], scene.scene.people[p], 0.11);
}

TEST(Page, CarriesKeypointsToAnEighthOfAPixel) {
  const ShownScene scene = WalkingScene(1, 50);
  const PageData data = DataOf(MakePage({Result(scene)}));
  const Json& camera = data.json["results"][0]["scenes"][0]["cameras"][2];
  EXPECT_EQ(camera["name"], "cam3");
  const std::vector<float> read = Unpack(data.arrays, camera["detections"][0]["keypoints"]);
  const std::vector<float>& given = scene.detections[0][2].keypoints;
  ASSERT_EQ(read.size(), given.size());
  for (std::size_t i = 0; i < read.size(); ++i) ASSERT_NEAR(read[i], given[i], 0.136) << i;
}

TEST(Page, CarriesMovingCameras) {
  ShownScene scene = WalkingScene(1, 50);
  SceneCamera& camera = scene.scene.cameras[0];
  camera.calibration.assign(50, camera.calibration[0]);
  for (int t = 0; t < 50; ++t) {
    Camera& moving = camera.calibration[static_cast<std::size_t>(t)];
    moving.camera_from_world_rotation =
        Eigen::AngleAxisd(0.04 * t, Eigen::Vector3d::UnitY()).toRotationMatrix() * moving.camera_from_world_rotation;
    moving.K(0, 0) = moving.K(1, 1) = 1400.0 + 5.0 * t;
  }
  const PageData data = DataOf(MakePage({Result(scene)}));
  const Json& calibration = data.json["results"][0]["scenes"][0]["cameras"][0]["calibration"];
  const std::vector<float> q = Unpack(data.arrays, calibration["quaternion"]);
  const std::vector<float> position = Unpack(data.arrays, calibration["position"]);
  EXPECT_NEAR(Unpack(data.arrays, calibration["focal"])[2 * 37], 1400.0 + 5.0 * 37, 0.1);
  const Eigen::Matrix3d read = Eigen::Quaterniond(q[151], q[148], q[149], q[150]).normalized().toRotationMatrix();
  EXPECT_LT((read - scene.scene.cameras[0].calibration[37].camera_from_world_rotation).norm(), 3e-4);
  const Camera& given = scene.scene.cameras[0].calibration[37];
  const Eigen::Vector3d centre = -given.camera_from_world_rotation.transpose() * given.camera_from_world_translation;
  EXPECT_NEAR(position[3 * 37], centre.x(), 0.2);
}

TEST(Page, CarriesAnglesContactsAndReports) {
  ShownScene scene = WalkingScene(1, 20);
  Analysis analysis;
  analysis.angles.push_back({"knee_flexion_l", "deg", std::vector<double>(20, 12.3)});
  analysis.contacts.push_back({true, 2, 9});
  scene.analyses = {analysis};
  scene.capture = "walk";
  ShownResult result = Result(scene);
  result.solve_report = R"({"captures": [{"name": "walk", "trust": "Nothing speaks against this result."}]})";
  result.evaluation = R"({"n_mpjpe_mm": 18.3})";
  const PageData data = DataOf(MakePage({result}));
  const Json& person = data.json["results"][0]["scenes"][0]["people"][0];
  EXPECT_EQ(person["series"][0]["name"], "knee_flexion_l");
  EXPECT_NEAR(Unpack(data.arrays, person["series"][0]["values"])[7], 12.3, 0.051);
  EXPECT_EQ(person["contacts"][0]["last"], 9);
  EXPECT_EQ(data.json["results"][0]["solve"]["captures"][0]["name"], "walk");
  EXPECT_EQ(data.json["results"][0]["scenes"][0]["capture"], "walk");
  EXPECT_EQ(data.json["results"][0]["evaluation"]["n_mpjpe_mm"], 18.3);
}

TEST(Page, AsksForNothing) {
  const std::string page = MakePage({Result(WalkingScene(1, 10))});
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  // Neither elements nor style ask for another file. (The script names web addresses, of XML name spaces.)
  const std::string frame = page.substr(0, page.find("id=\"canonpose-data\""));
  EXPECT_FALSE(std::regex_search(frame, std::regex("https?://|@import|url\\(")));
  EXPECT_FALSE(std::regex_search(frame, std::regex("(src|href)=\"(?!data:)")));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
}

TEST(Page, KeepsNamesWithinItsData) {
  ShownScene scene = WalkingScene(1, 5);
  scene.scene.people[0].name = "</script><script>alert(1)</script><!-- \"";
  const std::string clean = MakePage({Result(WalkingScene(1, 5))});
  ShownResult result = Result(scene);
  result.name = "<b>&.h5";
  const std::string page = MakePage({result});
  const auto scripts = [](const std::string& text) {
    const std::regex script("</script");
    return std::distance(std::sregex_iterator(text.begin(), text.end(), script), std::sregex_iterator());
  };
  EXPECT_EQ(scripts(page), scripts(clean));
  EXPECT_EQ(DataOf(page).json["results"][0]["scenes"][0]["people"][0]["name"], scene.scene.people[0].name);
  EXPECT_EQ(Between(page, "<title>", "</title>").substr(0, 16), "&lt;b>&amp;.h5 \xC2");
}

TEST(Page, ShowsTwoResultsUponEachOther) {
  const PageData data = DataOf(MakePage({Result(WalkingScene(1, 30)), Result(WalkingScene(1, 30))}));
  ASSERT_EQ(data.json["results"].size(), 2U);
  EXPECT_EQ(data.json["results"][1]["scenes"][0]["display"]["upIsGuess"], false);
}

TEST(ReadShownResult, TakesKeypointsFromASolvedDataset) {
  const TemporaryFolder folder;
  const ShownScene walking = WalkingScene(1, 12);
  const PoseSequence& person = walking.scene.people[0];
  Dataset dataset;
  dataset.skeleton = person.skeleton();
  Sequence& sequence = dataset.sequences.emplace_back();
  sequence.name = sequence.subject = sequence.capture = "walk";
  sequence.fps = 25.0;
  sequence.frame_count = 12;
  for (std::size_t c = 0; c < 2; ++c) {
    const SceneCamera& camera = walking.scene.cameras[c];
    CameraView& view = sequence.cameras.emplace_back();
    view.name = camera.name;
    view.image_size = camera.image_size_px;
    view.keypoints = walking.detections[0][c].keypoints;
    view.confidence = walking.detections[0][c].confidence;
    view.solved_calibration = camera.calibration;
    std::vector<float> positions;
    for (int t = 0; t < 12; ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d point = camera.At(t).InCamera(person.PoseAt(t).row(j).transpose().cast<double>());
        for (const double x : point) positions.push_back(static_cast<float>(x));
      }
    }
    view.solved = PosesInCamera(dataset.skeleton, positions, LengthUnit::kBodyLengths, camera.name);
  }
  WriteDataset(folder / "solved.h5", dataset);
  const ShownResult result = ReadShownResult(folder / "solved.h5");
  EXPECT_EQ(result.name, "solved.h5");
  ASSERT_EQ(result.scenes.size(), 1U);
  ASSERT_EQ(result.scenes[0].detections.size(), 1U);
  EXPECT_EQ(result.scenes[0].detections[0][1].keypoints, sequence.cameras[1].keypoints);
}

TEST(ReadShownResult, ReadsASceneFile) {
  const TemporaryFolder folder;
  WriteScene(folder / "scene.h5", WalkingScene(3, 6).scene);
  const ShownResult result = ReadShownResult(folder / "scene.h5");
  ASSERT_EQ(result.scenes.size(), 1U);
  EXPECT_EQ(result.scenes[0].scene.people.size(), 3U);
  EXPECT_TRUE(result.scenes[0].detections.empty());
  ASSERT_EQ(result.scenes[0].analyses.size(), 3U);
  ASSERT_NE(FindSeries(result.scenes[0].analyses[2].angles, "knee_angle_l"), nullptr);
}

TEST(ReadShownResult, RefusesAFileWithNobody) {
  const TemporaryFolder folder;
  WriteScene(folder / "scene.h5", Scene{});
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { ReadShownResult(folder / "scene.h5"); }),
              HasSubstr("nobody"));
}

// ---- Pages for a browser (viewer/page_test.mjs), and their size ----

/// Several simulated people before the cameras of the first, with the simulated detector's errors.
ShownScene SimulatedScene(int people, int frames) {
  SimulationOptions options;
  options.activities = {Activity::kGait};
  options.subjects = people;
  options.fps = 50.0;
  options.seconds = frames / options.fps;
  options.seed = 7;
  const Simulator simulator(options);
  ShownScene shown;
  shown.scene.name = "simulated";
  shown.scene.up.source = "the simulation";
  shown.scene.scale.source = "the simulation";
  for (int p = 0; p < people; ++p) {
    const Sequence sequence = simulator.Make(p).sequence;
    if (p == 0) {
      for (const CameraView& view : sequence.cameras) {
        shown.scene.cameras.push_back({view.name, view.image_size, view.calibration, 0.0, true, ""});
      }
    }
    const CameraView& first = sequence.cameras.front();
    PoseSequence& person = shown.scene.people.emplace_back(simulator.skeleton(), sequence.frame_count);
    person.name = "Person " + std::to_string(p + 1);
    person.unit = LengthUnit::kMillimetres;
    person.fps = options.fps;
    const Eigen::Vector3d aside(p % 2 == 0 ? 0.0 : 1100.0, p < 2 ? 0.0 : 1100.0, 0.0);
    for (int t = 0; t < person.frame_count(); ++t) {
      const Camera& camera = first.CalibrationAt(t);
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d point = first.truth.PoseAt(t).row(j).transpose().cast<double>();
        person.PoseAt(t).row(j) =
            (camera.camera_from_world_rotation.transpose() * (point - camera.camera_from_world_translation) + aside)
                .transpose()
                .cast<float>();
      }
    }
    person.TrustKnownJoints();
    for (std::size_t i = 0; i < person.confidence().size(); ++i) {
      person.standard_deviation()[i] = 8.0F + 10.0F * (1.0F - first.confidence[i]) + static_cast<float>(i % 17) * 0.3F;
    }
    std::vector<ViewKeypoints>& seen = shown.detections.emplace_back();
    for (std::size_t c = 0; c < shown.scene.cameras.size(); ++c) {
      const CameraView& view = sequence.cameras[c];
      ViewKeypoints exact = testing::SeenExactly(shown.scene.cameras[c], person);
      for (std::size_t i = 0; i < view.confidence.size(); ++i) {
        const int t = static_cast<int>(i) / person.joint_count();
        const int j = static_cast<int>(i) % person.joint_count();
        const Eigen::Vector2d true_pixel =
            view.CalibrationAt(t).ProjectFromCamera(view.truth.PoseAt(t).row(j).transpose().cast<double>());
        exact.keypoints[2 * i] += view.keypoints[2 * i] - static_cast<float>(true_pixel.x());
        exact.keypoints[2 * i + 1] += view.keypoints[2 * i + 1] - static_cast<float>(true_pixel.y());
        exact.confidence[i] = view.confidence[i];
      }
      seen.push_back(std::move(exact));
    }
    Analysis& analysis = shown.analyses.emplace_back();
    for (const char* name : {"hip_flexion", "hip_adduction", "hip_rotation", "knee_flexion", "ankle_flexion",
                             "shoulder_flexion", "shoulder_abduction", "elbow_flexion"}) {
      for (const char* side : {"_l", "_r"}) {
        TimeSeries series{std::string(name) + side, "deg", {}};
        for (int t = 0; t < person.frame_count(); ++t) {
          const double seconds = t / options.fps;
          series.values.push_back(25.0 + 20.0 * std::sin(6.0 * seconds + (side[1] == 'l' ? 0.0 : 3.1)) +
                                  0.01 * person.PoseAt(t)(static_cast<int>(analysis.angles.size()) % 17, 0));
        }
        analysis.angles.push_back(std::move(series));
      }
    }
    for (int t = 0; t + 20 < person.frame_count(); t += 52) {
      analysis.contacts.push_back({true, t, t + 30});
      analysis.contacts.push_back({false, t + 26, std::min(t + 56, person.frame_count() - 1)});
    }
  }
  return shown;
}

TEST(Page, OfTenThousandFramesFourPeopleAndFourCamerasIsSmall) {
  const ShownScene scene = SimulatedScene(4, 10000);
  ASSERT_EQ(scene.scene.people[0].frame_count(), 10000);
  const std::string page = MakePage({{"large.h5", {scene}, "", ""}});
  std::cout << "page of 10,000 frames, 4 people, 4 cameras: " << static_cast<double>(page.size()) / 1e6 << " MB\n";
  EXPECT_LT(page.size(), 12'000'000U);
  if (const char* folder = std::getenv("CANONPOSE_PAGE_FOLDER")) {
    WriteFileAtomically(std::filesystem::path(folder) / "large.html", page);
  }
}

TEST(PageForBrowser, IsWrittenWhereOneAsksForIt) {
  const char* folder = std::getenv("CANONPOSE_PAGE_FOLDER");
  if (folder == nullptr) GTEST_SKIP() << "CANONPOSE_PAGE_FOLDER does not say where to";
  ShownScene scene = SimulatedScene(2, 150);
  scene.scene.people[1].PoseAt(40).row(3).setConstant(std::nanf(""));
  ViewKeypoints& off = scene.detections[0][2];
  for (std::size_t i = 0; i < off.keypoints.size(); i += 2) off.keypoints[i] += 40.0F;
  ShownResult result{"one.h5", {scene, WalkingScene(1, 60)}, "", ""};
  result.scenes[0].capture = "hall";
  result.scenes[1].capture = "street";
  result.solve_report = R"({"captures": [{"name": "street", "trust": "Nothing speaks against this result.",
      "cameras": []}]})";
  WriteFileAtomically(std::filesystem::path(folder) / "page.html", MakePage({result}));
  ShownResult other{"two.h5", {scene}, "", ""};
  for (PoseSequence& person : other.scenes[0].scene.people) {
    for (float& x : person.positions()) x += 15.0F * std::sin(x);
  }
  WriteFileAtomically(std::filesystem::path(folder) / "two.html", MakePage({result, other}));
  Json expected = Json::array();  // [person][frame][joint][x, y, z]
  for (const PoseSequence& person : scene.scene.people) {
    Json frames = Json::array();
    for (int t = 0; t < person.frame_count(); ++t) {
      Json joints = Json::array();
      for (int j = 0; j < person.joint_count(); ++j) {
        const auto point = person.PoseAt(t).row(j);
        joints.push_back(person.IsKnown(t, j) ? Json{point(0), point(1), point(2)} : Json(nullptr));
      }
      frames.push_back(std::move(joints));
    }
    expected.push_back(std::move(frames));
  }
  WriteFileAtomically(std::filesystem::path(folder) / "expected.json", expected.dump());
}

}  // namespace
}  // namespace canonpose
