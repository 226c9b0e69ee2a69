#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/data/readers/frame_numbers.h"
#include "canonpose/video/video_reader.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 17> kVideoExtensions{".mp4", ".mov",  ".avi",   ".mkv",  ".webm", ".m4v",
                                                            ".mpg", ".mpeg", ".mts",   ".m2ts", ".ts",   ".wmv",
                                                            ".flv", ".3gp",  ".mjpeg", ".ogv",  ".vob"};
constexpr std::array<std::string_view, 8> kImageExtensions{".jpg", ".jpeg", ".png",  ".bmp",
                                                           ".tif", ".tiff", ".webp", ".ppm"};

template <typename List>
bool HasExtension(const fs::path& path, const List& extensions) {
  return std::ranges::find(extensions, LowerCase(path.extension().string())) != extensions.end();
}

bool IsVideoName(const fs::path& path) { return HasExtension(path, kVideoExtensions); }
bool IsImageName(const fs::path& path) { return HasExtension(path, kImageExtensions); }

/// Whether `name` is matched by a pattern in which '*' stands for any text and '?' for one character.
bool Matches(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*') {
    return Matches(pattern.substr(1), name) || (!name.empty() && Matches(pattern, name.substr(1)));
  }
  return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
         Matches(pattern.substr(1), name.substr(1));
}

/// The files of a folder whose names match, sorted by name, except hidden ones.
std::vector<fs::path> FilesIn(const fs::path& folder, std::string_view pattern) {
  std::error_code error;
  fs::directory_iterator entries(folder.empty() ? fs::path(".") : folder, error);
  if (error) ThrowBadInput({folder.string(), "", "a folder that can be read", error.message(), "check the path"});
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || !Matches(pattern, name) || !entry.is_regular_file(error)) continue;
    files.push_back(folder / name);
  }
  std::ranges::sort(files);
  return files;
}

/// By the numbers in their names, where all have one.
void SortImages(std::vector<fs::path>& images) {
  std::vector<std::string> names;
  for (const fs::path& image : images) {
    names.push_back(image.filename().string());
    if (!LastNumber(names.back())) return;
  }
  const std::vector<std::int64_t> numbers = NumberFrames(names).numbers;
  std::vector<std::pair<std::int64_t, fs::path>> numbered;
  for (std::size_t i = 0; i < images.size(); ++i) numbered.emplace_back(numbers[i], images[i]);
  std::ranges::sort(numbered);
  for (std::size_t i = 0; i < images.size(); ++i) images[i] = numbered[i].second;
}

/// What is in a folder, or matches a pattern in it.
std::vector<VideoSource> SourcesIn(const std::string& path, const fs::path& folder, std::string_view pattern) {
  const std::vector<fs::path> files = FilesIn(folder, pattern);
  std::vector<VideoSource> sources;
  std::vector<fs::path> images;
  for (const fs::path& file : files) {
    if (IsVideoName(file)) sources.push_back({file.stem().string(), file, {}});
    if (IsImageName(file)) images.push_back(file);
  }
  if (!sources.empty() && !images.empty()) {
    ThrowBadInput(
        {path, "", "videos, or the images of one camera",
         fmt::format("both: {} and {}", sources.front().path.filename().string(), images.front().filename().string()),
         "give the videos by their names"});
  }
  if (!images.empty()) {
    SortImages(images);
    fs::path plain = fs::absolute(folder.empty() ? fs::path(".") : folder).lexically_normal();
    if (!plain.has_filename()) plain = plain.parent_path();
    sources.push_back({plain.filename().string(), folder, std::move(images)});
  }
  if (sources.empty()) {
    const std::string found =
        files.empty() ? "no file" : "only other files, such as " + files.front().filename().string();
    ThrowBadInput({path, "", "videos or images", found, "give the path of a video, or of a folder of images"});
  }
  return sources;
}

std::vector<VideoSource> SourcesOf(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return SourcesIn(path, path, "*");
  if (fs::exists(path, error)) {
    if (IsImageName(path)) {
      ThrowBadInput({path, "", "a video, or a folder of images", "one image", "give the folder that the image is in"});
    }
    return {{fs::path(path).stem().string(), path, {}}};
  }
  const std::string pattern = fs::path(path).filename().string();
  if (pattern.find_first_of("*?") == std::string::npos) {
    ThrowBadInput({path, "", "a video, or a folder of images", "no such file or folder", "check the path"});
  }
  return SourcesIn(path, fs::path(path).parent_path(), pattern);
}

std::string FolderAbove(const VideoSource& source) {
  fs::path plain = fs::absolute(source.path).lexically_normal();
  if (!plain.has_filename()) plain = plain.parent_path();
  return plain.parent_path().filename().string();
}

std::map<std::string, int> CountNames(const std::vector<VideoSource>& sources) {
  std::map<std::string, int> counts;
  for (const VideoSource& source : sources) ++counts[LowerCase(source.name)];
  return counts;
}

}  // namespace

bool HoldsVideos(const fs::path& folder) {
  std::error_code error;
  return fs::is_directory(folder, error) && std::ranges::any_of(FilesIn(folder, "*"), IsVideoName);
}

std::vector<VideoSource> FindVideos(const std::vector<std::string>& paths) {
  std::vector<VideoSource> sources;
  for (const std::string& path : paths) {
    for (VideoSource& source : SourcesOf(path)) sources.push_back(std::move(source));
  }
  const std::map<std::string, int> counts = CountNames(sources);
  for (VideoSource& source : sources) {
    const std::string above = counts.at(LowerCase(source.name)) > 1 ? FolderAbove(source) : "";
    if (!above.empty()) source.name = above + "-" + source.name;
  }
  const std::map<std::string, int> counts_after = CountNames(sources);
  for (const VideoSource& source : sources) {
    if (counts_after.at(LowerCase(source.name)) == 1) continue;
    ThrowBadInput({source.path.string(), "", "another name for each camera", fmt::format("two called {}", source.name),
                   "give every video once, and rename one of the two"});
  }
  return sources;
}

}  // namespace canonpose
