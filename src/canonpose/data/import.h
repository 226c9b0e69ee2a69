// From detectors' files to a dataset: read them, follow one person, check the layout, align the cameras, map the joints
// to a skeleton.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/data/frame_alignment.h"
#include "canonpose/data/readers/detections.h"

namespace canonpose {

struct ImportOptions {
  std::string format;                        ///< the name of one of DetectionFormats()
  std::vector<std::filesystem::path> paths;  ///< one camera per path, or several where a path is a folder of cameras
  std::vector<CameraInput> cameras;  ///< cameras named by the user; they replace those with the same name or path
  /// The detector's layout, or a JSON file with a skeleton of the user's own (skeleton_json.h). Empty: what the files
  /// say, or else recognised by the number of keypoints and by anatomy.
  std::string layout;
  /// The skeleton to map to; "native" keeps the detector's joints. Empty: h36m-17, or native where the layout is not
  /// one of the program's and does not have a person's joints.
  std::string skeleton;
  int person = 1;                            ///< who to follow; 1 is the most prominent person
  std::map<std::string, int> camera_person;  ///< the same for single cameras
  /// Everybody instead: cameras get tracks (CameraView::tracks), and `solve` finds who is who.
  bool everybody = false;
  std::array<int, 2> image_size{0, 0};  ///< width, height in pixels of all cameras; 0: from video.json or `calibration`
  std::map<std::string, std::array<int, 2>> camera_image_size;  ///< the same for single cameras
  std::filesystem::path calibration;                            ///< the cameras by name (calibration.h); empty: none
  FrameAlignment alignment = FrameAlignment::kAutomatic;
  std::string name = "clip";  ///< of the sequence
  std::string subject;        ///< empty: the sequence's name
  /// Empty: the name and a hash of the keypoints, so that no two imports accidentally share cameras.
  std::string capture;
  double fps = 0.0;  ///< 0: from the names of the frames where these are times, otherwise unknown
  std::map<std::string, double> camera_fps;  ///< the same for single cameras
  bool moving_cameras = false;

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// A dataset of one sequence. Throws Error(kBadInput) for anything wrong with the files, including that there is only
/// one camera.
Dataset ImportDetections(const ImportOptions& options);

/// What `lift` needs to read a detector's file in the way that the training data was read.
struct SingleCameraOptions {
  std::string format;             ///< empty: recognised by the content
  std::string layout;             ///< empty: recognised by number of keypoints and anatomy
  double confidence_scale = 0.0;  ///< what to divide confidences by; 0: their largest, if above 1
  Skeleton skeleton;              ///< the skeleton to map to; without joints: keep the detector's
  std::string camera;             ///< the name of the camera to read; empty: the only one
  int person = 1;
  std::array<int, 2> image_size{
      0, 0};  ///< of the view; 0: from video.json, or unknown. A warning says where keypoints contradict it
};

struct SingleCamera {
  CameraView view;
  std::vector<std::int64_t> frame_numbers;  ///< (T)
  double fps = 0.0;                         ///< from the names of the frames where these are times; 0: unknown
  Skeleton skeleton;                        ///< of the view
  DatasetSource source;                     ///< how it was read
};

/// One camera of a detector's file or folder. Throws Error(kBadInput).
SingleCamera ReadSingleCamera(const std::filesystem::path& path, const SingleCameraOptions& options);

/// Parses "1920x1080". Throws Error(kInvalidArgument).
std::array<int, 2> ParseImageSize(const std::string& text);

}  // namespace canonpose
