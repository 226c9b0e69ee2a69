#include "canonpose/evaluate/selection.h"

#include <algorithm>

namespace canonpose {

std::string ActionIn(const Sequence& sequence, std::size_t frame) {
  if (sequence.actions.empty()) return "";
  return sequence.actions[sequence.action.empty() ? 0 : sequence.action[frame]];
}

Selection SelectPoses(Dataset& dataset, const Protocol& protocol, int first_frame) {
  Selection selection;
  std::erase_if(dataset.sequences, [&](const Sequence& sequence) {
    if (HasSubject(protocol, sequence.subject)) return false;
    ++selection.left_out_sequences;
    std::vector<std::string>& subjects = selection.left_out_subjects;
    if (std::find(subjects.begin(), subjects.end(), sequence.subject) == subjects.end()) {
      subjects.push_back(sequence.subject);
    }
    return true;
  });
  int first = protocol.first_frame;
  while (first < first_frame) first += protocol.frame_step;
  selection.first_frame = first;
  selection.frame_step = protocol.frame_step;
  if (first == first_frame && protocol.frame_step == 1) return selection;
  for (Sequence& sequence : dataset.sequences) {
    KeepFrames(sequence, first - first_frame, sequence.frame_count - 1, protocol.frame_step);
  }
  selection.sequences_too_short = static_cast<std::int64_t>(
      std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.frame_count == 0; }));
  return selection;
}

}  // namespace canonpose
