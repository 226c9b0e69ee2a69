#include "canonpose/video/video_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <mutex>
#include <string_view>
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

/// Of a count that is an estimate, so few frames, or so small a share, may be missing without any having been lost.
constexpr long kFewFrames = 3;
constexpr double kSmallShare = 0.02;

/// Whether the container has a table of its frames, or at least their number: MP4, MOV and AVI. Of others, such as
/// Matroska, WebM and MPEG transport streams, the library estimates it from duration and rate.
bool CountsFrames(const fs::path& path) {
  std::array<char, 12> bytes{};
  std::ifstream(path, std::ios::binary).read(bytes.data(), bytes.size());
  const std::string_view first(bytes.data(), bytes.size());
  const std::string_view kind = first.substr(4, 4);
  const bool is_mp4 = kind == "ftyp" || kind == "moov" || kind == "mdat" || kind == "wide" || kind == "free";
  return is_mp4 || first.substr(8) == "AVI ";
}

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
  /// Frames whose time stamp was not believed.
  [[nodiscard]] virtual long times_corrected() const { return 0; }
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
    rate_ = info.fps;
    counts_frames_ = CountsFrames(path);
    info.image_size = {static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH)),
                       static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT))};
    if (info.image_size[0] <= 0 || info.image_size[1] <= 0) ThrowNotAVideo(path);
  }

  bool Next(cv::Mat& image, double& time_seconds, long& skipped) override {
    if (!has_begun_) is_at_frame_ = Advance();
    has_begun_ = true;
    while (is_at_frame_) {
      const double stamp = stamp_;
      const bool is_read = Retrieve(image);
      const int failures = failures_;
      failures_ = is_read ? 0 : failures + 1;
      is_at_frame_ = Advance();
      if (!is_read) continue;
      // A frame's stamp is believed or not by the next one's.
      time_seconds = last_time_ = stamps_.Next(stamp, is_at_frame_ ? stamp_ : std::numeric_limits<double>::quiet_NaN());
      skipped += failures;
      read_ += 1 + failures;
      return true;
    }
    skipped += MissingAtTheEnd();
    announced_ = 0;
    return false;
  }

  [[nodiscard]] long times_corrected() const override { return stamps_.corrected(); }

 private:
  /// Goes to the next frame that can be decoded and takes its stamp; false at the end.
  bool Advance() {
    for (; failures_ <= kTriesAfterFailure; ++failures_) {
      try {
        if (!capture_.grab()) continue;
      } catch (const cv::Exception&) {
        continue;
      }
      stamp_ = capture_.get(cv::CAP_PROP_POS_MSEC) / 1000.0;
      return true;
    }
    return false;
  }

  bool Retrieve(cv::Mat& image) {
    try {
      return capture_.retrieve(image) && !image.empty();
    } catch (const cv::Exception&) {
      return false;
    }
  }

  /// Frames that the container states and that are not there.
  [[nodiscard]] long MissingAtTheEnd() const {
    if (announced_ <= read_) return 0;
    if (counts_frames_ || rate_ <= 0.0) return announced_ - read_;
    // The count is the duration times a rate, which says nothing of the frames up to the last one.
    const long until_last = std::lround(last_time_ * rate_) + 1;
    const long missing = announced_ - until_last;
    return missing > std::max(kFewFrames, std::lround(kSmallShare * static_cast<double>(announced_))) ? missing : 0;
  }

  cv::VideoCapture capture_;
  TimeStamps stamps_;
  double rate_ = 0.0;           ///< that the container states
  bool counts_frames_ = false;  ///< whether the container's count is one of frames
  long announced_ = 0;          ///< the container's count; 0 where unknown
  long read_ = 0;               ///< frames read or passed over
  double last_time_ = 0.0;      ///< of the last frame read
  bool has_begun_ = false;
  bool is_at_frame_ = false;  ///< whether a frame is decoded, but not yet given
  double stamp_ = 0.0;        ///< its stamp
  int failures_ = 0;          ///< in a row before it
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

long VideoReader::times_corrected() const { return frames_->times_corrected(); }

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
