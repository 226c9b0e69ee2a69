// Numbers over time in few bytes, for a page that carries its data within itself.
//
// Every channel (a coordinate of a joint, an angle) is rounded to multiples of a step, predicted from the frames before
// and stored as the difference to the prediction. The differences of smooth motion are small numbers, which
// compression then makes smaller still. viewer/data.js reads them back.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace canonpose {

/// How the values of an array are stored.
struct Precision {
  double step =
      0.0;  ///< values are rounded to multiples of it; a channel that spans more than 65,000 steps gets larger ones
  bool logarithmic = false;  ///< of base-2 logarithms instead of the values, which are then positive
};

class PackedArrays {
 public:
  /// Adds values (T, channels), row-major; NaN where one is missing. Returns what the page needs to read them: an
  /// object with `at` (first byte), `channels`, `frames`, `order` (1: each value is predicted to equal the one before;
  /// 2: to continue the line through the two before), `offset` and `step` (channels each), and `log`.
  nlohmann::ordered_json Add(std::span<const float> values, int channels, const Precision& precision);

  /// All arrays. An array is two planes of bytes, first the low and then the high bytes of 16-bit differences, channel
  /// by channel. A difference d is written as 2 d for d >= 0 and as -2 d - 1 otherwise; 65535 says that the value is
  /// missing, and the next one is predicted as if it were not there.
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The values (T, channels) of an array that Add() described, as viewer/data.js reads them.
std::vector<float> Unpack(const std::string& bytes, const nlohmann::ordered_json& array);

/// A gzip file that holds `bytes`. Throws std::logic_error where zlib fails.
std::string Gzip(const std::string& bytes);

/// RFC 4648, in lines of 76 KiB, so that editors open the page.
std::string Base64(const std::string& bytes);

}  // namespace canonpose
