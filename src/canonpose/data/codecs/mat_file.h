// MATLAB files of version 5, read with libmatio: cell arrays of matrices.
//
// The library crashes on some damaged files, so it reads in a child process (base/child_process.h): then only the child
// is lost, and the file is said to be damaged.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace canonpose {

/// A matrix in row-major order, although MATLAB stores columns.
struct Matrix {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;
};

class MatFile {
 public:
  /// `advice` ends the messages about a file of another kind or without an expected variable ("give annot.mat as
  /// published"). Throws Error(kBadInput) where the file does not exist, is damaged, or is not of version 5: version 4
  /// is not read, and version 7.3 is HDF5.
  explicit MatFile(const std::filesystem::path& path, std::string advice = "");
  ~MatFile();
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;

  /// A cell array of `count` matrices of real numbers. Throws Error(kBadInput) where there is none of that name or it
  /// holds something else.
  [[nodiscard]] std::vector<Matrix> ReadCells(const std::string& name, std::size_t count) const;

  /// Throws Error(kBadInput) at a variable or a part of it, such as "annot2{3}".
  [[noreturn]] void Fail(const std::string& place, const std::string& expected, const std::string& found,
                         const std::string& advice = "") const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace canonpose
