#include "canonpose/data/choice.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"

namespace canonpose {
namespace {

/// `what` says for the message what is being chosen.
std::vector<std::string> SplitAtCommas(const std::string& text, const char* what) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  if (std::ranges::any_of(words, [](const std::string& word) { return word.empty(); })) {
    ThrowInvalidArgument("{}; found '{}'", what, text);
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

void KeepCameras(Sequence& sequence, const std::vector<std::string>& names) {
  std::erase_if(sequence.cameras,
                [&](const CameraView& view) { return std::ranges::find(names, view.name) == names.end(); });
}

void KeepCameras(Dataset& dataset, const std::string& choice, const std::string& file) {
  const std::set<std::string> known = CameraNames(dataset);
  const std::optional<std::size_t> count = ParseCount(choice);
  if (count && !known.contains(choice)) {
    KeepFirst(dataset, *count, file);
    return;
  }
  const std::vector<std::string> chosen =
      SplitAtCommas(choice, "cameras are chosen by name (A,B) or by how many there are to be");
  for (const std::string& name : chosen) {
    if (known.contains(name)) continue;
    ThrowBadInput({file, "", fmt::format("a camera {}", name), fmt::format("{}", fmt::join(known, ", ")),
                   "choose from these cameras"});
  }
  for (Sequence& sequence : dataset.sequences) KeepCameras(sequence, chosen);
  std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.cameras.empty(); });
}

void RequireTwoCameras(const Dataset& dataset, const std::string& file) {
  const auto has_two = [](const Sequence& sequence) { return sequence.cameras.size() >= 2; };
  if (std::ranges::any_of(dataset.sequences, has_two)) return;
  ThrowBadInput({file, "", "at least two cameras that filmed the person at the same time",
                 fmt::format("one, {}", fmt::join(CameraNames(dataset), " or ")),
                 "import the views of all cameras together (one camera is enough for `canonpose lift`)"});
}

void KeepSubjects(Dataset& dataset, const std::string& choice, const std::string& file) {
  const std::vector<std::string> chosen = SplitAtCommas(choice, "subjects are chosen by name (A,B)");
  std::set<std::string> known;
  for (const Sequence& sequence : dataset.sequences) known.insert(sequence.subject);
  for (const std::string& name : chosen) {
    if (std::ranges::any_of(known, [&](const std::string& one) { return SameName(one, name); })) continue;
    ThrowBadInput({file, "", fmt::format("a subject {}", name), fmt::format("{}", fmt::join(known, ", ")),
                   "choose from these subjects"});
  }
  std::erase_if(dataset.sequences, [&](const Sequence& sequence) {
    return std::ranges::none_of(chosen, [&](const std::string& name) { return SameName(name, sequence.subject); });
  });
}

}  // namespace canonpose
