// The sequences and frames of a dataset that a protocol evaluates.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/protocol.h"

namespace canonpose {

/// What was selected from one dataset, and what was not.
struct Selection {
  std::int64_t first_frame = 0;  ///< the number that the first frame of every sequence had in its file
  std::int64_t frame_step = 1;
  std::int64_t left_out_sequences = 0;
  std::vector<std::string> left_out_subjects;  ///< their subjects, each once
  std::int64_t sequences_too_short = 0;        ///< sequences of evaluated subjects without any frame to evaluate

  /// The number of a selected frame in its file, counted from 0.
  [[nodiscard]] std::int64_t FrameNumber(std::size_t index) const {
    return first_frame + frame_step * static_cast<std::int64_t>(index);
  }
};

/// The action in a frame of a sequence, as an index into the current sequence; empty if unknown.
std::string ActionIn(const Sequence& sequence, std::size_t frame);

/// Reduces `dataset` to what `protocol` evaluates, which may be nothing. `first_frame` is the number in the file of the
/// dataset's first frame, after KeepFrames().
Selection SelectPoses(Dataset& dataset, const Protocol& protocol, int first_frame);

}  // namespace canonpose
