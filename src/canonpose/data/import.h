// From detectors' files to a dataset: read, follow one person, check the layout, line up the cameras, map to a
// skeleton.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// How the frames of several cameras belong together.
enum class FrameAlignment {
  kOrder,        ///< the n-th frame of each; their counts must agree
  kFrameNumber,  ///< by frame number; a frame that a camera lacks is missing there
};

struct ImportOptions {
  std::string format;                        ///< "openpose", "alphapose", "mmpose" or "coco"
  std::vector<std::filesystem::path> paths;  ///< one camera each, or several where a path is a folder of cameras
  std::vector<CameraInput> cameras;          ///< cameras named by the user; they replace those of the same name or path
  std::string layout;                        ///< the detector's layout; empty: by number of keypoints and anatomy
  std::string skeleton = "h36m-17";          ///< what to map to; "native" keeps the detector's joints
  int person = 1;                            ///< whom to follow, 1 = the most prominent
  std::map<std::string, int> camera_person;  ///< the same for single cameras
  std::array<int, 2> image_size{0, 0};       ///< width, height in pixels of all cameras; 0: from `calibration`
  std::map<std::string, std::array<int, 2>> camera_image_size;  ///< the same for single cameras
  std::filesystem::path calibration;                            ///< JSON with the cameras by name; empty: none
  FrameAlignment alignment = FrameAlignment::kOrder;
  std::string name = "clip";  ///< of the sequence
  std::string subject;        ///< empty: the sequence's name
  std::string
      capture;       ///< empty: the name and a hash of the keypoints, so that no two imports share cameras by accident
  double fps = 0.0;  ///< 0: unknown
  bool moving_cameras = false;

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// A dataset of one sequence. Throws Error(kBadInput) for whatever is wrong with the files, also where there is only
/// one camera.
Dataset ImportDetections(const ImportOptions& options);

/// What `lift` needs to read a detector's file as the training data was read.
struct SingleCameraOptions {
  std::string format;             ///< empty: from the content
  std::string layout;             ///< empty: by number of keypoints and anatomy
  double confidence_scale = 0.0;  ///< what to divide confidences by; 0: their largest, if above 1
  Skeleton skeleton;              ///< what to map to; without joints: the detector's own
  std::string camera;             ///< which one, by name, that must be there; empty: there must be one
  int person = 1;
  std::array<int, 2> image_size{0, 0};  ///< kept as it is
};

struct SingleCamera {
  CameraView view;
  std::vector<std::int64_t> frame_numbers;  ///< (T)
  Skeleton skeleton;                        ///< of the view
  DatasetSource source;                     ///< how it was read
};

/// One camera of a detector's file or folder. Throws Error(kBadInput).
SingleCamera ReadSingleCamera(const std::filesystem::path& path, const SingleCameraOptions& options);

/// Parses "1920x1080". Throws Error(kInvalidArgument).
std::array<int, 2> ParseImageSize(const std::string& text);

}  // namespace canonpose
