#include "canonpose/data/dataset.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/base/rows.h"

namespace canonpose {
namespace {

template <typename Predicate>
bool AnyView(const Dataset& dataset, Predicate predicate) {
  for (const Sequence& sequence : dataset.sequences) {
    if (std::any_of(sequence.cameras.begin(), sequence.cameras.end(), predicate)) return true;
  }
  return false;
}

/// Other programs may write NaNs with other bits; the fingerprint must not depend on that.
void AddValues(Fingerprint& fingerprint, const std::vector<float>& values) {
  for (const float value : values) {
    const float canonical = std::isnan(value) ? std::numeric_limits<float>::quiet_NaN() : value;
    fingerprint.Add(&canonical, sizeof(canonical));
  }
}

void AddInts(Fingerprint& fingerprint, const std::vector<int>& values) {
  fingerprint.Add(values.data(), values.size() * sizeof(int));
}

std::optional<int> ParseFrame(std::string_view text) {
  int frame = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame);
  if (error != std::errc() || end != text.data() + text.size() || frame < 0) return std::nullopt;
  return frame;
}

}  // namespace

PoseSequence TruthPoses(const Skeleton& skeleton, std::vector<float> positions, const std::string& camera) {
  return PosesInCamera(skeleton, std::move(positions), LengthUnit::kMillimetres, camera);
}

bool LacksUncertainty(const PoseSequence& solved) {
  return solved.AnyKnown() &&
         std::ranges::none_of(solved.standard_deviation(), [](float s) { return std::isfinite(s); });
}

ViewClock::ViewClock(const Sequence& sequence, const CameraView& view)
    : count_(sequence.frame_count), solved_frames_(view.solved_frames) {
  constexpr double kDefaultFps = 30.0;
  if (solved_frames_.empty()) {
    const double fps = sequence.fps > 0.0 ? sequence.fps : kDefaultFps;
    shift_ = view.time_offset_seconds * fps;
    offset_ = static_cast<int>(std::lround(shift_));
    return;
  }
  own_.assign(static_cast<std::size_t>(count_), -1);
  for (int t = 0; t < count_; ++t) {
    const double shown = solved_frames_[static_cast<std::size_t>(t)];
    const double nearest = std::round(shown);  // not a number where it is left out
    if (!(nearest >= 0.0 && nearest < count_) || !(std::abs(shown - nearest) <= SameMoment(t))) continue;
    int& own = own_[static_cast<std::size_t>(nearest)];
    const double other = own < 0 ? std::nan("") : solved_frames_[static_cast<std::size_t>(own)];
    if (!(std::abs(other - nearest) < std::abs(shown - nearest))) own = t;
  }
}

double ViewClock::SameMoment(int own) const {
  constexpr double kUsual = 0.25;
  constexpr double kNearest = 0.5;
  const double here = solved_frames_[static_cast<std::size_t>(own)];
  for (const int other : {own - 1, own + 1}) {
    if (other < 0 || other >= count_) continue;
    const double step = std::abs(solved_frames_[static_cast<std::size_t>(other)] - here);
    if (step > 1.0 - kUsual && step < 1.0 + kUsual) return kNearest;
  }
  return kUsual;
}

int ViewClock::OwnFrame(int frame) const {
  if (!own_.empty()) return frame >= 0 && frame < count_ ? own_[static_cast<std::size_t>(frame)] : -1;
  const int own = frame - offset_;
  return own >= 0 && own < count_ ? own : -1;
}

bool Sequence::HasTracks() const {
  return std::ranges::any_of(cameras, [](const CameraView& view) { return !view.tracks.empty(); });
}

double ViewClock::TimeOf(int own) const {
  return solved_frames_.empty() ? own + shift_ : solved_frames_[static_cast<std::size_t>(own)];
}

bool Dataset::HasTruth() const {
  return AnyView(*this, [](const CameraView& view) { return view.truth.AnyKnown(); });
}

bool Dataset::HasSolved() const {
  return AnyView(*this, [](const CameraView& view) { return view.solved.AnyKnown(); });
}

