// TRC, MOT, CSV and JSON, read back by readers that were written from the formats' documentation alone.
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/testing.h"
#include "canonpose/export/angle_table.h"
#include "canonpose/export/scene_csv.h"
#include "canonpose/export/scene_json.h"
#include "canonpose/export/scene_testing.h"
#include "canonpose/export/trc.h"

namespace canonpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Lines;
using testing::MovingPerson;
using testing::PlaceOfJoint;
using testing::Split;
using testing::StaticScene;
using testing::UnknownScene;

// ---------------------------------------------------------------------------------------------------------------- TRC

/// A TRC file, read as OpenSim does: strictly.
struct Trc {
  std::vector<std::string> first_line;
  double data_rate = 0.0;
  std::string units;
  std::vector<std::string> markers;
  std::vector<double> time;
  std::vector<std::vector<std::optional<Eigen::Vector3d>>> frames;
};

double ExactNumber(const std::string& text) {
  std::size_t end = 0;
  const double number = std::stod(text, &end);
  EXPECT_EQ(end, text.size()) << text;
  return number;
}

Trc ReadTrc(const std::string& text) {
  Trc trc;
  const std::vector<std::string> lines = Lines(text);
  trc.first_line = Split(lines.at(0), '\t');
  EXPECT_EQ(trc.first_line.at(0), "PathFileType");
  EXPECT_THAT(Split(lines.at(1), '\t'), ElementsAre("DataRate", "CameraRate", "NumFrames", "NumMarkers", "Units",
                                                    "OrigDataRate", "OrigDataStartFrame", "OrigNumFrames"));
  const std::vector<std::string> values = Split(lines.at(2), '\t');
  EXPECT_EQ(values.size(), 8U);
  trc.data_rate = ExactNumber(values.at(0));
  const auto frames = static_cast<std::size_t>(std::stoi(values.at(2)));
  const auto markers = static_cast<std::size_t>(std::stoi(values.at(3)));
  trc.units = values.at(4);
  for (const std::string& name : Split(lines.at(3), '\t')) {
    if (!name.empty()) trc.markers.push_back(name);
  }
  EXPECT_EQ(trc.markers.at(0), "Frame#");
  EXPECT_EQ(trc.markers.at(1), "Time");
  trc.markers.erase(trc.markers.begin(), trc.markers.begin() + 2);
  EXPECT_EQ(trc.markers.size(), markers);
  const std::vector<std::string> axes = Split(lines.at(4), '\t');
  EXPECT_EQ(axes.size(), 3 * markers + 2);
  EXPECT_EQ(axes.at(3 * markers + 1), fmt::format("Z{}", markers));
  EXPECT_EQ(lines.size(), frames + 5) << "the data begin in line 6, and no line is blank";
  for (std::size_t t = 0; t < frames; ++t) {
    const std::vector<std::string> fields = Split(lines.at(5 + t), '\t');
    EXPECT_EQ(fields.size(), 3 * markers + 2) << t;
    EXPECT_EQ(fields.at(0), std::to_string(t + 1));
    trc.time.push_back(ExactNumber(fields.at(1)));
    auto& frame = trc.frames.emplace_back();
    for (std::size_t m = 0; m < markers; ++m) {
      const std::string& x = fields.at(2 + 3 * m);
      const std::string& y = fields.at(3 + 3 * m);
      const std::string& z = fields.at(4 + 3 * m);
      if (x.empty() || y.empty() || z.empty()) {
        frame.emplace_back();
        EXPECT_TRUE(x.empty() && y.empty() && z.empty());
      } else {
        frame.emplace_back(Eigen::Vector3d(ExactNumber(x), ExactNumber(y), ExactNumber(z)));
      }
    }
  }
  return trc;
}

std::string TextOf(const Scene& scene, UpAxis up, FileUnit unit) {
  return TrcText(scene.people.front(), {scene, up, unit}, "walk 1.trc");
}

