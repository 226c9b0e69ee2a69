#include "canonpose/data/readers/freemocap.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/codecs/npy.h"
#include "canonpose/data/readers/camera_files.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/mediapipe_layout.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFreemocapAdvice =
    "give the 2D array that FreeMoCap writes to output_data/raw_data, "
    "mediapipe2dData_numCams_numFrames_numTrackedPoints_pixelXY.npy";
/// MediaPipe's sets that begin with the body: with both hands, and with face meshes of 468 and 478 points.
constexpr std::array<std::size_t, 3> kMediapipeSets{75, 543, 553};
/// Damaged files may claim anything.
constexpr std::size_t kMostCameras = 64;
constexpr double kLargestValue = 1e9;

/// The file of an array (cameras, frames, points, 2 or 3). Throws where it is another.
class PointsFile {
 public:
  explicit PointsFile(const fs::path& path) : array_(Checked(path)) {
    const std::vector<std::size_t>& shape = array_.shape();
    const bool fits = shape.size() == 4 && shape[2] > 0 && (shape[3] == 2 || shape[3] == 3);
    if (fits && array_.has_numbers() && shape[0] <= kMostCameras) return;
    std::string advice = kFreemocapAdvice;
    if (shape.size() == 3) advice += "; an array of three dimensions is 3D, or one camera's";
    ThrowBadInput({path.string(), "", "numbers (cameras, frames, points, 2 or 3)",
                   fmt::format("({})", fmt::join(shape, ", ")), advice});
  }

  [[nodiscard]] std::size_t cameras() const { return array_.shape()[0]; }
  [[nodiscard]] std::size_t frames() const { return array_.shape()[1]; }
  [[nodiscard]] std::size_t points() const { return array_.shape()[2]; }
  [[nodiscard]] std::size_t width() const { return array_.shape()[3]; }

  /// (frames, points, width) of one camera; NaN where a value can be no coordinate.
  [[nodiscard]] std::vector<double> Read(std::size_t camera) const {
    NpyArray part = array_.ReadPart(camera);
    std::vector<double> result;
    std::visit(
        [&](auto& values) {
          using Values = std::decay_t<decltype(values)>;
          if constexpr (std::is_same_v<Values, std::vector<double>>) {
            result = std::move(values);
          } else if constexpr (!std::is_same_v<Values, std::vector<std::string>>) {
            result.assign(values.begin(), values.end());
          }
        },
        part.values);
    for (double& value : result) {
      if (!(std::abs(value) <= kLargestValue)) value = NAN;
    }
    return result;
  }

 private:
  static const fs::path& Checked(const fs::path& path) {
    const std::string kind = KindOfFile(path);
    if (kind == "a NumPy file") return path;
    ThrowBadInput({path.string(), "", "a NumPy file (.npy)", kind.empty() ? "another file" : kind, kFreemocapAdvice});
  }

  npy::FileReader array_;
};

/// Whether the third values of a camera are confidences: MediaPipe's depth is negative in front of the hips.
bool HasConfidences(const std::vector<double>& values, std::size_t width) {
  if (width != 3) return false;
  for (std::size_t i = 2; i < values.size(); i += 3) {
    if (values[i] < 0.0 || values[i] > 1.0) return false;
  }
  return true;
}

/// The one 2D array in a folder; empty where there is none. Throws where there are several.
fs::path ArrayIn(const fs::path& folder) {
  std::vector<fs::path> arrays;
  for (const fs::path& file : FilesIn(folder, {".npy"})) {
    if (LowerCase(file.filename().string()).find("2d") != std::string::npos && IsFreemocapFile(file))
      arrays.push_back(file);
  }
  if (arrays.size() > 1) {
    ThrowBadInput({folder.string(), "", "one file of 2D points of all cameras", FirstAndCount(arrays),
                   "give the path of the file itself"});
  }
  return arrays.empty() ? fs::path() : arrays.front();
}

fs::path ArrayAt(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return path;
  for (const char* const below : {"", "raw_data", "output_data/raw_data", "output_data"}) {
    const fs::path folder = *below == '\0' ? path : path / below;
    if (!fs::is_directory(folder, error)) continue;
    if (fs::path array = ArrayIn(folder); !array.empty()) return array;
  }
  std::string found = DescribeFolder(path);
  if (found == kNoJsonFile) found = "none";
  ThrowBadInput(
      {path.string(), "", "FreeMoCap's 2D points (a .npy file with 2d in its name)", found, kFreemocapAdvice});
}

