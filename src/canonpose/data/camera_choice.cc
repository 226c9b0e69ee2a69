#include "canonpose/data/camera_choice.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

std::vector<std::string> SplitAtCommas(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  if (std::ranges::any_of(words, [](const std::string& word) { return word.empty(); })) {
    ThrowUsage("cameras are chosen by name, A,B, or by their number; found '{}'", text);
  }
  return words;
}

std::set<std::string> CameraNames(const Dataset& dataset) {
  std::set<std::string> names;
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) names.insert(view.name);
  }
  return names;
}

std::optional<std::size_t> ParseCount(const std::string& text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size() || count == 0) return std::nullopt;
  return count;
}

void KeepFirst(Dataset& dataset, std::size_t count, const std::string& file) {
  for (Sequence& sequence : dataset.sequences) {
    if (sequence.cameras.size() < count) {
      ThrowBadInput({file, sequence.name, fmt::format("{} cameras", count), fmt::format("{}", sequence.cameras.size()),
                     "choose fewer cameras"});
    }
    sequence.cameras.resize(count);
  }
}

}  // namespace

void KeepCameras(Dataset& dataset, const std::string& choice, const std::string& file) {
  const std::set<std::string> known = CameraNames(dataset);
  const std::optional<std::size_t> count = ParseCount(choice);
  if (count && !known.contains(choice)) {
    KeepFirst(dataset, *count, file);
    return;
  }
  const std::vector<std::string> chosen = SplitAtCommas(choice);
  for (const std::string& name : chosen) {
    if (known.contains(name)) continue;
    ThrowBadInput({file, "", fmt::format("a camera {}", name), fmt::format("{}", fmt::join(known, ", ")),
                   "choose cameras that are there"});
  }
  for (Sequence& sequence : dataset.sequences) {
    std::erase_if(sequence.cameras,
                  [&](const CameraView& view) { return std::ranges::find(chosen, view.name) == chosen.end(); });
  }
  std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.cameras.empty(); });
}

}  // namespace canonpose