TEST(Trc, HoldsThePositionsYUpInMetres) {
  const Trc trc = ReadTrc(TextOf(StaticScene(), UpAxis::kY, FileUnit::kMetres));
  EXPECT_EQ(trc.data_rate, 50.0);
  EXPECT_EQ(trc.units, "m");
  EXPECT_THAT(trc.markers, ElementsAre("Hip", "LKnee", "RKnee"));
  EXPECT_THAT(trc.first_line, ElementsAre("PathFileType", "4", "(X/Y/Z)", "walk_1.trc"));
  ASSERT_EQ(trc.frames.size(), 10U);
  for (int t = 0; t < 10; ++t) {
    EXPECT_NEAR(trc.time[static_cast<std::size_t>(t)], t / 50.0, 1e-9);
    for (int j = 0; j < 3; ++j) {
      const std::optional<Eigen::Vector3d>& found =
          trc.frames[static_cast<std::size_t>(t)][static_cast<std::size_t>(j)];
      ASSERT_EQ(found.has_value(), !(j == 1 && t % 4 == 3)) << t << j;
      const Eigen::Vector3d place = PlaceOfJoint(t, j);
      // x stays, z up becomes y, and y becomes -z: a rotation.
      if (!found) continue;
      EXPECT_LT((1000.0 * *found - Eigen::Vector3d(place.x(), place.z(), -place.y())).norm(), 0.1) << t << j;
    }
  }
}

TEST(Trc, ZUpInMillimetres) {
  const Trc trc = ReadTrc(TextOf(StaticScene(), UpAxis::kZ, FileUnit::kMillimetres));
  EXPECT_EQ(trc.units, "mm");
  EXPECT_LT((*trc.frames[2][0] - PlaceOfJoint(2, 0)).norm(), 0.1);
}

TEST(Trc, SaysWhatIsUnknownAndChangesNothing) {
  const Scene scene = UnknownScene();
  const Trc trc = ReadTrc(TextOf(scene, UpAxis::kY, FileUnit::kMetres));
  EXPECT_EQ(trc.units, "unknown");
  ASSERT_EQ(trc.first_line.size(), 5U);
  EXPECT_EQ(trc.first_line[4], "unit: body lengths, up: unknown");
  EXPECT_LT((*trc.frames[2][0] - PlaceOfJoint(2, 0)).norm(), 1e-3);
}

TEST(Trc, SaysWhatWasDoneToThePositions) {
  const Scene scene = StaticScene();
  const Trc trc = ReadTrc(TrcText(scene.people.front(), {scene, UpAxis::kY, FileUnit::kMetres}, "a.trc", "low-pass"));
  ASSERT_EQ(trc.first_line.size(), 5U);
  EXPECT_EQ(trc.first_line[4], "low-pass");
}

