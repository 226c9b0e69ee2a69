#include "canonpose/video/video_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/video/time_stamps.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// After a frame that cannot be decoded, so many more are tried before the video is taken to have ended.
constexpr int kTriesAfterFailure = 16;

/// The libraries print what they find wrong; what matters of that is in our own messages.
void SilenceLibraries() {
  static std::once_flag once;
  std::call_once(once, [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    constexpr int kKeepTheUsers = 0;
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", kKeepTheUsers);
  });
}

[[noreturn]] void ThrowNotAVideo(const fs::path& path) {
  std::error_code error;
  const std::string kind = KindOfFile(path);
  std::string found = kind.empty() ? "something else, or a video that was cut off before its end" : kind;
  if (fs::file_size(path, error) == 0 && !error) found = "an empty file";
  if (kind == "a video")
    found = "one that cannot be opened: it was cut off before its end, or there is no codec for it";
  ThrowBadInput({path.string(), "", "a video that can be read", found,
                 "copy the file from the camera again, or convert it to H.264 in MP4"});
}

}  // namespace

/// Where frames come from.
class VideoReader::Frames {
 public:
  Frames() = default;
  virtual ~Frames() = default;
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;
  /// Reads the next frame's image and time; false at the end. Adds to `skipped` what is passed over.
  virtual bool Next(cv::Mat& image, double& time_seconds, long& skipped) = 0;
};

class VideoReader::VideoFrames final : public Frames {
 public:
  VideoFrames(const fs::path& path, VideoInfo& info) : stamps_(0.0) {
    SilenceLibraries();
    try {
      // Of OpenCV's ways to read a video, the one whose time stamps and rotation this class knows about.
      capture_.open(path.string(), cv::CAP_FFMPEG);
    } catch (const cv::Exception&) {
      ThrowNotAVideo(path);
    }
    if (!capture_.isOpened()) ThrowNotAVideo(path);
    capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 1);
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    if (std::isfinite(fps) && fps > 0.0) info.fps = fps;
    stamps_ = TimeStamps(info.fps);
    const double count = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    constexpr double kLargestCount = 1e9;  // a container without a count states a negative one, or nonsense
    if (count > 0.0 && count < kLargestCount) info.frame_count = std::lround(count);
    const double rotation = capture_.get(cv::CAP_PROP_ORIENTATION_META);
    if (std::isfinite(rotation)) info.rotation_degrees = (static_cast<int>(std::lround(rotation)) % 360 + 360) % 360;
    announced_ = info.frame_count;
    info.image_size = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                       static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
    if (info.image_size[0] <= 0 || info.image_size[1] <= 0) ThrowNotAVideo(path);
  }

  bool Next(cv::Mat& image, double& time_seconds, long& skipped) override {
    for (int failures = 0; failures <= kTriesAfterFailure; ++failures) {
      if (!Grab(image)) continue;
      time_seconds = stamps_.Next(capture_.get(cv::CAP_PROP_POS_MSEC) / 1000.0);
      skipped += failures;
      read_ += 1 + failures;
      return true;
    }
    if (announced_ > read_) skipped += announced_ - read_;
    announced_ = 0;
    return false;
  }

 private:
  bool Grab(cv::Mat& image) {
    try {
      return capture_.read(image) && !image.empty();
    } catch (const cv::Exception&) {
      return false;
    }
  }

  cv::VideoCapture capture_;
  TimeStamps stamps_;
  long announced_ = 0;
  long read_ = 0;
};

class VideoReader::ImageFrames final : public Frames {
 public:
  ImageFrames(const VideoSource& source, double fps, VideoInfo& info) : source_(source), fps_(fps) {
    SilenceLibraries();
    info.fps = fps;
    info.frame_count = static_cast<long>(source.images.size());
    // The first image that can be read says how large they are.
    for (const fs::path& path : source.images) {
      const cv::Mat image = Load(path);
      if (image.empty()) continue;
      info.image_size = {image.cols, image.rows};
      return;
    }
    ThrowBadInput({source.images.front().string(), "", "an image",
                   "something else, or a damaged one, as all images beside it", "export the images again"});
  }

  bool Next(cv::Mat& image, double& time_seconds, long& skipped) override {
    while (next_ < source_.images.size()) {
      const std::size_t number = next_++;
      image = Load(source_.images[number]);
      if (image.empty()) {
        ++skipped;
        continue;
      }
      time_seconds = fps_ > 0.0 ? static_cast<double>(number) / fps_ : std::numeric_limits<double>::quiet_NaN();
      return true;
    }
    return false;
  }

 private:
  static cv::Mat Load(const fs::path& path) {
    try {
      return cv::imread(path.string(), cv::IMREAD_COLOR);
    } catch (const cv::Exception&) {
      return {};
    }
  }

  const VideoSource& source_;
  double fps_;
  std::size_t next_ = 0;
};

VideoReader::VideoReader(VideoSource source, double image_fps) : source_(std::move(source)) {
  if (source_.images.empty()) {
    frames_ = std::make_unique<VideoFrames>(source_.path, info_);
  } else {
    frames_ = std::make_unique<ImageFrames>(source_, image_fps, info_);
  }
}

VideoReader::~VideoReader() = default;

bool VideoReader::Read(VideoFrame& frame) {
  if (!frames_->Next(frame.image, frame.time_seconds, skipped_)) return false;
  frame.index = next_index_++;
  if (frame.image.cols != info_.image_size[0] || frame.image.rows != info_.image_size[1]) {
    ThrowBadInput({source_.path.string(), fmt::format("frame {}", frame.index),
                   fmt::format("an image of {}x{} pixels as before", info_.image_size[0], info_.image_size[1]),
                   fmt::format("{}x{}", frame.image.cols, frame.image.rows),
                   "give images of one camera, all of one size"});
  }
  return true;
}

}  // namespace canonpose
