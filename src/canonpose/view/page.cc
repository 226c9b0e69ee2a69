#include "canonpose/view/page.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "canonpose/base/error.h"
#include "canonpose/base/version.h"
#include "canonpose/view/camera_difference.h"
#include "canonpose/view/display_frame.h"
#include "canonpose/view/joint_sides.h"
#include "canonpose/view/packed_arrays.h"

// What CMakeLists.txt makes of viewer/, built in by page_files.S.
extern "C" {
extern const char canonpose_page_html_begin[];
extern const char canonpose_page_html_end[];
extern const char canonpose_page_style_begin[];
extern const char canonpose_page_style_end[];
extern const char canonpose_page_script_begin[];
extern const char canonpose_page_script_end[];
}

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

// Finer than anybody sees, and coarse enough to be small.
constexpr double kPositionStepMetres = 2e-4;  ///< on a display (DisplayFrame), where adults are 1.7 tall
constexpr double kKeypointSteps = 8192;       ///< per diagonal of the image
constexpr double kConfidenceStep = 1.0 / 31.0;
constexpr double kDeviationStep = 0.125;  ///< in powers of two: 9 %
constexpr double kAngleStep = 0.1;
constexpr double kRotationStep = 5e-5;  ///< of a quaternion's elements: 0.006 degrees
constexpr double kRelativeFocalStep = 1e-4;

/// NaN and infinity, which JSON lacks, become null.
Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <typename Matrix>
Json Numbers(const Matrix& matrix) {
  Json numbers = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) numbers.push_back(Number(matrix(r, c)));
  }
  return numbers;
}

Json Numbers(const std::vector<float>& values) {
  Json numbers = Json::array();
  for (const float value : values) numbers.push_back(Number(value));
  return numbers;
}

/// Writes a scene as the page reads it.
class SceneWriter {
 public:
  SceneWriter(const ShownScene& shown, const DisplayFrame& display, PackedArrays& arrays)
      : shown_(shown), display_(display), arrays_(arrays) {}