TEST(Trc, SeventyThousandFrames) {
  Scene scene = StaticScene(0);
  scene.people = {MovingPerson("anna", 70'000)};
  const std::string text = TextOf(scene, UpAxis::kY, FileUnit::kMillimetres);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  const Trc trc = ReadTrc(text);
  ASSERT_EQ(trc.frames.size(), 70'000U);
  EXPECT_NEAR(trc.time.back(), 69'999 / 50.0, 1e-6);
  EXPECT_NEAR(trc.frames.back()[0]->x(), PlaceOfJoint(69'999, 0).x(), 0.1);
}

TEST(Trc, OtherTimesAndNames) {
  Scene scene = StaticScene(3);
  scene.people[0] = PoseSequence({"", {"a b", "c\td"}, {-1, 0}, 0, {0, 1}}, 3);
  scene.people[0].time_seconds = {0.5, 0.75, 1.0};
  const Trc trc = ReadTrc(TextOf(scene, UpAxis::kY, FileUnit::kMetres));
  EXPECT_THAT(trc.markers, ElementsAre("a_b", "c_d"));
  EXPECT_THAT(trc.time, ElementsAre(0.5, 0.75, 1.0));
  EXPECT_EQ(trc.data_rate, 4.0) << "from the time stamps";
  EXPECT_FALSE(trc.frames[0][0] || trc.frames[2][1]) << "rows may be empty but for their time";
}

// ---------------------------------------------------------------------------------------------------------------- MOT

struct Mot {
  std::map<std::string, std::string> header;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

Mot ReadMot(const std::string& text) {
  Mot mot;
  const std::vector<std::string> lines = Lines(text);
  std::size_t i = 1;  // after the title
  for (; lines.at(i) != "endheader"; ++i) {
    const std::size_t equals = lines[i].find('=');
    EXPECT_NE(equals, std::string::npos) << lines[i];
    mot.header[lines[i].substr(0, equals)] = lines[i].substr(equals + 1);
  }
  mot.columns = Split(lines.at(i + 1), '\t');
  for (i += 2; i < lines.size(); ++i) {
    auto& row = mot.rows.emplace_back();
    for (const std::string& field : Split(lines[i], '\t')) row.push_back(ExactNumber(field));
  }
  return mot;
}

TEST(AngleTable, HoldsTheAngles) {
  const PoseSequence person = MovingPerson("anna", 3);
  const std::vector<TimeSeries> angles = {{"knee_flexion_l", "deg", {10.25, NAN, 30.0}},
                                          {"ankle_l", "deg", {NAN, NAN, NAN}},
                                          {"trunk_lean", "deg", {-179.99994, 0.0, 1e-7}}};
  const Mot mot = ReadMot(AngleTable(angles, person, "walk"));
  EXPECT_EQ(mot.header.at("nRows"), "3");
  EXPECT_EQ(mot.header.at("nColumns"), "3");
  EXPECT_EQ(mot.header.at("inDegrees"), "yes");
  EXPECT_EQ(mot.header.at("version"), "1");
  EXPECT_THAT(mot.columns, ElementsAre("time", "knee_flexion_l", "trunk_lean")) << "nothing is known of the ankle";
  ASSERT_EQ(mot.rows.size(), 3U);
  EXPECT_NEAR(mot.rows[2][0], 0.04, 1e-9);
  EXPECT_NEAR(mot.rows[0][1], 10.25, 1e-4);
  EXPECT_TRUE(std::isnan(mot.rows[1][1]));
  EXPECT_NEAR(mot.rows[0][2], -179.99994, 1e-4);
}

TEST(AngleTable, SaysWhatWasDoneAndRefusesNothing) {
  const PoseSequence person = MovingPerson("anna", 1);
  const Mot mot = ReadMot(AngleTable({{"knee", "deg", {1.0}}}, person, "walk=1", "low-pass at 6 Hz"));
  EXPECT_EQ(mot.header.at("processing"), "low-pass at 6 Hz");
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kInvalidArgument,
                               [&] {
                                 AngleTable({{"knee", "deg", {NAN}}}, person, "walk");
                               }),
              HasSubstr("no joint angle of anna is known"));
}

// ---------------------------------------------------------------------------------------------------------------- CSV

TEST(SceneCsv, RowsOfFrames) {
  const Scene scene = StaticScene(4);
  const std::vector<std::string> lines = Lines(SceneCsv(scene, {scene, UpAxis::kZ, FileUnit::kMetres}));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0],
            "frame,time [s],Hip_x [m],Hip_y [m],Hip_z [m],LKnee_x [m],LKnee_y [m],LKnee_z [m],RKnee_x [m],RKnee_y [m],"
            "RKnee_z [m],Hip_confidence,LKnee_confidence,RKnee_confidence,Hip_sd [m],LKnee_sd [m],RKnee_sd [m],up");
  EXPECT_EQ(lines[4], "3,0.060000,1.021750,-0.489500,0.900296,,,,1.221750,-0.569500,0.100296,0.5,0,0.5,0.004030,,,z");
}

TEST(SceneCsv, SeveralPeopleAndUnknownUnits) {
  Scene scene = UnknownScene(1);
  scene.people.push_back(scene.people.front());
  scene.people.back().name = "anna";  // twice
  scene.people.back().fps = scene.people.front().fps = 0.0;
  const std::vector<std::string> lines = Lines(SceneCsv(scene, {scene, UpAxis::kZ, FileUnit::kMetres}));
  EXPECT_THAT(lines[0], ::testing::StartsWith("frame,anna:Hip_x [body lengths],"));
  EXPECT_THAT(lines[0], HasSubstr(",anna_2:RKnee_z [body lengths],"));
  EXPECT_THAT(lines[1], ::testing::StartsWith("0,1000.000000,"));
  EXPECT_THAT(lines[1], ::testing::EndsWith(",unknown"));
  const std::vector<std::string> filtered = Lines(SceneCsv(scene, {scene, UpAxis::kZ, FileUnit::kMetres}, "a, b"));
  EXPECT_THAT(filtered[0], ::testing::EndsWith(",up,processing"));
  EXPECT_THAT(filtered[1], ::testing::EndsWith(",unknown,\"a, b\""));
}

// --------------------------------------------------------------------------------------------------------------- JSON

TEST(SceneJson, HoldsEverything) {
  Scene scene = StaticScene(4);
  scene.cameras[1].calibration.assign(4, scene.cameras[1].calibration[0]);  // it moves
  scene.cameras[2].calibration.clear();
  scene.cameras[2].used = false;
  scene.cameras[2].why_not_used = "it saw \"nobody\"";
  const nlohmann::json json = nlohmann::json::parse(SceneJson(scene, {scene, UpAxis::kY, FileUnit::kMetres}));
  EXPECT_EQ(json["unit"], "m");
  EXPECT_TRUE(json["processing"].is_null());
  EXPECT_EQ(json["unit_from"], "the height given");
  EXPECT_EQ(json["up"], "y");
  EXPECT_EQ(json["fps"], 50.0);
  EXPECT_EQ(json["time"].get<std::vector<double>>(), (std::vector<double>{0.0, 0.02, 0.04, 0.06}));
  const nlohmann::json& person = json["people"].at(0);
  EXPECT_EQ(person["name"], "anna");
  EXPECT_EQ(person["joints"], (std::vector<std::string>{"Hip", "LKnee", "RKnee"}));
  ASSERT_EQ(person["positions"].size(), 4U);
  EXPECT_NEAR(person["positions"][2][1][1].get<double>(), 1e-3 * PlaceOfJoint(2, 1).z(), 1e-6);
  EXPECT_TRUE(person["positions"][3][1][0].is_null());
  EXPECT_EQ(person["confidence"][3], (std::vector<double>{0.5, 0.0, 0.5}));
  EXPECT_NEAR(person["standard_deviation"][0][0].get<double>(), 0.004, 1e-7);
  EXPECT_TRUE(person["standard_deviation"][0][2].is_null());
  ASSERT_EQ(json["cameras"].size(), 3U);
  EXPECT_EQ(json["cameras"][0]["K"][0][2], 955.5);
  EXPECT_EQ(json["cameras"][0]["image_size"], (std::vector<int>{1920, 1080}));
  EXPECT_EQ(json["cameras"][1]["t"].size(), 4U);
  EXPECT_EQ(json["cameras"][1]["R"][3].size(), 3U);
  EXPECT_TRUE(json["cameras"][2]["K"].is_null());
  EXPECT_EQ(json["cameras"][2]["why_not_used"], "it saw \"nobody\"");
}

TEST(SceneJson, UnknownsAreNull) {
  Scene scene = UnknownScene(2);
  scene.people[0].fps = 0.0;
  const nlohmann::json json = nlohmann::json::parse(SceneJson(scene, {scene, UpAxis::kZ, FileUnit::kMetres}));
  EXPECT_EQ(json["unit"], "body lengths");
  EXPECT_TRUE(json["unit_from"].is_null() && json["up_from"].is_null() && json["fps"].is_null());
  EXPECT_EQ(json["up"], "unknown");
  EXPECT_TRUE(json["time"][1].is_null());
}

}  // namespace
}  // namespace canonpose
