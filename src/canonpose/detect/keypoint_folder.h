// What `detect` writes of a video: a folder with one file per frame as OpenPose writes them, and video.json.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/detect/tracker.h"

namespace canonpose {

/// The people of a video.
struct VideoKeypoints {
  std::string name;                              ///< of the camera
  std::string video;                             ///< file name of the video, or the folder's name
  std::array<int, 2> image_size{0, 0};           ///< width, height of the frames, turned upright
  double fps = 0.0;                              ///< mean; 0 where unknown
  int rotation_degrees = 0;                      ///< by which the frames were turned
  long frames_skipped = 0;                       ///< damaged, or missing at the end
  std::string model;                             ///< what found the keypoints
  std::string subject;                           ///< fingerprint of video, networks and options
  std::vector<double> times_seconds;             ///< (T); empty where unknown
  std::vector<std::vector<TrackedPose>> frames;  ///< (T)
};

/// Mean frames per second; `stated`, the container's own figure, where it is the same within one in a thousand. 0 where
/// there are fewer than two times and nothing is stated.
double MeanRate(const std::vector<double>& times_seconds, double stated);

/// Leaves out people who are seen in too few frames to be people, marks covered joints, numbers people from 0 by how
/// much is seen of them, and leaves out joints outside of the image.
void FinishPeople(VideoKeypoints& keypoints);

/// Writes `folder`, which appears as a whole: NAME_000000000000_keypoints.json and so on, in the layout coco-17 with
/// person_id, and video.json; it is on disk for good when this returns. The same keypoints give the same bytes. Throws
/// Error(kBadInput) where `folder` exists and is not empty, or cannot be written.
void WriteKeypointFolder(const std::filesystem::path& folder, const VideoKeypoints& keypoints);

/// `subject` of a folder written before; empty where there is none.
std::string SubjectOfFolder(const std::filesystem::path& folder);

}  // namespace canonpose
