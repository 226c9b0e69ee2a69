#include "canonpose/data/readers/detections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/data/readers/frame_numbers.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// Keeps differences from overflowing; time stamps in nanoseconds still fit.
constexpr std::int64_t kLargestFrameNumber = 2'000'000'000'000'000'000;
/// Between the frames of a counter there are at most this many steps where the most are adjacent.
constexpr std::int64_t kLargestCounterStep = 4;
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// Whole-body sets start with body and feet; the face and the hands that follow are left out.
struct WholeBodySet {
  std::size_t keypoint_count;
  std::size_t body_count;
};
constexpr std::array<WholeBodySet, 2> kWholeBodySets{{{136, 26}, {133, 23}}};
/// More joints than anybody marks on a body.
constexpr std::size_t kMostNamedJoints = 512;

std::size_t BodyCount(std::size_t keypoint_count) {
  for (const WholeBodySet& set : kWholeBodySets) {
    if (set.keypoint_count == keypoint_count) return set.body_count;
  }
  return keypoint_count;
}

/// A person of the first `count` keypoints.
std::optional<DetectedPerson> PersonOf(const std::vector<double>& triples, std::size_t count) {
  DetectedPerson person;
  person.keypoints.assign(2 * count, kMissing);
  person.confidence.assign(count, 0.0F);
  bool is_seen = false;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = triples[3 * k];
    const double y = triples[3 * k + 1];
    const double confidence = triples[3 * k + 2];
    if (!(confidence > 0.0) || std::isnan(x) || std::isnan(y) || (x == 0.0 && y == 0.0)) continue;
    person.keypoints[2 * k] = static_cast<float>(x);
    person.keypoints[2 * k + 1] = static_cast<float>(y);
    person.confidence[k] = static_cast<float>(confidence);
    is_seen = true;
  }
  if (!is_seen) return std::nullopt;
  return person;
}

bool IsHidden(const fs::path& path) { return path.filename().string().starts_with("."); }

std::string LowerExtension(const fs::path& path) { return LowerCase(path.extension().string()); }

/// What stands behind a camera's name in a file's name.
constexpr std::array<std::string_view, 5> kFileExtensions{".json", ".csv", ".h5", ".hdf5", ".npy"};

