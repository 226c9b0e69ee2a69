// The job of `detect`: from videos to folders of keypoints.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "canonpose/detect/pose_network.h"
#include "canonpose/detect/tracker.h"

namespace canonpose {

struct DetectOptions {
  std::vector<std::string> videos;  ///< videos, folders or patterns (FindVideos())
  std::filesystem::path output;     ///< a folder, which gets one per video
  std::filesystem::path model;      ///< the folder with the networks' files; empty: DefaultModelFolder()
  TrackerOptions tracker;
  double image_fps = 0.0;  ///< frames per second of folders of images; 0 where unknown
  int threads = 0;         ///< videos at a time, each on one thread; 0: as many as there are cores

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// What was found in one video.
struct DetectedVideo {
  std::string name;
  std::filesystem::path folder;
  std::array<int, 2> image_size{0, 0};
  double fps = 0.0;
  long frames = 0;
  int people = 0;
  long frames_skipped = 0;
  bool was_there = false;  ///< written by a run before; only `name` and `folder` are known
};

struct DetectReport {
  std::vector<DetectedVideo> videos;  ///< in the order of the options
  bool stopped = false;               ///< the caller asked to stop; the same call goes on where this one was
};

/// Finds people in videos and writes their keypoints, one folder per video (WriteKeypointFolder()). While a video is at
/// work, what the network said of its frames is in output/.NAME.journal, from which a run that was killed goes on; the
/// result is the same to the bit. Videos whose folder is there, from the same file, networks and options, are left
/// alone. Reports progress in frames of all videos. Throws Error(kBadInput) where a video or network cannot be read, a
/// folder holds something else, a journal is of another video, network or options (it is kept), or another process is
/// at work in `output`. Where one of several videos fails, a warning names it at once, and the others are still read.
DetectReport DetectVideos(const DetectOptions& options);

/// A detector to use instead of the networks on disk.
struct Detector {
  std::function<std::unique_ptr<PoseNetwork>()> make_network;  ///< called once per video, on its thread
  std::string model;                                           ///< what it is, for video.json
  std::uint64_t fingerprint = 0;
};
DetectReport DetectVideos(const DetectOptions& options, const Detector& detector);

}  // namespace canonpose
