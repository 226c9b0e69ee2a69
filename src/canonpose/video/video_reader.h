// Frames of a video, or of a folder of images, with their time stamps; two frames in memory at a time.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace canonpose {

/// Where the frames of one camera are.
struct VideoSource {
  std::string name;                           ///< of the camera
  std::filesystem::path path;                 ///< the video; for images, their folder
  std::vector<std::filesystem::path> images;  ///< in order; empty for a video
};

/// The sources that paths stand for. A path is a video, a folder of images (one source), a folder of videos (one source
/// each), or a pattern with '*' or '?' in its last part: of videos (one source each) or images (one). Images are
/// ordered by the numbers in their names. A source is named after its video or folder, and also after the folder above
/// where names would be the same. Throws Error(kBadInput) where there is no such path, nothing that could be a video,
/// or names are the same all the same.
std::vector<VideoSource> FindVideos(const std::vector<std::string>& paths);

/// Whether a folder holds files with the extension of a video; not those of its sub-folders.
bool HoldsVideos(const std::filesystem::path& folder);

struct VideoInfo {
  std::array<int, 2> image_size{0, 0};  ///< width, height of the frames as they come, so after rotation
  double fps = 0.0;                     ///< as the container states; 0 where unknown
  long frame_count = 0;                 ///< as the container states, which may be wrong; 0 where unknown
  int rotation_degrees = 0;             ///< by which frames are turned because the container says so, clockwise
};

struct VideoFrame {
  long index = -1;            ///< counts the frames that were read, from 0
  double time_seconds = 0.0;  ///< from the first frame's on; always grows; NaN for images without a rate
  cv::Mat image;              ///< 8 bits, blue, green, red
};

class VideoReader {
 public:
  /// `image_fps` is the rate of images; 0 where unknown, and of no meaning for videos. Throws Error(kBadInput) for a
  /// file that is no video, or that no codec of this machine reads.
  explicit VideoReader(VideoSource source, double image_fps = 0.0);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  [[nodiscard]] const VideoSource& source() const { return source_; }
  [[nodiscard]] const VideoInfo& info() const { return info_; }

  /// Reads the next frame; false at the end. Frames that cannot be decoded are passed over. `frame.image` is reused.
  /// Throws Error(kBadInput) where the image has another size than the first.
  bool Read(VideoFrame& frame);

  /// Frames passed over so far because they were damaged. At the end, also those that the container states and that
  /// are not there, as in a file that was cut off. Where the container has only a duration, those are an estimate of
  /// what its end lacks.
  [[nodiscard]] long skipped() const { return skipped_; }
  /// Frames so far whose time stamp was not believed (TimeStamps::corrected()).
  [[nodiscard]] long times_corrected() const;

 private:
  class Frames;
  class VideoFrames;
  class ImageFrames;

  VideoSource source_;
  VideoInfo info_;
  std::unique_ptr<Frames> frames_;
  long next_index_ = 0;
  long skipped_ = 0;
};

}  // namespace canonpose
