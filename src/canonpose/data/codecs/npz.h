// Reads and writes NumPy's .npz archives without Python.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace canonpose {

/// One array of an archive: row-major values and the size of each dimension (none for a scalar).
struct NpyArray {
  std::vector<std::size_t> shape;
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::int64_t>,
               std::vector<std::string>>
      values;

  [[nodiscard]] bool is_text() const { return std::holds_alternative<std::vector<std::string>>(values); }
};

/// Reads arrays one by one; other arrays in the file may be of any type. Every function throws Error(kBadInput) that
/// names the file and the array. Loading a pickled array in Python can execute code; here it cannot.
class NpzReader {
 public:
  explicit NpzReader(const std::filesystem::path& path);
  ~NpzReader();
  NpzReader(const NpzReader&) = delete;
  NpzReader& operator=(const NpzReader&) = delete;

  /// Names of the arrays, without ".npy", in the order of the file.
  [[nodiscard]] const std::vector<std::string>& names() const;
  [[nodiscard]] bool Has(const std::string& name) const;
  /// An array of float32, float64, int32, int64, '<U' or '|S' text, all little-endian. Fortran order is converted to C
  /// order.
  [[nodiscard]] NpyArray Read(const std::string& name) const;
  /// An array of any of these numbers, as float, and its shape.
  [[nodiscard]] std::vector<float> ReadFloats(const std::string& name, std::vector<std::size_t>* shape) const;
  /// The pickle of an array of Python objects, for pickle::Decode(). Read() refuses such arrays.
  [[nodiscard]] std::string ReadPickle(const std::string& name) const;
  /// An array of text of any shape, as one list.
  [[nodiscard]] std::vector<std::string> ReadStrings(const std::string& name) const;

 private:
  [[nodiscard]] std::string ReadBytes(const std::string& name) const;

  struct State;
  std::unique_ptr<State> state_;
};

/// Writes an archive for numpy.load(). The same arrays give the same bits. The file appears with Commit().
class NpzWriter {
 public:
  /// Throws Error(kBadInput) where `path` cannot be written.
  explicit NpzWriter(const std::filesystem::path& path, bool compress = true);
  ~NpzWriter();
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  /// T is float, double, std::int32_t or std::int64_t.
  template <typename T>
  void Add(const std::string& name, std::span<const T> values, const std::vector<std::size_t>& shape);
  template <typename T>
  void Add(const std::string& name, const std::vector<T>& values, const std::vector<std::size_t>& shape) {
    Add(name, std::span<const T>(values), shape);
  }
  /// UTF-8 texts, as a one-dimensional '<U' array.
  void AddStrings(const std::string& name, const std::vector<std::string>& texts);
  /// One text, as a zero-dimensional array: str(archive["name"]) in Python.
  void AddString(const std::string& name, const std::string& text);
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace canonpose
