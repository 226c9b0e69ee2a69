// Values as bytes, for another process of this program on this machine.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace canonpose {

class ByteWriter {
 public:
  template <typename T>
  void Number(T value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void Text(std::string_view text) {
    Number<std::uint64_t>(text.size());
    bytes_.append(text);
  }
  template <typename T>
  void Numbers(const std::vector<T>& values) {
    static_assert(std::is_arithmetic_v<T>);
    Number<std::uint64_t>(values.size());
    if (!values.empty()) bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void Texts(const std::vector<std::string>& texts) {
    Number<std::uint64_t>(texts.size());
    for (const std::string& text : texts) Text(text);
  }
  [[nodiscard]] std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what a ByteWriter wrote. Where the bytes end too early, ok() is false from then on and the values are empty.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  /// Whether all was there so far.
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

  template <typename T>
  T Number() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    const std::string_view bytes = Take(sizeof(T));
    if (ok_) std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::string Text() { return std::string(Take(Number<std::uint64_t>())); }
  template <typename T>
  std::vector<T> Numbers() {
    const auto count = Number<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) ok_ = false;
    if (!ok_) return {};
    std::vector<T> values(count);
    const std::string_view bytes = Take(count * sizeof(T));
    if (count > 0) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::vector<std::string> Texts() {
    const auto count = Number<std::uint64_t>();
    if (count > bytes_.size() / sizeof(std::uint64_t)) ok_ = false;
    std::vector<std::string> texts;
    for (std::uint64_t i = 0; ok_ && i < count; ++i) texts.push_back(Text());
    return texts;
  }

 private:
  std::string_view Take(std::uint64_t count) {
    if (!ok_ || count > bytes_.size()) {
      ok_ = false;
      return {};
    }
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace canonpose
