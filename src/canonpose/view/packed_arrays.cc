#include "canonpose/view/packed_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <zlib.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint16_t kMissing = 65535;
constexpr int kLargest = 65000;

/// Predicts a channel's next number from those before; missing ones are skipped.
class Predictor {
 public:
  explicit Predictor(int order) : order_(order) {}
  [[nodiscard]] int Next() const { return order_ == 2 ? 2 * last_ - before_ : last_; }
  void Saw(int number) {
    before_ = is_first_ ? number : last_;
    last_ = number;
    is_first_ = false;
  }

 private:
  int order_;
  int last_ = 0;
  int before_ = 0;
  bool is_first_ = true;
};

std::uint16_t ZigZag(int difference) {
  return static_cast<std::uint16_t>(difference >= 0 ? 2 * difference : -2 * difference - 1);
}

int FromZigZag(int coded) { return coded % 2 == 0 ? coded / 2 : -(coded + 1) / 2; }

/// Modulo 65536, between -32768 and 32767.
int Wrap(int number) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(number & 0xFFFF)); }

struct Channel {
  double offset = 0.0;
  double step = 1.0;
  std::vector<int> numbers;  ///< -1 where missing
};

Channel Quantise(std::span<const float> values, int channels, int channel, const Precision& precision) {
  Channel result;
  const std::size_t frames = values.size() / static_cast<std::size_t>(channels);
  std::vector<double> known(frames, std::numeric_limits<double>::quiet_NaN());
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (std::size_t t = 0; t < frames; ++t) {
    const double value = values[t * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel)];
    const double stored = precision.logarithmic ? std::log2(value) : value;
    if (!std::isfinite(stored)) continue;
    known[t] = stored;
    lowest = std::min(lowest, stored);
    highest = std::max(highest, stored);
  }
  result.numbers.assign(frames, -1);
  if (lowest > highest) return result;
  result.step = std::max(precision.step, (highest - lowest) / kLargest);
  result.offset = lowest;
  for (std::size_t t = 0; t < frames; ++t) {
    if (std::isfinite(known[t])) result.numbers[t] = static_cast<int>(std::lround((known[t] - lowest) / result.step));
  }
  return result;
}

std::vector<std::uint16_t> Differences(const std::vector<Channel>& channels, int order) {
  std::vector<std::uint16_t> differences;
  for (const Channel& channel : channels) {
    Predictor predictor(order);
    for (const int number : channel.numbers) {
      if (number < 0) {
        differences.push_back(kMissing);
        continue;
      }
      // The one difference whose code means "missing" is avoided by a step more.
      int difference = Wrap(number - predictor.Next());
      if (ZigZag(difference) == kMissing) ++difference;
      differences.push_back(ZigZag(difference));
      predictor.Saw((predictor.Next() + difference) & 0xFFFF);
    }
  }
  return differences;
}

/// About how many bits they will take.
double Cost(const std::vector<std::uint16_t>& differences) {
  double bits = 0.0;
  for (const std::uint16_t d : differences) bits += std::log2(1.0 + d);
  return bits;
}

}  // namespace

Json PackedArrays::Add(std::span<const float> values, int channels, const Precision& precision) {
  CANONPOSE_CHECK(channels > 0 && values.size() % static_cast<std::size_t>(channels) == 0 && precision.step > 0.0,
                  "{} values, {} channels, step {}", values.size(), channels, precision.step);
  std::vector<Channel> quantised;
  Json offsets = Json::array();
  Json steps = Json::array();
  for (int c = 0; c < channels; ++c) {
    quantised.push_back(Quantise(values, channels, c, precision));
    offsets.push_back(quantised.back().offset);
    steps.push_back(quantised.back().step);
  }
  int order = 1;
  std::vector<std::uint16_t> differences = Differences(quantised, 1);
  std::vector<std::uint16_t> second = Differences(quantised, 2);
  if (Cost(second) < Cost(differences)) {
    order = 2;
    differences = std::move(second);
  }
  Json array = {{"at", bytes_.size()},
                {"channels", channels},
                {"frames", values.size() / static_cast<std::size_t>(channels)},
                {"order", order},
                {"offset", offsets},
                {"step", steps},
                {"log", precision.logarithmic}};
  for (const std::uint16_t d : differences) bytes_.push_back(static_cast<char>(d & 0xFF));
  for (const std::uint16_t d : differences) bytes_.push_back(static_cast<char>(d >> 8));
  return array;
}

std::vector<float> Unpack(const std::string& bytes, const Json& array) {
  const auto first = array.at("at").get<std::size_t>();
  const auto channels = array.at("channels").get<std::size_t>();
  const auto frames = array.at("frames").get<std::size_t>();
  const std::size_t count = channels * frames;
  CANONPOSE_CHECK(first + 2 * count <= bytes.size(), "{} + 2 * {} > {}", first, count, bytes.size());
  std::vector<float> values(count, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t c = 0; c < channels; ++c) {
    Predictor predictor(array.at("order").get<int>());
    const auto offset = array.at("offset")[c].get<double>();
    const auto step = array.at("step")[c].get<double>();
    for (std::size_t t = 0; t < frames; ++t) {
      const std::size_t i = first + c * frames + t;
      const int coded = static_cast<unsigned char>(bytes[i]) | static_cast<unsigned char>(bytes[i + count]) << 8;
      if (coded == kMissing) continue;
      const int number = (predictor.Next() + FromZigZag(coded)) & 0xFFFF;
      predictor.Saw(number);
      const double stored = offset + step * number;
      values[t * channels + c] = static_cast<float>(array.at("log").get<bool>() ? std::exp2(stored) : stored);
    }
  }
  return values;
}

std::string Gzip(const std::string& bytes) {
  constexpr int kGzipWindow = 15 + 16;  // the largest window, with gzip's header instead of zlib's
  constexpr int kMemoryLevel = 9;
  z_stream stream{};
  CANONPOSE_CHECK(
      deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemoryLevel, Z_DEFAULT_STRATEGY) == Z_OK,
      "deflateInit2 failed");
  std::string compressed(deflateBound(&stream, bytes.size()), '\0');
  // zlib does not change its input, but says so only in new versions.
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  const int end = deflate(&stream, Z_FINISH);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  CANONPOSE_CHECK(end == Z_STREAM_END, "deflate ended with {}", end);
  return compressed;
}

std::string Base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr std::size_t kLine = 76 * 1024;
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + bytes.size() / kLine + 8);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < left ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= left ? kDigits[bits >> (18 - 6 * k) & 63] : '=');
    if ((i / 3 + 1) % (kLine / 4) == 0) text.push_back('\n');
  }
  return text;
}

}  // namespace canonpose
