#include "canonpose/detect/keypoint_folder.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/video_facts.h"
#include "canonpose/detect/covered_joints.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Somebody who is seen in fewer frames is nobody, unless the video has hardly more.
constexpr int kFewestFrames = 5;
constexpr double kSmallestShareOfFrames = 0.5;
/// Real people's poses have a mean score above this.
constexpr double kLeastMeanScore = 0.25;

/// How much is seen of somebody.
struct Presence {
  int frames = 0;
  double score = 0.0;       ///< sum over frames
  double prominence = 0.0;  ///< sum over frames of size times score
};

std::map<int, Presence> PresenceOf(const VideoKeypoints& keypoints) {
  std::map<int, Presence> people;
  for (const std::vector<TrackedPose>& frame : keypoints.frames) {
    for (const TrackedPose& person : frame) {
      Presence& presence = people[person.id];
      ++presence.frames;
      presence.score += person.pose.score;
      presence.prominence += static_cast<double>(SizeOf(person.pose)) * person.pose.score;
    }
  }
  return people;
}

/// New numbers of the people who stay.
std::map<int, int> NumberPeople(const VideoKeypoints& keypoints) {
  const double frames = static_cast<double>(keypoints.frames.size());
  const double fewest = std::min<double>(kFewestFrames, kSmallestShareOfFrames * frames);
  std::vector<std::pair<double, int>> by_prominence;
  for (const auto& [id, presence] : PresenceOf(keypoints)) {
    if (presence.frames < fewest || presence.score < kLeastMeanScore * presence.frames) continue;
    by_prominence.emplace_back(-presence.prominence, id);
  }
  std::ranges::sort(by_prominence);
  std::map<int, int> numbers;
  for (const auto& [prominence, id] : by_prominence) numbers.emplace(id, static_cast<int>(numbers.size()));
  return numbers;
}

void LeaveOutJointsOutside(DetectedPose& pose, const std::array<int, 2>& image_size) {
  for (PosePoint& point : pose.joints) {
    const bool is_inside = point.position.x() >= 0.0F && point.position.y() >= 0.0F &&
                           point.position.x() < static_cast<float>(image_size[0]) &&
                           point.position.y() < static_cast<float>(image_size[1]);
    if (!is_inside) point.score = 0.0F;
  }
}

std::string FrameText(const std::vector<TrackedPose>& people) {
  std::string text = R"({"version":1.3,"people":[)";
  for (const TrackedPose& person : people) {
    text +=
        fmt::format(R"({}{{"person_id":[{}],"pose_keypoints_2d":[)", &person == people.data() ? "" : ",", person.id);
    for (const PosePoint& point : person.pose.joints) {
      const char* const comma = &point == person.pose.joints.data() ? "" : ",";
      // Detectors write joints that they do not find as zeros.
      if (point.score < 5e-4F) {
        text += fmt::format("{}0,0,0", comma);
      } else {
        text += fmt::format("{}{:.2f},{:.2f},{:.3f}", comma, point.position.x(), point.position.y(), point.score);
      }
    }
    text += "]}";
  }
  return text + "]}\n";
}

std::string VideoText(const VideoKeypoints& keypoints) {
  nlohmann::ordered_json video;
  video["format"] = kVideoFactsFormat;
  video["version"] = 1;
  video["video"] = keypoints.video;
  video["image_size"] = keypoints.image_size;
  if (keypoints.fps > 0.0) video["fps"] = keypoints.fps;
  video["frames"] = keypoints.frames.size();
  video["frames_skipped"] = keypoints.frames_skipped;
  video["rotation_degrees"] = keypoints.rotation_degrees;
  video["layout"] = "coco-17";
  video["model"] = keypoints.model;
  video["subject"] = keypoints.subject;
  if (!keypoints.times_seconds.empty()) {
    nlohmann::ordered_json times = nlohmann::ordered_json::array();
    for (const double time : keypoints.times_seconds) times.push_back(std::round(time * 1e6) / 1e6);
    video["time_stamps"] = std::move(times);
  }
  // Names of files may be any bytes; what is not UTF-8 in them is replaced.
  return video.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// Writes one of many files of a folder, which are synced to disk together when it is finished.
void WriteFile(const fs::path& path, const std::string& text) {
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) ThrowCannotWrite(path, errno);
}

}  // namespace

double MeanRate(const std::vector<double>& times_seconds, double stated) {
  if (times_seconds.size() < 2) return stated;
  const double mean = static_cast<double>(times_seconds.size() - 1) / (times_seconds.back() - times_seconds.front());
  constexpr double kSame = 1e-3;
  return std::abs(mean - stated) <= kSame * stated ? stated : mean;
}

void FinishPeople(VideoKeypoints& keypoints) {
  const std::map<int, int> numbers = NumberPeople(keypoints);
  for (std::vector<TrackedPose>& frame : keypoints.frames) {
    std::erase_if(frame, [&](const TrackedPose& person) { return !numbers.contains(person.id); });
    for (TrackedPose& person : frame) person.id = numbers.at(person.id);
    std::ranges::sort(frame, {}, &TrackedPose::id);
    MarkCoveredJoints(frame);
    for (TrackedPose& person : frame) LeaveOutJointsOutside(person.pose, keypoints.image_size);
  }
}

void WriteKeypointFolder(const fs::path& folder, const VideoKeypoints& keypoints) {
  AtomicFolder files(folder);
  for (std::size_t t = 0; t < keypoints.frames.size(); ++t) {
    WriteFile(files.temporary_path() / fmt::format("{}_{:012}_keypoints.json", keypoints.name, t),
              FrameText(keypoints.frames[t]));
  }
  WriteFile(files.temporary_path() / kVideoFactsFile, VideoText(keypoints));
  files.Commit();
}

std::string SubjectOfFolder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / kVideoFactsFile, error)) return "";
  const std::optional<JsonValue> subject = JsonValue::Load(folder / kVideoFactsFile).Find("subject");
  return subject ? subject->String() : "";
}

}  // namespace canonpose
