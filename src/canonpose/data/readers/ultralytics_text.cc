// Ultralytics' text files: a file per frame, a line per person.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/readers/ultralytics.h"

namespace canonpose::ultralytics {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBoxEnd = 5;  ///< class, and the middle and the size of the box
constexpr int kCocoKeypoints = 17;
/// The person's confidence and the track's number.
constexpr std::size_t kMostExtras = 2;
constexpr double kLargestValue = 1e9;

/// One person as the file has it.
struct Line {
  std::string file;
  std::size_t number = 0;  ///< from 1
  std::vector<double> values;
  [[nodiscard]] std::string place() const { return fmt::format("line {}", number); }
};

std::vector<double> Numbers(std::string_view text, const Line& line) {
  std::vector<double> values;
  while (true) {
    const std::size_t begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return values;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r"));
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || (error != std::errc() && error != std::errc::result_out_of_range)) {
      ThrowBadInput({line.file, line.place(), "numbers separated by spaces",
                     "\"" + std::string(word.substr(0, 40)) + "\"",
                     "give the text files that Ultralytics' save_txt option writes"});
    }
    values.push_back(error == std::errc() && std::abs(value) <= kLargestValue ? value : NAN);
    text.remove_prefix(word.size());
  }
}

std::vector<Line> LinesOf(const fs::path& path) {
  const std::string text = ReadFile(path);
  std::vector<Line> lines;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    Line line{path.string(), ++number, {}};
    line.values = Numbers(std::string_view(text).substr(begin, end - begin), line);
    if (!line.values.empty()) lines.push_back(std::move(line));
    begin = end + 1;
  }
  return lines;
}

/// How the values of all lines are to be read.
struct Form {
  std::size_t width = 3;   ///< values of each keypoint
  std::size_t extras = 0;  ///< values after the keypoints
};

std::optional<Form> FormOf(std::size_t values, std::size_t keypoints) {
  for (const std::size_t width : {3U, 2U}) {
    const std::size_t needed = kBoxEnd + width * keypoints;
    if (values >= needed && values <= needed + kMostExtras) return Form{width, values - needed};
  }
  return std::nullopt;
}

/// Whether the one value after the keypoints is the track's number: a whole number in every line, and not 1, or 0, in
/// all.
bool IsTrack(const std::vector<Line>& lines) {
  bool is_above_one = false;
  for (const Line& line : lines) {
    if (line.values.back() != std::trunc(line.values.back())) return false;
    is_above_one = is_above_one || line.values.back() > 1.0;
  }
  return is_above_one;
}

/// The form of a camera's lines. Throws where they do not agree, or have another number of keypoints.
Form CommonForm(const std::vector<Line>& lines, std::size_t keypoints) {
  const Line& first = lines.front();
  const std::optional<Form> form = FormOf(first.values.size(), keypoints);
  if (!form) {
    ThrowBadInput({first.file, first.place(),
                   fmt::format("{} or {} values for {} keypoints, and at most two more", kBoxEnd + 3 * keypoints,
                               kBoxEnd + 2 * keypoints, keypoints),
                   fmt::format("{}", first.values.size()),
                   first.values.size() <= kBoxEnd + 1
                       ? "these are boxes without keypoints: run a pose model"
                       : "name the `layout` where the model has other keypoints than COCO's 17"});
  }
  for (const Line& line : lines) {
    if (line.values.size() == first.values.size()) continue;
    // A tracker that has lost somebody leaves the number out.
    const std::optional<Form> other = FormOf(line.values.size(), keypoints);
    if (other && other->width == form->width) continue;
    ThrowBadInput({line.file, line.place(), fmt::format("{} values as in {}", first.values.size(), first.file),
                   fmt::format("{}", line.values.size()), "all frames must come from one run of one model"});
  }
  return *form;
}

void AddPerson(const Line& line, std::size_t keypoints, std::size_t width, bool is_track, DetectedFrame& frame,
               CameraBuilder& builder) {
  std::vector<double> triples;
  for (std::size_t k = 0; k < keypoints; ++k) {
    const double* const point = &line.values[kBoxEnd + k * width];
    triples.insert(triples.end(), {point[0], point[1], width == 3 ? point[2] : 1.0});
  }
  std::optional<DetectedPerson> person = PersonFromTriples(triples);
  if (!person) return;
  const std::size_t end = kBoxEnd + width * keypoints;
  const std::size_t extras = line.values.size() - end;
  if (extras == kMostExtras || (extras == 1 && !is_track)) person->score = line.values[end];
  const double id = line.values.back();
  if ((extras == kMostExtras || (extras == 1 && is_track)) && id >= 0.0 && id < 1e15 && id == std::trunc(id))
    person->track_id = static_cast<std::int64_t>(id);
  builder.Add(frame, std::move(*person), line.file, line.place());
}

}  // namespace

void ReadText(const std::vector<fs::path>& files, int keypoint_count, CameraBuilder& builder, OtherClasses& others) {
  const auto keypoints = static_cast<std::size_t>(keypoint_count > 0 ? keypoint_count : kCocoKeypoints);
  Progress progress("reading " + builder.camera_name(), std::ssize(files));
  std::vector<Line> people;
  long done = 0;
  for (const fs::path& file : files) {
    builder.Frame(file.filename().string(), file.string(), "");
    for (Line& line : LinesOf(file)) {
      const double number = line.values.front();
      if (number == 0.0) {
        people.push_back(std::move(line));
      } else if (number > 0.0 && number < 1e6 && number == std::trunc(number)) {
        ++others[static_cast<std::int64_t>(number)];
      } else {
        ThrowBadInput({line.file, line.place(), "the number of a class", fmt::format("{}", number),
                       "give the text files that Ultralytics' save_txt option writes"});
      }
    }
    progress.Update(++done, "");
  }
  if (people.empty()) return;
  const Form form = CommonForm(people, keypoints);
  std::vector<Line> with_one;
  for (const Line& line : people) {
    if (line.values.size() == kBoxEnd + form.width * keypoints + 1) with_one.push_back(line);
  }
  const bool is_track = !with_one.empty() && IsTrack(with_one);
  for (const Line& line : people) {
    DetectedFrame& frame = builder.Frame(fs::path(line.file).filename().string(), line.file, line.place());
    AddPerson(line, keypoints, form.width, is_track, frame, builder);
  }
}

}  // namespace canonpose::ultralytics
