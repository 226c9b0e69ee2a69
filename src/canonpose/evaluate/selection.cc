#include "canonpose/evaluate/selection.h"

#include <algorithm>

namespace canonpose {
namespace {

/// Keeps rows first, first + step, ... of an array with one row per frame.
template <typename T>
void KeepRows(std::vector<T>& values, int frame_count, int first, int step) {
  const std::size_t row = values.size() / static_cast<std::size_t>(frame_count);
  std::vector<T> kept;
  for (int frame = first; frame < frame_count; frame += step) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row) * frame;
    kept.insert(kept.end(), begin, begin + static_cast<std::ptrdiff_t>(row));
  }
  values = std::move(kept);
}

void KeepFrames(Sequence& sequence, int first, int step) {
  const int count = sequence.frame_count;
  for (CameraView& view : sequence.cameras) {
    KeepRows(view.keypoints, count, first, step);
    KeepRows(view.confidence, count, first, step);
    view.truth.KeepFrames(first, count - 1, step);
    view.solved.KeepFrames(first, count - 1, step);
    if (!view.solved_frames.empty()) {
      KeepRows(view.solved_frames, count, first, step);
      for (double& frame : view.solved_frames) frame = (frame - first) / step;
    }
    if (view.calibration.size() > 1) KeepRows(view.calibration, count, first, step);
    if (view.solved_calibration.size() > 1) KeepRows(view.solved_calibration, count, first, step);
  }
  KeepRows(sequence.action, count, first, step);
  sequence.frame_count = first < count ? (count - 1 - first) / step + 1 : 0;
}

}  // namespace

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
  for (Sequence& sequence : dataset.sequences) KeepFrames(sequence, first - first_frame, protocol.frame_step);
  selection.sequences_too_short = static_cast<std::int64_t>(
      std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.frame_count == 0; }));
  return selection;
}

}  // namespace canonpose
