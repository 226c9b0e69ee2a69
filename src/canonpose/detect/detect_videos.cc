#include "canonpose/detect/detect_videos.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <exception>
#include <fstream>
#include <mutex>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utility.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/folder_lock.h"
#include "canonpose/base/hash.h"
#include "canonpose/base/log.h"
#include "canonpose/base/parallel.h"
#include "canonpose/base/progress.h"
#include "canonpose/detect/journal.h"
#include "canonpose/detect/keypoint_folder.h"
#include "canonpose/detect/movenet.h"
#include "canonpose/model/runtime.h"
#include "canonpose/video/video_reader.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Changes whenever the same video, networks and options no longer give the same keypoints.
constexpr int kMethodVersion = 2;

/// Adds the size of a file and its beginning and end, which is enough to know it again.
void AddFile(const fs::path& path, Fingerprint& fingerprint) {
  constexpr std::streamoff kPart = 1 << 20;
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream ? static_cast<std::streamoff>(stream.tellg()) : 0;
  fingerprint.Add(fmt::format("{}", size));
  for (const std::streamoff begin : {std::streamoff{0}, std::max<std::streamoff>(0, size - kPart)}) {
    std::string part(static_cast<std::size_t>(std::min(kPart, size)), '\0');
    stream.seekg(begin);
    stream.read(part.data(), static_cast<std::streamsize>(part.size()));
    fingerprint.Add(part.data(), part.size());
  }
}

/// What the keypoints of a video follow from, in one line.
std::string SubjectOf(const VideoSource& source, const DetectOptions& options, const Detector& detector) {
  Fingerprint fingerprint;
  if (source.images.empty()) {
    AddFile(source.path, fingerprint);
  } else {
    for (const fs::path& image : source.images) {
      fingerprint.Add(image.filename().string());
      AddFile(image, fingerprint);
    }
    fingerprint.Add(fmt::format("{}", options.image_fps));
  }
  return fmt::format("canonpose detect {}: video {:016x}, network {:016x}, search every {}, {} people", kMethodVersion,
                     fingerprint.value(), detector.fingerprint, options.tracker.search_interval,
                     options.tracker.most_people);
}

/// During its lifetime, OpenCV uses that many threads.
class ImageThreadScope {
 public:
  explicit ImageThreadScope(int threads) : before_(cv::getNumThreads()) { cv::setNumThreads(threads); }
  ~ImageThreadScope() { cv::setNumThreads(before_); }
  ImageThreadScope(const ImageThreadScope&) = delete;
  ImageThreadScope& operator=(const ImageThreadScope&) = delete;

 private:
  int before_;
};

/// Progress over the frames of all videos, which threads report one by one.
class SharedProgress {
 public:
  explicit SharedProgress(long total) : progress_("frame", total) {}

  void Count(const std::string& name) {
    const std::scoped_lock lock(mutex_);
    progress_.Update(++done_, name);
  }

 private:
  std::mutex mutex_;
  Progress progress_;
  long done_ = 0;
};

/// Reads a video to its end; returns false where the caller asked to stop.
bool ReadPeople(VideoReader& reader, PersonTracker& tracker, RecordedNetwork& network, Journal& journal,
                SharedProgress& progress, VideoKeypoints& keypoints) {
  VideoFrame frame;
  while (reader.Read(frame)) {
    if (StopRequested()) return false;
    std::deque<FrameAnswers>& known = journal.known();
    const bool is_known = !known.empty();
    network.Begin(is_known ? std::move(known.front()) : FrameAnswers());
    if (is_known) known.pop_front();
    keypoints.frames.push_back(tracker.Next(frame.image));
    if (!is_known) journal.Append(network.answers());
    if (!std::isnan(frame.time_seconds)) keypoints.times_seconds.push_back(frame.time_seconds);
    progress.Count(reader.source().name);
  }
  return true;
}

int CountPeople(const VideoKeypoints& keypoints) {
  std::set<int> ids;
  for (const std::vector<TrackedPose>& frame : keypoints.frames) {
    for (const TrackedPose& person : frame) ids.insert(person.id);
  }
  return static_cast<int>(ids.size());
}

void ReportSkipped(const VideoReader& reader, long frames) {
  if (reader.skipped() == 0) return;
  LogWarning("{}: {} of {} frames are damaged or missing and were passed over", reader.source().path.string(),
             reader.skipped(), reader.skipped() + frames);
}

void ReportTimes(const VideoReader& reader, long frames) {
  if (reader.times_corrected() == 0) return;
  LogWarning("{}: the time stamps of {} of {} frames are missing or wrong, and were replaced by the usual interval",
             reader.source().path.string(), reader.times_corrected(), frames);
}

fs::path JournalOf(const DetectOptions& options, const std::string& name) {
  return options.output / ("." + name + ".journal");
}

/// One video at work.
struct VideoJob {
  VideoSource source;
  std::string subject;
  DetectedVideo result;
};