bool Dataset::HasCalibration() const {
  return AnyView(*this, [](const CameraView& view) { return !view.calibration.empty(); });
}

std::uint64_t Dataset::Fingerprint() const {
  canonpose::Fingerprint fingerprint;
  for (const std::string& joint : skeleton.joints) fingerprint.Add(joint);
  AddInts(fingerprint, skeleton.parents);
  AddInts(fingerprint, skeleton.mirror);
  AddInts(fingerprint, {skeleton.root});
  for (const Sequence& sequence : sequences) {
    fingerprint.Add(sequence.capture);
    AddInts(fingerprint, {sequence.frame_count, sequence.static_cameras ? 1 : 0});
    for (const CameraView& view : sequence.cameras) {
      AddInts(fingerprint, {view.image_size[0], view.image_size[1]});
      AddValues(fingerprint, view.keypoints);
      AddValues(fingerprint, view.confidence);
      for (const CameraTrack& track : view.tracks) {
        fingerprint.Add(track.id);
        AddValues(fingerprint, track.keypoints);
        AddValues(fingerprint, track.confidence);
      }
    }
  }
  return fingerprint.value();
}

FrameRange FrameRange::Parse(const std::string& text) {
  const std::size_t dash = text.find('-');
  const std::optional<int> first = ParseFrame(text.substr(0, dash));
  std::optional<int> last = first;
  if (dash != std::string::npos) {
    last = dash + 1 == text.size() ? std::optional<int>(INT32_MAX) : ParseFrame(text.substr(dash + 1));
  }
  if (!first || !last || *last < *first) {
    ThrowInvalidArgument("frames are given as A-B, A- or A, counted from 0, with A not after B; found '{}'", text);
  }
  return {*first, *last};
}

void FrameRange::RequireLast(int frame_count, const std::string& file) const {
  if (last == INT32_MAX || last < frame_count || first >= frame_count) return;
  ThrowBadInput(
      {file, "", fmt::format("frames up to {}, as `frames` says", last),
       fmt::format("{} frames, the last of which is {}", frame_count, frame_count - 1),
       fmt::format("give `frames={}-{}`, or `frames={}-` for all from there on", first, frame_count - 1, first)});
}

void KeepFrames(Sequence& sequence, int first, int last, int step) {
  const auto keep = [&](auto& values) { KeepRows(values, sequence.frame_count, first, last + 1, step); };
  for (CameraView& view : sequence.cameras) {
    keep(view.keypoints);
    keep(view.confidence);
    for (CameraTrack& track : view.tracks) {
      keep(track.keypoints);
      keep(track.confidence);
    }
    view.truth.KeepFrames(first, last, step);
    view.solved.KeepFrames(first, last, step);
    keep(view.solved_frames);
    for (double& frame : view.solved_frames) frame = (frame - first) / step;
    if (view.calibration.size() > 1) keep(view.calibration);
    if (view.solved_calibration.size() > 1) keep(view.solved_calibration);
  }
  keep(sequence.action);
  sequence.frame_count = first <= last ? (last - first) / step + 1 : 0;
}

void KeepFrames(Dataset& dataset, const FrameRange& range, const std::string& file) {
  int longest = 0;
  for (const Sequence& sequence : dataset.sequences) longest = std::max(longest, sequence.frame_count);
  range.RequireLast(longest, file);
  for (Sequence& sequence : dataset.sequences) {
    const int last = std::min(range.last, sequence.frame_count - 1);
    if (range.first > last) {
      sequence.frame_count = 0;
      continue;
    }
    KeepFrames(sequence, range.first, last);
  }
  std::erase_if(dataset.sequences, [](const Sequence& sequence) { return sequence.frame_count == 0; });
  if (dataset.sequences.empty()) {
    ThrowBadInput({file, "", fmt::format("frames from {} on", range.first),
                   fmt::format("sequences of {} frames at most", longest), "choose frames that exist"});
  }
}

}  // namespace canonpose
