#include <charconv>
#include <cmath>
#include <string>

#include <Eigen/LU>
#include <fmt/format.h>
#include <pugixml.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/readers/calibration_formats.h"

namespace canonpose {
namespace {

/// Focal lengths and principal points are in 64ths of a pixel.
constexpr double kQualisysPixel = 64.0;

/// An element of a camera and its place in the file.
struct QualisysElement {
  pugi::xml_node node;
  CalibrationPlace place;

  [[nodiscard]] double Number(const char* attribute) const {
    const std::string text = node.attribute(attribute).value();
    const char* begin = text.c_str();
    const char* const end = begin + text.size();
    if (*begin == '+') ++begin;
    double number = 0.0;
    const auto [stop, error] = std::from_chars(begin, end, number);
    if (error != std::errc() || stop != end || !std::isfinite(number)) {
      place.At(attribute).Fail("a number", text.empty() ? "nothing" : '"' + text + '"');
    }
    return number;
  }
  [[nodiscard]] QualisysElement Child(const char* name) const {
    const pugi::xml_node child = node.child(name);
    if (!child) place.At(name).Fail("an element of each camera", "none", "export the calibration from QTM again");
    return {child, place.At(name)};
  }
};

/// The camera's axes in the file are x right, y up, z backwards; r11 to r33 are world_from_camera column by column.
Eigen::Matrix3d QualisysRotation(const QualisysElement& transform) {
  std::vector<double> numbers;
  for (const char* const name : {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"}) {
    numbers.push_back(transform.Number(name));
  }
  for (std::size_t i = 3; i < 9; ++i) numbers[i] = -numbers[i];
  return CheckedRotation(numbers, transform.place);
}

CalibratedCamera ReadQualisysCamera(const QualisysElement& element) {
  CalibratedCamera calibrated;
  Camera& camera = calibrated.camera;
  const QualisysElement view = element.Child("fov_video");
  const double left = view.Number("left");
  const double top = view.Number("top");
  calibrated.image_size = CheckedImageSize(
      std::vector<double>{view.Number("right") - left + 1.0, view.Number("bottom") - top + 1.0}, view.place);
  const QualisysElement lens = element.Child("intrinsic");
  const std::vector<double> K{lens.Number("focalLengthU") / kQualisysPixel,
                              lens.node.attribute("skew") ? lens.Number("skew") / kQualisysPixel : 0.0,
                              lens.Number("centerPointU") / kQualisysPixel - left,
                              0.0,
                              lens.Number("focalLengthV") / kQualisysPixel,
                              lens.Number("centerPointV") / kQualisysPixel - top,
                              0.0,
                              0.0,
                              1.0};
  camera.K = CheckedCameraMatrix(K, lens.place);
  camera.distortion = {lens.Number("radialDistortion1"), lens.Number("radialDistortion2"),
                       lens.Number("tangentalDistortion1"), lens.Number("tangentalDistortion2"),
                       lens.node.attribute("radialDistortion3") ? lens.Number("radialDistortion3") : 0.0};
  const QualisysElement transform = element.Child("transform");
  camera.camera_from_world_rotation = QualisysRotation(transform);
  const Eigen::Vector3d centre_mm(transform.Number("x"), transform.Number("y"), transform.Number("z"));
  camera.camera_from_world_translation = -camera.camera_from_world_rotation * centre_mm;
  return calibrated;
}

}  // namespace

CalibratedCameras ReadQualisysCalibration(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string text = ReadFile(path);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) {
    ThrowBadInput({file, fmt::format("byte {}", result.offset), "XML", result.description(),
                   "export the calibration from QTM again"});
  }
  CalibratedCameras calibration;
  for (const pugi::xml_node node : document.child("calibration").child("cameras").children("camera")) {
    const std::string serial = node.attribute("serial").value();
    const CalibrationPlace place{file, "camera " + serial};
    if (serial.empty()) place.Fail("a serial number", "none", "export the calibration from QTM again");
    AddCalibratedCamera(calibration, serial, ReadQualisysCamera({node, place}), place);
  }
  if (calibration.empty()) {
    ThrowBadInput(
        {file, "calibration/cameras", "at least one camera of Qualisys Track Manager", "none", "give its .qca.txt"});
  }
  return calibration;
}

}  // namespace canonpose