/// Returns false where the caller asked to stop.
bool DetectOne(VideoJob& job, const DetectOptions& options, const Detector& detector, SharedProgress& progress) {
  VideoReader reader(job.source, options.image_fps);
  Journal journal(JournalOf(options, job.source.name), job.subject);
  if (!journal.known().empty()) LogInfo("{}: goes on after frame {}", job.source.name, journal.known().size());
  const std::unique_ptr<PoseNetwork> network = detector.make_network();
  RecordedNetwork recorded(*network);
  PersonTracker tracker(recorded, reader.info().image_size[0], reader.info().image_size[1], options.tracker);

  VideoKeypoints keypoints;
  if (!ReadPeople(reader, tracker, recorded, journal, progress, keypoints)) return false;
  const long frames = std::ssize(keypoints.frames);
  if (frames == 0) {
    ThrowBadInput({job.source.path.string(), "", "a video with frames that can be read", "none",
                   "copy the file from the camera again"});
  }
  ReportSkipped(reader, frames);
  ReportTimes(reader, frames);
  keypoints.name = job.source.name;
  keypoints.video = job.source.path.filename().string();
  keypoints.image_size = reader.info().image_size;
  keypoints.rotation_degrees = reader.info().rotation_degrees;
  keypoints.fps = MeanRate(keypoints.times_seconds, reader.info().fps);
  keypoints.frames_skipped = reader.skipped();
  keypoints.model = detector.model;
  keypoints.subject = job.subject;
  FinishPeople(keypoints);
  WriteKeypointFolder(job.result.folder, keypoints);
  journal.Remove();  // only now that the folder is on disk

  DetectedVideo& result = job.result;
  result.image_size = keypoints.image_size;
  result.fps = keypoints.fps;
  result.frames = frames;
  result.people = CountPeople(keypoints);
  result.frames_skipped = reader.skipped();
  return true;
}

/// The same. Where it fails and others go on, says so at once: the error itself shows when all have ended, and only the
/// first video's.
bool DetectOrReport(VideoJob& job, bool has_others, const DetectOptions& options, const Detector& detector,
                    SharedProgress& progress) {
  try {
    return DetectOne(job, options, detector, progress);
  } catch (const std::exception& error) {
    if (has_others) LogWarning("{}: failed: {}", job.source.name, error.what());
    throw;
  }
}

/// Whether a video's folder is there already. Throws where it holds something else.
bool IsDone(const VideoJob& job) {
  std::error_code error;
  const fs::path& folder = job.result.folder;
  if (!fs::exists(folder, error) || fs::is_empty(folder, error)) return false;
  const std::string subject = SubjectOfFolder(folder);
  if (subject == job.subject) return true;
  ThrowBadInput({folder.string(), "", "no folder, or the keypoints of this very video from a run before",
                 subject.empty() ? "other files" : "those of another video, network or options",
                 "remove it, or choose another output folder"});
}

std::vector<VideoJob> PlanJobs(const DetectOptions& options, const Detector& detector) {
  std::vector<VideoJob> jobs;
  for (VideoSource& source : FindVideos(options.videos)) {
    VideoJob job;
    job.subject = SubjectOf(source, options, detector);
    job.result.name = source.name;
    job.result.folder = options.output / source.name;
    job.source = std::move(source);
    job.result.was_there = IsDone(job);
    jobs.push_back(std::move(job));
  }
  return jobs;
}

/// Opens the videos that are still to be read, so that one that cannot be, or another run's journal, shows before the
/// others' hours of work.
long FramesToRead(const std::vector<VideoJob>& jobs, const DetectOptions& options) {
  long frames = 0;
  for (const VideoJob& job : jobs) {
    if (job.result.was_there) continue;
    RequireJournalOf(JournalOf(options, job.source.name), job.subject);
    frames += VideoReader(job.source).info().frame_count;
  }
  return frames;
}

}  // namespace

void DetectOptions::Validate() const {
  if (videos.empty()) ThrowInvalidArgument("give at least one video");
  if (output.empty()) ThrowInvalidArgument("give the folder for the keypoints");
  if (!std::isfinite(image_fps) || image_fps < 0.0)
    ThrowInvalidArgument("`image_fps` must be 0 or more, not {}", image_fps);
  if (threads < 0) ThrowInvalidArgument("`threads` must be 0 or more, not {}", threads);
  tracker.Validate();
}

DetectReport DetectVideos(const DetectOptions& options) {
  options.Validate();
  const auto files = std::make_shared<const MoveNetFiles>(
      MoveNetFiles::Read(options.model.empty() ? DefaultModelFolder() : options.model));
  return DetectVideos(options, {[files] { return std::make_unique<MoveNet>(*files); },
                                "MoveNet thunder and multipose (Google, Apache-2.0)", files->fingerprint});
}

DetectReport DetectVideos(const DetectOptions& options, const Detector& detector) {
  options.Validate();
  std::vector<VideoJob> jobs = PlanJobs(options, detector);
  MakeDirectory(options.output);
  const FolderLock lock(options.output);
  const long frames = FramesToRead(jobs, options);
  // A video is one thread's work: more of them for a network wait for each other wherever a core is busy.
  const ThreadScope one_thread(1);
  const ImageThreadScope one_image_thread(1);
  std::vector<VideoJob*> open;
  for (VideoJob& job : jobs) {
    if (!job.result.was_there) open.push_back(&job);
  }
  std::atomic<bool> stopped = false;
  {
    SharedProgress progress(frames);
    InParallel(static_cast<int>(open.size()), ThreadsToUse(options.threads), [&](int i) {
      VideoJob& job = *open[static_cast<std::size_t>(i)];
      if (!stopped && !DetectOrReport(job, open.size() > 1, options, detector, progress)) stopped = true;
    });
  }
  DetectReport report;
  report.stopped = stopped;
  for (VideoJob& job : jobs) report.videos.push_back(std::move(job.result));
  return report;
}

}  // namespace canonpose
