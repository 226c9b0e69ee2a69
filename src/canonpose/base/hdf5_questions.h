// Reads an HDF5 file in a child process: the library crashes on some damaged files, and runs for ever on others.
//
// Only for hdf5.cc.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "canonpose/base/child_process.h"
#include "canonpose/base/hdf5.h"

namespace canonpose::h5 {

/// What can be asked about a name in a group, and the type of the answer.
enum class Question : std::uint8_t {
  kOpenFile,      ///< bool
  kHas,           ///< bool
  kHasAttribute,  ///< bool
  kChildren,      ///< std::vector<std::string>
  kOpen,          ///< bool
  kStrings,       ///< std::vector<std::string>
  kInts,          ///< std::vector<std::int64_t>
  kDouble,        ///< double
  kShape,         ///< std::vector<std::size_t>
  kFloats,        ///< Array<float>
  kDoubles,       ///< Array<double>
  kIntegers,      ///< Array<std::int64_t>
  kTexts,         ///< std::vector<std::string>
  kField,         ///< Array<double>; the detail is the name of the field
};

class FileInChild {
 public:
  /// `open` is called in the child.
  FileInChild(const std::filesystem::path& path, std::function<File()> open);

  /// Throws the Error(kBadInput) that the same call throws in the child, or one that says how the child ended.
  template <typename Result>
  Result Ask(Question question, const std::string& group, const std::string& name, const std::string& detail = "");

 private:
  std::string path_;
  ChildProcess child_;
};

}  // namespace canonpose::h5
