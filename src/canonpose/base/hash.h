// A fingerprint of data, to see whether two runs had the same input; not for security.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace canonpose {

/// FNV-1a, 64 bits (Fowler, Noll, Vo).
class Fingerprint {
 public:
  void Add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ bytes[i]) * 0x100000001B3ULL;
  }
  void Add(const std::string& text) {
    Add(text.data(), text.size());
    Add("\0", 1);
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325ULL;
};

}  // namespace canonpose
