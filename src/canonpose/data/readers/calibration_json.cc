#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/calibration_formats.h"

namespace canonpose {
namespace {

CalibrationPlace JsonPlace(const JsonValue& value) { return {value.file(), value.place()}; }

std::vector<double> JsonRows(const JsonValue& value) {
  if (value.ArraySize() != 3) value.Fail("3 rows of 3 values");
  std::vector<double> matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    const JsonValue line = value.At(row);
    const std::vector<double> numbers = line.Numbers();
    if (numbers.size() != 3) line.Fail("3 values");
    matrix.insert(matrix.end(), numbers.begin(), numbers.end());
  }
  return matrix;
}

/// How deep arrays are nested, by their first elements.
int DepthOf(const JsonValue& value) {
  int depth = 0;
  for (const nlohmann::json* inner = &value.json(); inner->is_array(); inner = &inner->front()) {
    ++depth;
    if (inner->empty()) break;
  }
  return depth;
}

/// A value that is one array of `depth` dimensions, or one such array per frame.
class JsonOverTime {
 public:
  JsonOverTime(const JsonValue& value, int depth) : value_(value), moves_(DepthOf(value) > depth) {}
  /// 0 where there is one for all frames.
  [[nodiscard]] std::size_t frame_count() const { return moves_ ? value_.ArraySize() : 0; }
  [[nodiscard]] JsonValue At(std::size_t frame) const { return moves_ ? value_.At(frame) : value_; }

 private:
  JsonValue value_;
  bool moves_;
};

std::array<int, 2> JsonImageSize(const JsonValue& value) { return CheckedImageSize(value.Numbers(), JsonPlace(value)); }

CalibratedCamera ReadJsonCamera(const JsonValue& value, double mm_per_unit) {
  const JsonOverTime K(value["K"], 2);
  const auto camera_matrix = [&](std::size_t frame) {
    return CheckedCameraMatrix(JsonRows(K.At(frame)), JsonPlace(K.At(frame)));
  };
  camera_matrix(0);  // the first thing to be wrong is reported first
  const JsonOverTime R(value["R"], 2);
  const JsonOverTime t(value["t"], 1);
  std::optional<JsonOverTime> distortion;
  if (const std::optional<JsonValue> found = value.Find("distortion")) distortion.emplace(*found, 1);
  const std::array<std::size_t, 4> counts{K.frame_count(), R.frame_count(), t.frame_count(),
                                          distortion ? distortion->frame_count() : 0};
  const std::size_t frames = *std::ranges::max_element(counts);
  for (const std::size_t count : counts) {
    if (count == 0 || count == frames) continue;
    value.Fail(fmt::format("one value or {} values of each of K, R, t and distortion", frames), "",
               fmt::format("{} of one", count));
  }
  const auto read = [&](std::size_t frame) {
    Camera camera;
    camera.K = camera_matrix(frame);
    camera.camera_from_world_rotation = CheckedRotation(JsonRows(R.At(frame)), JsonPlace(R.At(frame)));
    camera.camera_from_world_translation =
        CheckedTranslation(t.At(frame).Numbers(), mm_per_unit, JsonPlace(t.At(frame)));
    if (distortion) {
      camera.distortion = CheckedDistortion(distortion->At(frame).Numbers(), JsonPlace(distortion->At(frame)));
    }
    return camera;
  };
  CalibratedCamera calibrated;
  calibrated.camera = read(0);
  for (std::size_t frame = 0; frames > 1 && frame < frames; ++frame) calibrated.per_frame.push_back(read(frame));
  if (const std::optional<JsonValue> size = value.Find("image_size")) calibrated.image_size = JsonImageSize(*size);
  return calibrated;
}

}  // namespace

CalibratedCameras ReadJsonCalibration(const std::filesystem::path& path) {
  const JsonValue root = JsonValue::Load(path);
  const JsonValue cameras = root["cameras"];
  double mm_per_unit = 1.0;
  if (const std::optional<JsonValue> units = root.Find("units")) {
    mm_per_unit = MillimetresPerUnit(units->String(), JsonPlace(*units));
  }
  CalibratedCameras calibration;
  for (const std::string& name : cameras.Keys()) {
    CalibratedCamera camera = ReadJsonCamera(cameras[name], mm_per_unit);
    const std::optional<JsonValue> common_size = root.Find("image_size");
    if (!camera.image_size && common_size) camera.image_size = JsonImageSize(*common_size);
    calibration.emplace(name, camera);
  }
  if (calibration.empty()) cameras.Fail("at least one camera", "", "none");
  return calibration;
}

}  // namespace canonpose