/// The names of the session's videos, in order, where there are `count`.
std::vector<std::string> CameraNames(const fs::path& array, std::size_t count) {
  fs::path folder = fs::absolute(array).parent_path();
  for (int level = 0; level < 3 && folder.has_parent_path(); ++level, folder = folder.parent_path()) {
    std::error_code error;
    const fs::path videos = folder / "synchronized_videos";
    if (!fs::is_directory(videos, error)) continue;
    std::vector<std::string> names;
    for (const fs::path& file : FilesIn(videos, {".mp4", ".avi", ".mov", ".mkv"}))
      names.push_back(file.stem().string());
    if (names.size() == count) return names;
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(fmt::format("camera{}", i));
  return names;
}

std::size_t PartOf(const CameraInput& input, std::size_t cameras) {
  std::size_t part = 0;
  if (!input.part.empty()) {
    const char* const end = input.part.data() + input.part.size();
    const auto [rest, error] = std::from_chars(input.part.data(), end, part);
    CANONPOSE_CHECK(error == std::errc() && rest == end, "part {}", input.part);
  }
  if (part >= cameras) {
    ThrowBadInput({input.path.string(), "", fmt::format("camera {}", part), fmt::format("{} cameras", cameras),
                   kFreemocapAdvice});
  }
  return part;
}

}  // namespace

bool IsFreemocapFile(const fs::path& file) {
  if (KindOfFile(file) != "a NumPy file") return false;
  try {
    const PointsFile points(file);
    return true;
  } catch (const Error&) {
    return false;
  }
}

std::vector<CameraInput> FindFreemocapCameras(const fs::path& path) {
  const fs::path array = ArrayAt(path);
  const std::size_t count = PointsFile(array).cameras();
  if (count == 0) ThrowBadInput({array.string(), "", "points of cameras", "no camera", kFreemocapAdvice});
  const std::vector<std::string> names = CameraNames(array, count);
  std::vector<CameraInput> cameras;
  for (std::size_t i = 0; i < count; ++i) cameras.push_back({names[i], array, fmt::format("{}", i)});
  return cameras;
}

DetectedCamera ReadFreemocap(const CameraInput& input) {
  const std::string file = input.path.string();
  const PointsFile points(input.path);
  const std::size_t count = points.points();
  const std::size_t width = points.width();
  const std::size_t part = PartOf(input, points.cameras());
  const std::vector<double> values = points.Read(part);
  const bool has_confidences = HasConfidences(values, width);
  const bool is_mediapipe = count == kMediapipePoints ||
                            std::find(kMediapipeSets.begin(), kMediapipeSets.end(), count) != kMediapipeSets.end();
  const std::size_t read = is_mediapipe ? kMediapipePoints : count;
  CameraBuilder builder(input);
  if (is_mediapipe) builder.SetLayout(DetectedMediapipeLayout(), file, "");
  if (is_mediapipe && count > kMediapipePoints) builder.NoteUnusedPart("hands");
  if (is_mediapipe && count > kMediapipeSets.front()) builder.NoteUnusedPart("face");
  if (!is_mediapipe) builder.NoteKeypointCount(count);
  for (std::size_t t = 0; t < points.frames(); ++t) {
    const std::string place = fmt::format("camera {}, frame {}", part, t);
    DetectedFrame& frame = builder.Frame(static_cast<std::int64_t>(t), place, file, place);
    const double* const row = values.data() + t * count * width;
    std::vector<double> triples;
    for (std::size_t k = 0; k < read; ++k) {
      const double* const point = row + k * width;
      triples.insert(triples.end(), {point[0], point[1], has_confidences ? point[2] : 1.0});
    }
    std::optional<DetectedPerson> person = is_mediapipe ? PersonFromNamedTriples(triples) : PersonFromTriples(triples);
    if (person) builder.Add(frame, std::move(*person), file, place);
  }
  DetectedCamera camera = builder.Finish(false);
  if (LargestCoordinate(camera) <= kLargestImageFraction) FractionsToPixels(camera, input.image_size);
  return camera;
}

}  // namespace canonpose