template <typename Keep>
std::vector<fs::path> ListFolder(const fs::path& folder, Keep&& keep, bool with_hidden = false) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) ThrowBadInput({folder.string(), "", "a folder that can be read", error.message(), "check the path"});
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : entries) {
    std::error_code ignored;
    if ((with_hidden || !IsHidden(entry.path())) && keep(entry, ignored)) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

std::optional<DetectedPerson> PersonFromTriples(const std::vector<double>& triples) {
  return PersonOf(triples, BodyCount(triples.size() / 3));
}

std::optional<DetectedPerson> PersonFromNamedTriples(const std::vector<double>& triples) {
  return PersonOf(triples, triples.size() / 3);
}

CameraBuilder::CameraBuilder(const CameraInput& input) {
  camera_.name = input.name;
  camera_.path = input.path.string();
}

DetectedFrame& CameraBuilder::Frame(std::int64_t number, const std::string& image, const std::string& file,
                                    const std::string& place) {
  if (number > kLargestFrameNumber || number < -kLargestFrameNumber) {
    ThrowBadInput({file, place, "a frame number", fmt::format("{}", number), "number the frames from 0"});
  }
  const auto [entry, is_new] = frames_.try_emplace(number);
  DetectedFrame& frame = entry->second;
  if (is_new) {
    frame.number = number;
    frame.image = image;
  } else if (frame.image != image) {
    ThrowBadInput({file, place, "one image per frame number",
                   fmt::format("{} and {}, both frame {}", frame.image, image, number),
                   "use one folder or file per camera; the frame number is the last number in the name"});
  }
  return frame;
}

DetectedFrame& CameraBuilder::Frame(const std::string& image, const std::string& file, const std::string& place) {
  const auto [entry, is_new] = named_frames_.try_emplace(image);
  if (is_new) {
    if (!LastNumber(image)) {
      ThrowBadInput({file, place, "a frame number in the name", "\"" + image + "\"", "name frames as in frame_0012"});
    }
    entry->second = {{0, image, {}}, file, place};
  }
  return entry->second.frame;
}

void CameraBuilder::Add(DetectedFrame& frame, DetectedPerson person, const std::string& file,
                        const std::string& place) {
  const int count = static_cast<int>(person.confidence.size());
  if (camera_.keypoint_count == 0) {
    camera_.keypoint_count = count;
    first_place_ = file == camera_.path ? place : file;
  }
  if (count != camera_.keypoint_count) {
    ThrowBadInput({file, place, fmt::format("{} keypoints as in {}", camera_.keypoint_count, first_place_),
                   fmt::format("{}", count), "all frames must come from one run of one detector"});
  }
  frame.people.push_back(std::move(person));
}

void CameraBuilder::NoteKeypointCount(std::size_t count) {
  for (const WholeBodySet& set : kWholeBodySets) {
    if (set.keypoint_count != count) continue;
    NoteUnusedPart("hands");
    NoteUnusedPart("face");
  }
}

void CameraBuilder::SetLayout(DetectedLayout layout, const std::string& file, const std::string& place) {
  if (layout.joints.size() > kMostNamedJoints) {
    ThrowBadInput({file, place, fmt::format("the names of at most {} joints", kMostNamedJoints),
                   fmt::format("{}", layout.joints.size()), "check the file's header"});
  }
  for (std::size_t j = 0; j < layout.joints.size(); ++j) {
    const std::string& name = layout.joints[j];
    const bool is_double = std::any_of(layout.joints.begin(), layout.joints.begin() + static_cast<std::ptrdiff_t>(j),
                                       [&](const std::string& other) { return SameName(name, other); });
    if (!name.empty() && !is_double) continue;
    ThrowBadInput({file, place, "a name of its own for each joint",
                   name.empty() ? fmt::format("none for joint {}", j) : fmt::format("\"{}\" twice", name),
                   "check the file's header"});
  }
  camera_.layout = std::move(layout);
}

void CameraBuilder::LeaveOut(const fs::path& file) { left_out_.push_back(file); }

void CameraBuilder::NumberNamedFrames() {
  std::vector<std::string> names;
  names.reserve(named_frames_.size());
  for (const auto& [name, named] : named_frames_) names.push_back(name);
  const FrameNumbers numbers = NumberFrames(names);
  if (!names.empty()) camera_.seconds_per_number = numbers.seconds_per_number;
  std::size_t i = 0;
  for (auto& [name, named] : named_frames_) {
    DetectedFrame& frame = Frame(numbers.numbers[i++], name, named.file, named.place);
    named.frame.number = frame.number;
    frame = std::move(named.frame);
  }
  named_frames_.clear();
}

void CameraBuilder::FillGaps() {
  if (frames_.size() < 2 || camera_.seconds_per_number > 0.0) return;
  std::int64_t step = 0;
  std::int64_t smallest = std::numeric_limits<std::int64_t>::max();
  std::optional<std::int64_t> previous;
  for (const auto& [number, frame] : frames_) {
    if (previous) step = std::gcd(step, number - *previous);
    if (previous) smallest = std::min(smallest, number - *previous);
    previous = number;
  }
  // Where numbers are names (COCO's image ids) or times rather than counters, gaps have no meaning.
  const std::int64_t last = frames_.rbegin()->first;
  if (smallest > kLargestCounterStep * step) return;
  if ((last - frames_.begin()->first) / step >= 20 * std::ssize(frames_) + 1000) return;
  for (std::int64_t number = frames_.begin()->first; number < last; number += step) {
    const auto [entry, is_new] = frames_.try_emplace(number);
    if (is_new) entry->second.number = number;
  }
}

void CameraBuilder::ReportLeftOut() const {
  if (left_out_.empty()) return;
  // Where a frame may be meant, the user should look.
  const bool is_suspicious = std::any_of(left_out_.begin(), left_out_.end(), [](const fs::path& file) {
    return LowerExtension(file) == ".json" && LastNumber(file.filename().string()).has_value();
  });
  const bool is_one = left_out_.size() == 1;
  const std::string text = fmt::format(
      "{}: {} in {} {} left out: {}", camera_.name, is_one ? "a file" : fmt::format("{} files", left_out_.size()),
      camera_.path, is_one ? "has no keypoints and is" : "have no keypoints and are", FirstAndCount(left_out_));
  if (is_suspicious) {
    LogWarning("{}", text);
  } else {
    LogInfo("{}", text);
  }
}

DetectedCamera CameraBuilder::Finish(bool fill_gaps) {
  NumberNamedFrames();
  if (camera_.keypoint_count == 0) {
    ThrowBadInput({camera_.path, "", "detections of a person",
                   frames_.empty() ? "no frames" : fmt::format("nobody in any of {} frames", frames_.size()),
                   fmt::format("leave out camera {}, or run the detector on it again", camera_.name)});
  }
  ReportLeftOut();
  if (fill_gaps) FillGaps();
  for (auto& [number, frame] : frames_) camera_.frames.push_back(std::move(frame));
  frames_.clear();
  return std::move(camera_);
}

std::vector<fs::path> FilesIn(const fs::path& folder, const std::vector<std::string_view>& extensions) {
  return ListFolder(folder, [&](const fs::directory_entry& entry, std::error_code& error) {
    const std::string extension = LowerExtension(entry.path());
    return entry.is_regular_file(error) &&
           std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
  });
}

std::vector<fs::path> JsonFilesIn(const fs::path& folder) { return FilesIn(folder, {".json"}); }

std::vector<fs::path> OtherFilesIn(const fs::path& folder) {
  return ListFolder(
      folder,
      [](const fs::directory_entry& entry, std::error_code& error) {
        return entry.is_regular_file(error) && (IsHidden(entry.path()) || LowerExtension(entry.path()) != ".json");
      },
      true);
}

std::vector<fs::path> FoldersIn(const fs::path& folder) {
  return ListFolder(folder,
                    [](const fs::directory_entry& entry, std::error_code& error) { return entry.is_directory(error); });
}

std::string FirstAndCount(const std::vector<fs::path>& paths) {
  if (paths.empty()) return "none";
  const std::string first = paths.front().filename().string();
  return paths.size() == 1 ? first : fmt::format("{} and {} more", first, paths.size() - 1);
}

std::string CameraNameOf(const fs::path& path) {
  fs::path plain = fs::absolute(path).lexically_normal();
  if (!plain.has_filename()) plain = plain.parent_path();
  const bool is_file =
      std::find(kFileExtensions.begin(), kFileExtensions.end(), LowerExtension(plain)) != kFileExtensions.end();
  std::string name = (is_file ? plain.stem() : plain.filename()).string();
  static constexpr std::array<std::string_view, 5> kSameForAll{"alphapose-results", "alphapose-results-forvis",
                                                               "sep-json", "results", "labels"};
  const bool is_same_for_all = std::find(kSameForAll.begin(), kSameForAll.end(), name) != kSameForAll.end();
  if (!is_same_for_all) return name;
  const std::string above = plain.parent_path().filename().string();
  return above.empty() ? name : above;
}

}  // namespace canonpose
