#include "canonpose/base/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <string>

#include "canonpose/base/error.h"

namespace canonpose {

namespace fs = std::filesystem;

fs::path MakeUniqueFolder(const fs::path& prefix, std::error_code& error) {
  std::string pattern = prefix.string() + "XXXXXX";
  error.clear();
  if (::mkdtemp(pattern.data()) != nullptr) return pattern;
  error.assign(errno, std::generic_category());
  return {};
}

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const fs::path prefix = fs::temp_directory_path(error) / "canonpose-";
  if (!error) path_ = MakeUniqueFolder(prefix, error);
  if (error) {
    ThrowBadInput({prefix.string(), "", "a place for temporary folders", error.message(), "set TMPDIR to one"});
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace canonpose
