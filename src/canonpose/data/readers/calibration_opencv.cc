#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/readers/calibration_formats.h"
#include "canonpose/data/readers/opencv_keys.h"

namespace canonpose {
namespace {

/// The largest matrix of a calibration: 14 coefficients of a lens.
constexpr std::size_t kMostMatrixValues = 16;

/// One file, whose members stand at its top.
class OpenCvStorage {
 public:
  explicit OpenCvStorage(const std::filesystem::path& path) : file_(path.string()) {
    const std::string text = ReadFile(path);
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::Exception& error) {
      ThrowBadInput({file_, error.mark.is_null() ? "" : fmt::format("line {}", error.mark.line + 1),
                     "YAML as OpenCV's FileStorage writes it", error.msg, "restore the file or calibrate again"});
    }
    if (!root_.IsMap()) {
      ThrowBadInput({file_, "", "YAML as OpenCV's FileStorage writes it", "something else",
                     "give a file with names, K_NAME, dist_NAME, Rot_NAME and T_NAME"});
    }
  }

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool Has(const std::string& key) const { return root_[key].IsDefined(); }

  [[nodiscard]] std::string Text(const std::string& key) const { return AsText(root_[key], key); }

  [[nodiscard]] std::vector<std::string> Texts(const std::string& key) const {
    const YAML::Node node = root_[key];
    if (!node.IsDefined() || !node.IsSequence()) Fail(key, "a list of names");
    std::vector<std::string> texts;
    for (const YAML::Node& element : node) texts.push_back(AsText(element, key));
    return texts;
  }

  [[nodiscard]] double Number(const std::string& key) const { return AsNumber(root_[key], key); }

  /// The values of a matrix, row by row.
  [[nodiscard]] std::vector<double> Matrix(const std::string& key) const {
    const YAML::Node node = root_[key];
    if (!node.IsDefined() || !node.IsMap() || !node["data"].IsDefined() || !node["data"].IsSequence()) {
      Fail(key, "an !!opencv-matrix");
    }
    std::vector<double> numbers;
    for (const YAML::Node& element : node["data"]) {
      if (numbers.size() == kMostMatrixValues) Fail(key, "a small matrix");
      numbers.push_back(AsNumber(element, key));
    }
    const bool has_shape = node["rows"].IsDefined() && node["cols"].IsDefined();
    if (has_shape && AsNumber(node["rows"], key) * AsNumber(node["cols"], key) != static_cast<double>(numbers.size())) {
      Fail(key, "as many values as rows times cols");
    }
    return numbers;
  }

 private:
  [[noreturn]] void Fail(const std::string& key, const std::string& expected) const {
    ThrowBadInput({file_, key, expected, Has(key) ? "something else" : "nothing",
                   "give a file with names, K_NAME, dist_NAME, Rot_NAME or R_NAME, and T_NAME of every camera"});
  }
  [[nodiscard]] std::string AsText(const YAML::Node& node, const std::string& key) const {
    if (!node.IsDefined() || !node.IsScalar()) Fail(key, "a text");
    return node.Scalar();
  }
  [[nodiscard]] double AsNumber(const YAML::Node& node, const std::string& key) const {
    double number = 0.0;
    if (!node.IsDefined() || !node.IsScalar() || !YAML::convert<double>::decode(node, number)) Fail(key, "a number");
    return number;
  }

  std::string file_;
  YAML::Node root_;
};

/// EasyMocap keeps intrinsics and extrinsics in two files of these names.
std::filesystem::path FileOfExtrinsics(const std::filesystem::path& path) {
  if (LowerCase(path.stem().string()) != "intri") return path;
  const std::filesystem::path extrinsics = path.parent_path() / ("extri" + path.extension().string());
  return std::filesystem::exists(extrinsics) ? extrinsics : path;
}

std::vector<double> DistortionOf(const OpenCvStorage& storage, const std::string& key) {
  for (const char* const prefix : {"dist_", "D_"}) {
    if (storage.Has(prefix + key)) return storage.Matrix(prefix + key);
  }
  return {};
}

CalibratedCamera ReadOpenCvCamera(const OpenCvStorage& intrinsics, const OpenCvStorage& extrinsics,
                                  const std::string& key, double mm_per_unit) {
  CalibratedCamera calibrated;
  Camera& camera = calibrated.camera;
  camera.K = CheckedCameraMatrix(intrinsics.Matrix("K_" + key), {intrinsics.file(), "K_" + key});
  camera.distortion = CheckedDistortion(DistortionOf(intrinsics, key), {intrinsics.file(), "dist_" + key});
  const std::string rotation = (extrinsics.Has("Rot_" + key) ? "Rot_" : "R_") + key;
  camera.camera_from_world_rotation = CheckedRotation(extrinsics.Matrix(rotation), {extrinsics.file(), rotation});
  camera.camera_from_world_translation =
      CheckedTranslation(extrinsics.Matrix("T_" + key), mm_per_unit, {extrinsics.file(), "T_" + key});
  if (intrinsics.Has("W_" + key) && intrinsics.Has("H_" + key)) {
    const std::vector<double> size{intrinsics.Number("W_" + key), intrinsics.Number("H_" + key)};
    // EasyMocap writes -1 where it does not know.
    if (size[0] > 0.0) calibrated.image_size = CheckedImageSize(size, {intrinsics.file(), "W_" + key});
  }
  return calibrated;
}

}  // namespace

CalibratedCameras ReadOpenCvCalibration(const std::filesystem::path& path) {
  const OpenCvStorage intrinsics(path);
  const OpenCvStorage extrinsics(FileOfExtrinsics(path));
  const CalibrationPlace place{path.string(), "names"};
  const double mm_per_unit =
      intrinsics.Has("unit") ? MillimetresPerUnit(intrinsics.Text("unit"), {path.string(), "unit"}) : 1.0;
  CalibratedCameras calibration;
  for (const std::string& name : intrinsics.Texts("names")) {
    AddCalibratedCamera(calibration, name, ReadOpenCvCamera(intrinsics, extrinsics, OpenCvKey(name), mm_per_unit),
                        place);
  }
  if (calibration.empty()) place.Fail("at least one camera", "none");
  return calibration;
}

}  // namespace canonpose
