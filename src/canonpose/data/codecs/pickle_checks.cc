// Keeps a damaged or malicious pickle from doing harm, and reports it.
#include <unordered_map>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/pickle_node.h"

namespace canonpose::pickle {
namespace {

/// Benchmark files nest about five levels deep.
constexpr std::size_t kDeepest = 100;

/// The parts of a value; for a dictionary, alternating keys and values.
std::size_t PartCount(const Node& node) { return node.items.size() + 2 * node.members.size(); }
const Node* Part(const Node& node, std::size_t index) {
  if (index < node.items.size()) return node.items[index];
  const auto& member = node.members[(index - node.items.size()) / 2];
  return (index - node.items.size()) % 2 == 0 ? member.first : member.second;
}

}  // namespace

void RefuseEndless(const Node* root, const Where& where) {
  enum class State { kOpen, kDone };
  std::unordered_map<const Node*, State> states;
  std::vector<std::pair<const Node*, std::size_t>> path;
  const auto enter = [&](const Node* node) {
    if (node->stage == Node::Stage::kBlank) where.FailDamaged("an array without its numbers");
    if (!states.try_emplace(node, State::kOpen).second) {
      if (states[node] == State::kOpen) where.FailDamaged("a value that contains itself");
      return;
    }
    path.emplace_back(node, 0);
    if (path.size() > kDeepest) where.FailDamaged(fmt::format("values nested more than {} deep", kDeepest));
  };
  enter(root);
  while (!path.empty()) {
    auto& [node, next] = path.back();
    if (next < PartCount(*node)) {
      enter(Part(*node, next++));
    } else {
      states[node] = State::kDone;
      path.pop_back();
    }
  }
}

void Where::Fail(const std::string& expected, const std::string& found, const std::string& advice) const {
  ThrowBadInput({storage.file, fmt::format("{}{}byte {}", storage.place, storage.place.empty() ? "" : ", ", byte),
                 expected, found, advice});
}

void Where::FailDamaged(const std::string& what) const {
  Fail("a Python pickle", what, "the file is cut short or damaged, or is not a pickle; copy or create it again");
}

void Where::FailName(std::string_view name) const {
  std::string printable;
  for (const char c : name.substr(0, 80)) printable += c >= ' ' && c <= '~' ? c : '?';
  Fail("numbers, texts, lists, dictionaries and NumPy arrays", fmt::format("the name {}", printable),
       "nothing was executed; do not load the file with Python unless you trust its source");
}

void Where::Copied(std::size_t bytes) const {
  constexpr std::size_t kCopiesOfAFile = 16;  // a list of N numbers takes 2 N bytes of the file and 8 N of memory
  storage.copied_bytes += bytes;
  if (storage.copied_bytes > kCopiesOfAFile * storage.file_bytes) FailDamaged("the same values over and over");
}

}  // namespace canonpose::pickle
