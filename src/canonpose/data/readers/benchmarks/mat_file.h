// MATLAB's files of version 5, through libmatio: cells of matrices.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace canonpose {

/// Row-major, whatever MATLAB has.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
};

class MatFile {
 public:
  /// Throws Error(kBadInput) where the file is none, or of version 7.3, which is HDF5, or 4.
  explicit MatFile(const std::filesystem::path& path);
  ~MatFile();
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;

  /// A cell array of `count` matrices of real numbers. Throws Error(kBadInput) where it is not there or something else.
  [[nodiscard]] std::vector<Matrix> ReadCells(const std::string& name, std::size_t count) const;

  /// Throws Error(kBadInput) at a variable or a part of it, "annot2{3}".
  [[noreturn]] void Fail(const std::string& place, const std::string& expected, const std::string& found,
                         const std::string& advice = "") const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace canonpose
