// The bytes of one .npy array (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "canonpose/data/codecs/npz.h"

namespace canonpose::npy {

/// Header of version 1.0 for the type `descr` ("<f4"), C order, padded to 64 bytes.
std::string MakeHeader(const std::string& descr, const std::vector<std::size_t>& shape);

/// The texts in UTF-32, each padded with zeros to `*width` characters.
std::string EncodeTexts(const std::vector<std::string>& texts, std::size_t* width);

/// The array in `bytes`. Throws Error(kBadInput) that names `file` and `name`.
NpyArray Parse(const std::string& bytes, const std::string& file, const std::string& name);

/// Reads a file in parts, for arrays too large to hold as a whole. Every function throws Error(kBadInput) that names
/// the file.
class FileReader {
 public:
  /// Reads the header, and checks the size of the file against it where the values are numbers.
  explicit FileReader(const std::filesystem::path& path);
  ~FileReader();
  FileReader(const FileReader&) = delete;
  FileReader& operator=(const FileReader&) = delete;

  [[nodiscard]] const std::vector<std::size_t>& shape() const;
  /// Whether the values are numbers, not text.
  [[nodiscard]] bool has_numbers() const;
  /// The array of numbers at `index` < shape()[0] of the first dimension, of shape()[1], shape()[2], ...
  [[nodiscard]] NpyArray ReadPart(std::size_t index) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The pickle that an array of Python objects is stored as. Throws Error(kBadInput) where `bytes` is another array.
std::string ParsePickle(const std::string& bytes, const std::string& file, const std::string& name);

}  // namespace canonpose::npy
