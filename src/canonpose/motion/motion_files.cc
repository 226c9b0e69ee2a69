#include "canonpose/motion/motion_files.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/motion/readers/acclaim.h"
#include "canonpose/motion/readers/bvh.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

bool IsMotionFile(const fs::path& path) {
  const std::string extension = LowerCase(path.extension().string());
  return extension == ".amc" || extension == ".bvh";
}

}  // namespace

ArticulatedMotion ReadMotion(const fs::path& path) {
  if (!IsMotionFile(path)) {
    ThrowBadInput({path.string(), "", "a motion file, .amc or .bvh",
                   path.has_extension() ? path.extension().string() : "a name without an extension", ""});
  }
  return LowerCase(path.extension().string()) == ".amc" ? ReadAcclaim(path) : ReadBvh(path);
}

std::vector<fs::path> FindMotionFiles(const std::vector<fs::path>& paths) {
  std::vector<fs::path> all;
  for (const fs::path& path : paths) {
    std::error_code error;
    if (fs::is_regular_file(path, error)) {
      if (!IsMotionFile(path)) {
        ThrowBadInput({path.string(), "", "a motion file, .amc or .bvh", "a file of another kind", "check the path"});
      }
      all.push_back(path);
      continue;
    }
    if (!fs::is_directory(path, error)) {
      ThrowBadInput({path.string(), "", "a motion file or a folder of them", "none", "check the path"});
    }
    const std::size_t before = all.size();
    fs::recursive_directory_iterator entry(path, error);
    for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
      std::error_code entry_error;
      if (IsMotionFile(entry->path()) && entry->is_regular_file(entry_error)) all.push_back(entry->path());
    }
    if (error) ThrowBadInput({path.string(), "", "a readable folder", error.message(), ""});
    if (all.size() == before)
      ThrowBadInput({path.string(), "", "an .amc or .bvh file in it", "none", "check the path"});
  }
  // A file that is given twice, by itself and by its folder, is one clip.
  std::sort(all.begin(), all.end());
  std::set<fs::path> seen;
  std::erase_if(all, [&](const fs::path& file) { return !seen.insert(fs::canonical(file)).second; });
  return all;
}

}  // namespace canonpose
