#include "canonpose/base/temporary_folder.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "canonpose/base/error.h"

namespace canonpose {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "canonpose-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    ThrowBadInput({pattern, "", "a temporary folder that can be written", "none", "set TMPDIR to one"});
  }
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace canonpose
