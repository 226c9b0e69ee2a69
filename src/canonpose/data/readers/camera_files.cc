#include "canonpose/data/readers/camera_files.h"

#include <algorithm>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/data/readers/flat_list.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

std::size_t RankOf(const fs::path& file, const CameraFiles& files) {
  const std::string extension = LowerCase(file.extension().string());
  return static_cast<std::size_t>(std::find(files.extensions.begin(), files.extensions.end(), extension) -
                                  files.extensions.begin());
}

/// The cameras that are files of one folder. Other files with such an extension are added to `others`.
std::vector<CameraInput> CamerasIn(const fs::path& folder, const CameraFiles& files, std::vector<fs::path>& others) {
  std::vector<CameraInput> cameras;
  for (const fs::path& file : FilesIn(folder, files.extensions)) {
    if (!files.is_ours(file)) {
      others.push_back(file);
      continue;
    }
    CameraInput camera{files.camera_name(file), file};
    // The same detections as csv and as h5 have the same name but for the extension.
    const auto twin = std::find_if(cameras.begin(), cameras.end(), [&](const CameraInput& other) {
      return other.path.stem() == file.stem() && RankOf(other.path, files) != RankOf(file, files);
    });
    if (twin == cameras.end()) {
      cameras.push_back(std::move(camera));
    } else if (RankOf(file, files) < RankOf(twin->path, files)) {
      *twin = std::move(camera);
    }
  }
  return cameras;
}

}  // namespace

std::vector<CameraInput> FindCameraFiles(const fs::path& path, const CameraFiles& files) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return {{files.camera_name(path), path}};
  std::vector<fs::path> others;
  std::vector<CameraInput> cameras = CamerasIn(path, files, others);
  if (cameras.empty()) {
    for (const fs::path& folder : FoldersIn(path)) {
      const std::vector<CameraInput> inside = CamerasIn(folder, files, others);
      if (inside.size() > 1) {
        ThrowBadInput({folder.string(), "", "one camera in each sub-folder", fmt::format("{} files", inside.size()),
                       "name the cameras with `camera` NAME=PATH"});
      }
      if (inside.size() == 1) cameras.push_back({CameraNameOf(folder), inside.front().path});
    }
  }
  if (cameras.empty()) {
    std::string found = DescribeFolder(path);
    if (found == kNoJsonFile) found = "none";
    if (!others.empty()) found = FirstAndCount(others) + ", which are not";
    const std::string format = LooksLikeFormat(path);
    const std::string advice =
        format.empty() ? AdviseFolder(path, "check the path") : fmt::format("this looks like the format {}", format);
    ThrowBadInput({path.string(), "", std::string(files.expected), found, advice});
  }
  if (!others.empty()) {
    const bool is_one = others.size() == 1;
    LogWarning("{} in {} {} left out: {}", is_one ? "a file" : fmt::format("{} files", others.size()), path.string(),
               is_one ? "has no keypoints of this format and is" : "have no keypoints of this format and are",
               FirstAndCount(others));
  }
  return cameras;
}

float LargestCoordinate(const DetectedCamera& camera) {
  float largest = 0.0F;
  for (const DetectedFrame& frame : camera.frames) {
    for (const DetectedPerson& person : frame.people) {
      for (const float coordinate : person.keypoints) {
        if (!std::isnan(coordinate)) largest = std::max(largest, std::abs(coordinate));
      }
    }
  }
  return largest;
}

void FractionsToPixels(DetectedCamera& camera, std::array<int, 2> image_size) {
  if (image_size[0] <= 0 || image_size[1] <= 0) {
    ThrowBadInput({camera.path, "", fmt::format("the image size of camera {}", camera.name),
                   "coordinates that are fractions of the image", "give `image_size` WxH"});
  }
  for (DetectedFrame& frame : camera.frames) {
    for (DetectedPerson& person : frame.people) {
      for (std::size_t i = 0; i < person.keypoints.size(); ++i)
        person.keypoints[i] *= static_cast<float>(image_size[i % 2]);
    }
  }
}

}  // namespace canonpose
