#include "canonpose/data/merge.h"

#include <cstddef>
#include <filesystem>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {
namespace {

/// `name`, or where it is taken "FILE-NAME", or where that is, too, "FILE-NAME-2" and so on.
std::string MakeUnique(const std::string& name, const std::string& file, std::set<std::string>& taken) {
  if (taken.insert(name).second) return name;
  const std::string longer = fmt::format("{}-{}", std::filesystem::path(file).stem().string(), name);
  std::string unique = longer;
  for (int number = 2; !taken.insert(unique).second; ++number) unique = fmt::format("{}-{}", longer, number);
  return unique;
}

void RequireSameJoints(const std::vector<Dataset>& datasets, const std::vector<std::string>& files) {
  for (std::size_t i = 1; i < datasets.size(); ++i) {
    if (datasets[i].skeleton.SameJoints(datasets.front().skeleton)) continue;
    ThrowBadInput({files[i], "/skeleton", fmt::format("the joints of {}", files.front()),
                   fmt::format("others ({})", fmt::join(datasets[i].skeleton.joints, ", ")),
                   "import all data onto the same skeleton"});
  }
}

void WarnOfOtherSources(const std::vector<Dataset>& datasets, const std::vector<std::string>& files) {
  const auto describe = [](const DatasetSource& source) {
    return fmt::format("{}{}{}", source.format.empty() ? "of unknown origin" : source.format,
                       source.layout.empty() ? "" : " in the layout " + source.layout,
                       source.morph.empty() ? "" : ", moved by " + source.morph);
  };
  const std::string first = describe(datasets.front().source);
  for (std::size_t i = 1; i < datasets.size(); ++i) {
    const std::string other = describe(datasets[i].source);
    if (other == first) continue;
    LogWarning("the keypoints of {} are {}, those of {} are {}: the result is recorded as the former", files.front(),
               first, files[i], other);
  }
}

}  // namespace

Dataset MergeDatasets(std::vector<Dataset> datasets, const std::vector<std::string>& files) {
  CANONPOSE_CHECK(!datasets.empty() && datasets.size() == files.size(), "{} datasets, {} names", datasets.size(),
                  files.size());
  if (datasets.size() == 1) return std::move(datasets.front());
  RequireSameJoints(datasets, files);
  WarnOfOtherSources(datasets, files);
  std::set<std::string> names;
  std::set<std::string> captures;
  for (const Dataset& dataset : datasets) {
    for (const Sequence& sequence : dataset.sequences) {
      if (sequence.capture_is_named) captures.insert(sequence.capture);
    }
  }
  Dataset merged;
  merged.skeleton = datasets.front().skeleton;
  merged.source = datasets.front().source;
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    std::map<std::string, std::string> own_captures;  // of this file alone, by the names they had
    for (Sequence& sequence : datasets[i].sequences) {
      sequence.name = MakeUnique(sequence.name, files[i], names);
      if (!sequence.capture_is_named) {
        const auto [known, is_new] = own_captures.try_emplace(sequence.capture);
        if (is_new) known->second = MakeUnique(sequence.capture, files[i], captures);
        sequence.capture = known->second;
        sequence.capture_is_named = true;
      }
      merged.sequences.push_back(std::move(sequence));
    }
  }
  return merged;
}

}  // namespace canonpose
