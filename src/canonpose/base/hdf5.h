// A small, safe interface to the HDF5 C library: groups, attributes, arrays, and files that appear whole or not at all.
//
// When something is missing, has the wrong type or shape, or cannot be read or written, every function throws an
// Error(kBadInput) that names the file and the place in it.
//
// The library crashes on some damaged files and runs for ever on others, so a file that was opened for reading is read
// in a child process (child_process.h), which ends with the last Group: then only the child is lost, and the file is
// said to be damaged. Values come from the child by a socket.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose::h5 {

/// An array as stored: row-major values, and the size of each dimension.
template <typename T>
struct Array {
  std::vector<T> values;
  std::vector<std::size_t> shape;
};

/// "(100, 17, 2)"
std::string FormatShape(const std::vector<std::size_t>& shape);

class File;

/// A group of an open file; the root is File::root(). Keeps the file open.
class Group {
 public:
  [[nodiscard]] bool Has(const std::string& name) const;
  [[nodiscard]] bool HasAttribute(const std::string& name) const;
  /// Names of the groups and arrays inside, in alphabetical order.
  [[nodiscard]] std::vector<std::string> Children() const;
  [[nodiscard]] Group Open(const std::string& name) const;
  /// "/sequences/S1"
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& file() const;

  /// Attributes. Integers and reals of any width convert; strings may be of fixed or variable length.
  [[nodiscard]] std::string GetString(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> GetStrings(const std::string& name) const;
  [[nodiscard]] std::int64_t GetInt(const std::string& name) const;
  [[nodiscard]] std::vector<std::int64_t> GetInts(const std::string& name) const;
  [[nodiscard]] double GetDouble(const std::string& name) const;

  /// Arrays; T is float, double or std::int64_t, converted from what is stored.
  template <typename T>
  [[nodiscard]] Array<T> Read(const std::string& name) const;
  /// An array of texts of fixed or variable length, row-major; its shape is Shape().
  [[nodiscard]] std::vector<std::string> ReadTexts(const std::string& name) const;
  /// One field of a table, an array whose elements are records: (rows), or (rows, ...) where the field is an array.
  [[nodiscard]] Array<double> ReadField(const std::string& name, const std::string& field) const;
  /// The shape alone, without reading. It is one that the file can hold: a damaged size is an error.
  [[nodiscard]] std::vector<std::size_t> Shape(const std::string& name) const;

  [[nodiscard]] Group Create(const std::string& name);
  void SetString(const std::string& name, const std::string& value);
  void SetStrings(const std::string& name, const std::vector<std::string>& values);
  void SetInt(const std::string& name, std::int64_t value);
  void SetInts(const std::string& name, const std::vector<std::int64_t>& values);
  void SetDouble(const std::string& name, double value);
  /// T is float, double, std::int64_t or std::uint8_t. Writes a new array with a checksum, so that a damaged file is
  /// noticed when it is read.
  template <typename T>
  void Write(const std::string& name, std::span<const T> values, const std::vector<std::size_t>& shape);

  /// Throws the Error(kBadInput) for something wrong at `name` in this group.
  [[noreturn]] void Fail(const std::string& name, const std::string& expected, const std::string& found,
                         const std::string& advice) const;

 private:
  friend class File;
  struct State;
  std::shared_ptr<State> state_;
  std::string path_;
};

class File {
 public:
  /// Whether the file at `path` starts with the signature of HDF5.
  static bool IsHdf5(const std::filesystem::path& path);
  static File OpenForReading(const std::filesystem::path& path);
  /// A whole file in memory, which is copied; errors refer to it as `name`.
  static File OpenImage(std::string_view image, const std::string& name);
  /// A new file that Commit() moves to `path`.
  static File CreateAt(const std::filesystem::path& path);
  ~File();
  File(File&&) noexcept;
  File& operator=(File&&) = delete;

  [[nodiscard]] Group& root() { return root_; }
  [[nodiscard]] const Group& root() const { return root_; }
  /// Finishes a file made by CreateAt(). No Group of it may be used afterwards.
  void Commit();

 private:
  File();
  /// Opens a file in this process.
  static File OpenHere(const std::filesystem::path& path);
  /// Takes ownership of an open file, given by HDF5's handle.
  static File OfHandle(std::int64_t handle, const std::string& name);
  Group root_;
  struct Pending;
  std::unique_ptr<Pending> pending_;
};

}  // namespace canonpose::h5