  [[nodiscard]] Json Write() {
    const Scene& scene = shown_.scene;
    Json json;
    json["name"] = scene.name;
    json["capture"] = shown_.capture;
    const PoseSequence empty;
    const PoseSequence& first = scene.people.empty() ? empty : scene.people.front();
    json["frames"] = first.frame_count();
    json["fps"] = first.fps;
    json["times"] = first.time_seconds;
    json["unit"] = ToString(first.unit);
    json["up"] = scene.up.source;
    json["scale"] = scene.scale.source;
    json["display"] = {{"rotation", Numbers(display_.rotation)},
                       {"origin", Numbers(display_.origin)},
                       {"scale", display_.scale},
                       {"upIsGuess", display_.up_is_guess},
                       {"floorIsGuess", display_.floor_is_guess},
                       {"isMetric", display_.is_metric}};
    json["people"] = Json::array();
    for (std::size_t p = 0; p < scene.people.size(); ++p) json["people"].push_back(WritePerson(p));
    const std::vector<CameraDifference> differences = CompareCameras(shown_);
    json["cameras"] = Json::array();
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) json["cameras"].push_back(WriteCamera(c, differences[c]));
    return json;
  }

 private:
  [[nodiscard]] double PositionStep() const { return kPositionStepMetres / display_.scale; }

  Json WritePerson(std::size_t p) {
    const PoseSequence& person = shown_.scene.people[p];
    const Skeleton& skeleton = person.skeleton();
    const int joints = person.joint_count();
    Json json;
    json["name"] = person.name;
    json["joints"] = skeleton.joints;
    json["parents"] = skeleton.parents;
    json["root"] = skeleton.root;
    json["sides"] = JointSides(skeleton);
    json["bones"] = BoneLengthSum(person);
    json["positions"] = arrays_.Add(person.positions(), 3 * joints, {PositionStep()});
    json["confidence"] = arrays_.Add(person.confidence(), joints, {kConfidenceStep});
    const std::vector<float>& deviations = person.standard_deviation();
    const bool has_deviations = std::ranges::any_of(deviations, [](float d) { return d > 0.0F; });
    json["deviations"] = has_deviations ? arrays_.Add(deviations, joints, {kDeviationStep, true}) : Json(nullptr);
    json["series"] = Json::array();
    json["contacts"] = Json::array();
    if (p < shown_.analyses.size()) WriteAnalysis(shown_.analyses[p], json);
    return json;
  }

  void WriteAnalysis(const Analysis& analysis, Json& json) {
    for (const TimeSeries& series : analysis.angles) {
      const std::vector<float> values(series.values.begin(), series.values.end());
      json["series"].push_back(
          {{"name", series.name}, {"unit", series.unit}, {"values", arrays_.Add(values, 1, {kAngleStep})}});
    }
    for (const FootContact& contact : analysis.contacts) {
      json["contacts"].push_back(
          {{"left", contact.is_left}, {"first", contact.first_frame}, {"last", contact.last_frame}});
    }
  }

  Json WriteCamera(std::size_t c, const CameraDifference& difference) {
    const SceneCamera& camera = shown_.scene.cameras[c];
    Json json;
    json["name"] = camera.name;
    json["size"] = camera.image_size_px;
    json["used"] = camera.used;
    json["whyNot"] = camera.why_not_used;
    json["timeOffset"] = camera.time_offset_seconds;
    json["calibration"] = WriteCalibration(camera);
    json["differenceByFrame"] = arrays_.Add(difference.by_frame_px, 1, {0.05});
    json["differenceByJoint"] = Numbers(difference.by_joint_px);
    json["medianPx"] = Number(difference.median_px);
    json["medianPercent"] = Number(difference.median_percent);
    json["detections"] = Json::array();
    for (const std::vector<ViewKeypoints>& of_person : shown_.detections) {
      json["detections"].push_back(WriteDetections(camera, of_person[c], json["detections"].size()));
    }
    return json;
  }

  Json WriteDetections(const SceneCamera& camera, const ViewKeypoints& detections, std::size_t p) {
    if (detections.empty()) return nullptr;
    const int joints = shown_.scene.people[p].joint_count();
    const double diagonal = std::hypot(camera.image_size_px[0], camera.image_size_px[1]);
    const double step = std::max(diagonal, 1.0) / kKeypointSteps;
    Json json;
    json["keypoints"] = arrays_.Add(detections.keypoints, 2 * joints, {step});
    json["confidence"] = arrays_.Add(detections.confidence, joints, {kConfidenceStep});
    return json;
  }

  /// Null where it is unknown. `focal` and `centre` are 2 numbers, `distortion` 5, and of a static camera `rotation` 9
  /// and `translation` 3; of a moving one `quaternion` (x, y, z, w) and `position` in the world are arrays, as is
  /// `focal`.
  Json WriteCalibration(const SceneCamera& camera) {
    if (camera.calibration.empty()) return nullptr;
    const Camera& first = camera.calibration.front();
    Json json;
    json["centre"] = {first.K(0, 2), first.K(1, 2)};
    json["distortion"] = first.distortion;
    if (camera.calibration.size() == 1) {
      json["focal"] = {first.K(0, 0), first.K(1, 1)};
      json["rotation"] = Numbers(first.camera_from_world_rotation);
      json["translation"] = Numbers(first.camera_from_world_translation);
      return json;
    }
    std::vector<float> focal;
    std::vector<float> quaternions;
    std::vector<float> positions;
    Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
    for (const Camera& one : camera.calibration) {
      const Eigen::Matrix3d& rotation = one.camera_from_world_rotation;
      Eigen::Quaterniond quaternion(rotation);
      if (quaternion.dot(before) < 0.0) quaternion.coeffs() *= -1.0;
      if (quaternion.coeffs().allFinite()) before = quaternion;
      const Eigen::Vector3d position = -rotation.transpose() * one.camera_from_world_translation;
      for (const double f : {one.K(0, 0), one.K(1, 1)}) focal.push_back(static_cast<float>(f));
      for (const double q : quaternion.coeffs()) quaternions.push_back(static_cast<float>(q));
      for (const double x : position) positions.push_back(static_cast<float>(x));
    }
    json["focal"] = arrays_.Add(focal, 2, {kRelativeFocalStep * std::max(first.K(0, 0), 1.0)});
    json["quaternion"] = arrays_.Add(quaternions, 4, {kRotationStep});
    json["position"] = arrays_.Add(positions, 3, {PositionStep()});
    return json;
  }

  const ShownScene& shown_;
  const DisplayFrame& display_;
  PackedArrays& arrays_;
};

