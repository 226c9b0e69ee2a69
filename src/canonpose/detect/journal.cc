#include "canonpose/detect/journal.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// JSON with float numbers, whose shortest text reads back as the same bits.
using AnswerJson = nlohmann::basic_json<std::map, std::vector, std::string, bool, std::int64_t, std::uint64_t, float>;

constexpr std::size_t kNumbersOfPose = 3 * kPoseJoints + 1;
constexpr std::size_t kNumbersOfAppearance = std::tuple_size_v<Appearance>;

void AppendNumbers(const DetectedPose& pose, std::vector<float>& numbers) {
  for (const PosePoint& point : pose.joints) {
    numbers.insert(numbers.end(), {point.position.x(), point.position.y(), point.score});
  }
  numbers.push_back(pose.score);
}

DetectedPose PoseFrom(const float* numbers) {
  DetectedPose pose;
  for (PosePoint& point : pose.joints) {
    point.position = {numbers[0], numbers[1]};
    point.score = numbers[2];
    numbers += 3;
  }
  pose.score = *numbers;
  return pose;
}

/// Whether an answer has as many numbers as its kind needs.
bool IsWhole(const NetworkAnswer& answer) {
  switch (answer.kind) {
    case NetworkAnswer::Kind::kPeople:
      return answer.numbers.size() % kNumbersOfPose == 0;
    case NetworkAnswer::Kind::kPose:
      return answer.numbers.size() == kNumbersOfPose;
    case NetworkAnswer::Kind::kAppearance:
      return answer.numbers.size() == kNumbersOfAppearance;
  }
  return false;
}

std::string ToLine(const FrameAnswers& answers) {
  AnswerJson line = AnswerJson::array();
  for (const NetworkAnswer& answer : answers) {
    AnswerJson numbers = AnswerJson::array();
    for (const float number : answer.numbers) {
      numbers.push_back(std::isnan(number) ? AnswerJson(nullptr) : AnswerJson(number));
    }
    line.push_back({static_cast<std::int64_t>(answer.kind), std::move(numbers)});
  }
  return line.dump();
}

/// Nothing where the line is not whole.
std::optional<FrameAnswers> FromLine(std::string_view text) {
  const AnswerJson line = AnswerJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!line.is_array()) return std::nullopt;
  FrameAnswers answers;
  for (const AnswerJson& entry : line) {
    if (!entry.is_array() || entry.size() != 2 || !entry[0].is_number_integer() || !entry[1].is_array())
      return std::nullopt;
    const auto kind = entry[0].get<std::int64_t>();
    if (kind < 0 || kind > static_cast<std::int64_t>(NetworkAnswer::Kind::kAppearance)) return std::nullopt;
    NetworkAnswer answer{static_cast<NetworkAnswer::Kind>(kind), {}};
    for (const AnswerJson& number : entry[1]) {
      if (!number.is_number() && !number.is_null()) return std::nullopt;
      answer.numbers.push_back(number.is_null() ? std::numeric_limits<float>::quiet_NaN() : number.get<float>());
    }
    if (!IsWhole(answer)) return std::nullopt;
    answers.push_back(std::move(answer));
  }
  return answers;
}

}  // namespace

void RequireJournalOf(const fs::path& path, const std::string& subject) {
  std::ifstream stream(path, std::ios::binary);
  std::string first;
  if (!std::getline(stream, first) || first == subject || stream.peek() == std::ifstream::traits_type::eof()) return;
  ThrowBadInput(
      {path.string(), "line 1", subject, first,
       fmt::format("run with the options, video and networks of the run before, which then goes on; or remove "
                   "{}, and its frames are read again",
                   path.string())});
}

Journal::Journal(fs::path path, const std::string& subject) : path_(std::move(path)) {
  RequireJournalOf(path_, subject);
  std::error_code error;
  std::size_t whole = 0;  // bytes of whole lines
  if (fs::exists(path_, error)) {
    const std::string text = ReadFile(path_);
    const std::string first = subject + '\n';
    if (text.starts_with(first)) {
      whole = first.size();
      for (std::size_t end = 0; (end = text.find('\n', whole)) != std::string::npos; whole = end + 1) {
        std::optional<FrameAnswers> answers = FromLine(std::string_view(text).substr(whole, end - whole));
        if (!answers) break;
        known_.push_back(std::move(*answers));
      }
    }
    fs::resize_file(path_, whole, error);
    if (error) ThrowCannotWrite(path_, error.value());
  }
  stream_.open(path_, std::ios::binary | std::ios::app);
  if (whole == 0) stream_ << subject << '\n' << std::flush;
  if (!stream_) ThrowCannotWrite(path_, errno);
}

void Journal::Append(const FrameAnswers& answers) {
  stream_ << ToLine(answers) << '\n' << std::flush;
  if (!stream_) ThrowCannotWrite(path_, errno);
}

void Journal::Remove() {
  stream_.close();
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void RecordedNetwork::Begin(FrameAnswers known) {
  known_ = std::move(known);
  answers_.clear();
}

const NetworkAnswer* RecordedNetwork::Known(NetworkAnswer::Kind kind) {
  const std::size_t next = answers_.size();
  if (next >= known_.size()) return nullptr;
  if (known_[next].kind == kind) return &known_[next];
  known_.clear();  // of another program's version: from here on the network is asked
  return nullptr;
}

std::vector<DetectedPose> RecordedNetwork::FindPeople(const cv::Mat& image) {
  std::vector<DetectedPose> people;
  if (const NetworkAnswer* known = Known(NetworkAnswer::Kind::kPeople)) {
    for (std::size_t i = 0; i < known->numbers.size(); i += kNumbersOfPose)
      people.push_back(PoseFrom(&known->numbers[i]));
  } else {
    people = network_.FindPeople(image);
  }
  NetworkAnswer answer{NetworkAnswer::Kind::kPeople, {}};
  for (const DetectedPose& person : people) AppendNumbers(person, answer.numbers);
  answers_.push_back(std::move(answer));
  return people;
}

DetectedPose RecordedNetwork::PoseInCrop(const cv::Mat& image, const Crop& crop) {
  const NetworkAnswer* known = Known(NetworkAnswer::Kind::kPose);
  const DetectedPose pose = known != nullptr ? PoseFrom(known->numbers.data()) : network_.PoseInCrop(image, crop);
  NetworkAnswer answer{NetworkAnswer::Kind::kPose, {}};
  AppendNumbers(pose, answer.numbers);
  answers_.push_back(std::move(answer));
  return pose;
}

Appearance RecordedNetwork::AppearanceOf(const cv::Mat& image, const DetectedPose& pose) {
  Appearance appearance{};
  if (const NetworkAnswer* known = Known(NetworkAnswer::Kind::kAppearance)) {
    std::ranges::copy(known->numbers, appearance.begin());
  } else {
    appearance = network_.AppearanceOf(image, pose);
  }
  answers_.push_back({NetworkAnswer::Kind::kAppearance, {appearance.begin(), appearance.end()}});
  return appearance;
}

}  // namespace canonpose
