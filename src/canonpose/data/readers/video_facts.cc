#include "canonpose/data/readers/video_facts.h"

#include <system_error>

#include "canonpose/data/codecs/json.h"

namespace canonpose {
namespace {

constexpr const char* kDetectAgain = "run detect on the video again";
constexpr int kLargestSide = 1 << 20;

std::array<int, 2> ImageSizeFrom(const JsonValue& value) {
  const bool is_pair = value.ArraySize() == 2;
  std::array<int, 2> size{0, 0};
  for (std::size_t i = 0; is_pair && i < 2; ++i) {
    const std::int64_t side = value.At(i).Integer();
    if (side > 0 && side < kLargestSide) size[i] = static_cast<int>(side);
  }
  if (size[0] == 0 || size[1] == 0) value.Fail("width and height in pixels", kDetectAgain);
  return size;
}

std::vector<double> TimesFrom(const JsonValue& value) {
  std::vector<double> times = value.Numbers();
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] <= times[i - 1]) value.At(i).Fail("a later time than the frame's before", kDetectAgain);
  }
  return times;
}

}  // namespace

std::optional<VideoFacts> ReadVideoFacts(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kVideoFactsFile;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const JsonValue root = JsonValue::Load(file);
  // Another program's file of that name is none of ours.
  const std::optional<JsonValue> format = root.Find("format");
  if (!format || format->json() != kVideoFactsFormat) return std::nullopt;
  if (root["version"].Integer() != 1) root["version"].Fail("version 1", "use the program's version that wrote it");
  VideoFacts facts;
  facts.image_size = ImageSizeFrom(root["image_size"]);
  if (const auto fps = root.Find("fps")) facts.fps = fps->Number();
  if (facts.fps < 0.0) root["fps"].Fail("frames per second", kDetectAgain);
  if (const auto times = root.Find("time_stamps")) facts.times_seconds = TimesFrom(*times);
  if (const auto skipped = root.Find("frames_skipped")) facts.frames_skipped = static_cast<long>(skipped->Integer());
  return facts;
}

}  // namespace canonpose
