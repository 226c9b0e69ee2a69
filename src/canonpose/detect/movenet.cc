#include "canonpose/detect/movenet.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/detect/appearance.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix = "StatefulPartitionedCall/";
/// Below this the network sees a person in nearly every chair.
constexpr float kLeastCentreScore = 0.1F;

/// Outputs of the convolutions, in the order of PoseMaps; the last two only where people have boxes.
constexpr std::array<const char*, 6> kHeads{"kpt_heatmap_0/", "kpt_regress_0/", "center_0/",
                                            "kpt_offset_0/",  "box_scale_0/",   "box_offset_0/"};
/// A cell is 4 pixels wide.
constexpr int kCellsOf32 = 8;

std::vector<std::string> Heads(const GraphModel& model, bool has_boxes) {
  std::vector<std::string> heads(kHeads.begin(), has_boxes ? kHeads.end() : kHeads.end() - 2);
  for (std::string& head : heads) head = model.NodeLike(fmt::format("{}{}", kPrefix, head), "/BiasAdd").name;
  return heads;
}

/// Throws unless the heads have what decoding needs: for an input of 32x32, maps of 8x8 cells.
void RequireHeads(const GraphModel& model, const ConvNetwork& network) {
  static constexpr std::array<int, 6> kChannels{kPoseJoints, 2 * kPoseJoints, 1, 2 * kPoseJoints, 2, 2};
  const std::vector<std::array<int, 3>>& shapes = network.output_shapes();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto [height, width, channels] = shapes[i];
    if (height == kCellsOf32 && width == kCellsOf32 && channels == kChannels[i]) continue;
    ThrowBadInput({model.file, kPrefix + kHeads[i],
                   fmt::format("{}x{}x{} for an input of 32x32", kCellsOf32, kCellsOf32, kChannels[i]),
                   fmt::format("{}x{}x{}", height, width, channels), kGetDetectorAgain});
  }
}

std::vector<float> CentreWeight(const GraphModel& model) {
  const std::string name = "ConstantFolding/" + kPrefix + "truediv_2_recip";
  const GraphConstant& constant = model.Constant(name);
  constexpr std::size_t kCells = MoveNet::kCropSize / 32 * kCellsOf32;
  if (constant.values.size() != kCells * kCells) {
    ThrowBadInput({model.file, name, fmt::format("{} values", kCells * kCells),
                   fmt::format("{}", constant.values.size()), kGetDetectorAgain});
  }
  return constant.values;
}

float SingleValue(const GraphModel& model, const std::string& name) {
  const GraphConstant& constant = model.Constant(kPrefix + name);
  if (constant.values.empty()) {
    ThrowBadInput({model.file, kPrefix + name, "a number", "nothing", kGetDetectorAgain});
  }
  return constant.values.front();
}

GraphModel ReadPart(const fs::path& folder, const std::string& name, Fingerprint& fingerprint) {
  for (const char* extension : {".json", ".bin"}) {
    const fs::path file = folder / (name + extension);
    std::error_code error;
    if (!fs::exists(file, error)) {
      ThrowBadInput({file.string(), "", "the detector's network", "no such file",
                     "run scripts/get-detector, which downloads it once (145 MB, of which 22 MB are kept)"});
    }
    const std::string bytes = ReadFile(file);
    fingerprint.Add(bytes.data(), bytes.size());
  }
  return ReadGraphModel(folder / (name + ".json"));
}

}  // namespace

fs::path DefaultModelFolder() {
  if (const char* const models = std::getenv("CANONPOSE_MODELS"); models != nullptr && *models != '\0') return models;
  fs::path data;
  if (const char* const xdg = std::getenv("XDG_DATA_HOME"); xdg != nullptr && *xdg == '/') {
    data = xdg;
  } else if (const char* const home = std::getenv("HOME"); home != nullptr) {
    data = fs::path(home) / ".local" / "share";
  }
  return data / "canonpose" / "movenet";
}

MoveNetFiles MoveNetFiles::Read(const fs::path& folder) {
  Fingerprint fingerprint;
  MoveNetFiles files;
  files.thunder = ReadPart(folder, "movenet-thunder", fingerprint);
  files.multipose = ReadPart(folder, "movenet-multipose", fingerprint);
  files.fingerprint = fingerprint.value();
  return files;
}

MoveNet::Network::Network(const GraphModel& model, bool has_boxes)
    : scale(SingleValue(model, "truediv")), convolutions(model, kPrefix + "sub_1", Heads(model, has_boxes)) {
  RequireHeads(model, convolutions);
}

PoseMaps MoveNet::Network::Evaluate(const std::vector<float>& input, int height, int width) const {
  std::vector<FeatureMap> maps = convolutions.Evaluate(input, height, width);
  PoseMaps result{std::move(maps[0]), std::move(maps[1]), std::move(maps[2]), std::move(maps[3]), {}, {}};
  if (maps.size() > 4) {
    result.box_scale = std::move(maps[4]);
    result.box_offset = std::move(maps[5]);
  }
  return result;
}

MoveNet::MoveNet(const MoveNetFiles& files)
    : thunder_(files.thunder, false), multipose_(files.multipose, true), centre_weight_(CentreWeight(files.thunder)) {}

std::vector<DetectedPose> MoveNet::FindPeople(const cv::Mat& image) {
  const WholeImage whole = TakeWholeImage(image, kImageSize, multipose_.scale, input_);
  std::vector<DetectedPose> poses =
      DecodePoses(multipose_.Evaluate(input_, whole.height, whole.width), kLeastCentreScore);
  const Eigen::Vector2f extent =
      whole.image_pixels_per_pixel * Eigen::Vector2f(static_cast<float>(whole.width), static_cast<float>(whole.height));
  for (DetectedPose& pose : poses) {
    for (PosePoint& point : pose.joints) point.position = point.position.cwiseProduct(extent);
  }
  return poses;
}

DetectedPose MoveNet::PoseInCrop(const cv::Mat& image, const Crop& crop) {
  TakeCrop(image, crop, kCropSize, thunder_.scale, input_);
  DetectedPose pose = DecodeSinglePose(thunder_.Evaluate(input_, kCropSize, kCropSize), centre_weight_);
  for (PosePoint& point : pose.joints) point.position = crop.corner + crop.size * point.position;
  return pose;
}

Appearance MoveNet::AppearanceOf(const cv::Mat& image, const DetectedPose& pose) {
  return MeasureAppearance(image, pose);
}

DetectedPose MoveNet::PoseOf(const std::vector<float>& rgb) {
  input_ = rgb;
  for (float& value : input_) value = value * thunder_.scale - 1.0F;
  return DecodeSinglePose(thunder_.Evaluate(input_, kCropSize, kCropSize), centre_weight_);
}

}  // namespace canonpose