Json ParseReport(const std::string& text) { return text.empty() ? Json(nullptr) : Json::parse(text); }

/// The scene of `scenes` with this name, otherwise that at this place.
const ShownScene* Counterpart(const std::vector<ShownScene>& scenes, const std::string& name, std::size_t place) {
  for (const ShownScene& shown : scenes) {
    if (shown.scene.name == name) return &shown;
  }
  return place < scenes.size() ? &scenes[place] : nullptr;
}

Json WriteResults(const std::vector<ShownResult>& results, PackedArrays& arrays) {
  Json json = Json::array();
  for (const ShownResult& result : results) {
    Json one;
    one["name"] = result.name;
    one["solve"] = ParseReport(result.solve_report);
    one["evaluation"] = ParseReport(result.evaluation);
    one["scenes"] = Json::array();
    for (std::size_t s = 0; s < result.scenes.size(); ++s) {
      const ShownScene& shown = result.scenes[s];
      const ShownScene* like =
          &result == &results.front() ? nullptr : Counterpart(results.front().scenes, shown.scene.name, s);
      const DisplayFrame display = like == nullptr
                                       ? MakeDisplayFrame(shown.scene)
                                       : MakeDisplayFrameLike(like->scene, MakeDisplayFrame(like->scene), shown.scene);
      one["scenes"].push_back(SceneWriter(shown, display, arrays).Write());
    }
    json.push_back(one);
  }
  return json;
}

/// JSON that may stand in a script element: no `<`, and so neither its end nor a comment.
std::string JsonInHtml(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

/// Puts `text` in the place of the only `mark`.
void Fill(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t place = page.find(mark);
  CANONPOSE_CHECK(place != std::string::npos, "the page lacks {}", mark);
  page.replace(place, mark.size(), text);
}

std::string TitleInHtml(const std::vector<ShownResult>& results) {
  std::string title;
  for (const ShownResult& result : results) {
    title += title.empty() ? "" : " and ";
    for (const char c : result.name) {
      if (c == '<') {
        title += "&lt;";
      } else if (c == '&') {
        title += "&amp;";
      } else {
        title += c;
      }
    }
  }
  return title;
}

}  // namespace

std::string MakePage(const std::vector<ShownResult>& results) {
  CANONPOSE_CHECK(!results.empty());
  PackedArrays arrays;
  Json data;
  data["version"] = 1;
  data["program"] = ProgramVersion();
  data["results"] = WriteResults(results, arrays);
  std::string page(canonpose_page_html_begin, canonpose_page_html_end);
  // From the end, so that no mark is looked for in what was put in before.
  Fill(page, "{{script}}",
       std::string_view(canonpose_page_script_begin,
                        static_cast<std::size_t>(canonpose_page_script_end - canonpose_page_script_begin)));
  Fill(page, "{{arrays}}", Base64(Gzip(arrays.bytes())));
  Fill(page, "{{data}}", JsonInHtml(data));
  Fill(page, "{{style}}",
       std::string_view(canonpose_page_style_begin,
                        static_cast<std::size_t>(canonpose_page_style_end - canonpose_page_style_begin)));
  Fill(page, "{{title}}", TitleInHtml(results));
  return page;
}

}  // namespace canonpose
