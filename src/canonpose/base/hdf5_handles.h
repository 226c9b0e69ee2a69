// Owned identifiers of the HDF5 library, and what a Group holds.
//
// Only for hdf5.cc and hdf5_read.cc: it shows the library's own types.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/base/hdf5_questions.h"

namespace canonpose::h5 {

/// Owns one HDF5 identifier.
class Id {
 public:
  using Closer = herr_t (*)(hid_t);
  Id() = default;
  Id(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  ~Id() { Close(); }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Id& operator=(Id&& other) noexcept {
    Close();
    id_ = std::exchange(other.id_, -1);
    closer_ = other.closer_;
    return *this;
  }
  operator hid_t() const { return id_; }  // NOLINT: the library's functions take it everywhere
  [[nodiscard]] bool valid() const { return id_ >= 0; }
  /// Gives up the identifier; the caller must close it.
  [[nodiscard]] hid_t Release() { return std::exchange(id_, -1); }
  herr_t Close() {
    if (id_ < 0) return 0;
    return closer_(std::exchange(id_, -1));
  }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

struct Group::State {
  std::string file;
  std::filesystem::path final_path;
  std::shared_ptr<Id> file_id;
  Id id;
  /// Reads the file, if it is one that another process reads; the two above then have no value.
  std::shared_ptr<FileInChild> child = nullptr;
};

template <typename T>
hid_t MemoryType() {
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// The number of values of an array.
inline std::size_t CountOf(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  return count;
}

}  // namespace canonpose::h5
