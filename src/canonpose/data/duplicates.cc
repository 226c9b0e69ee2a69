#include "canonpose/data/duplicates.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"

namespace canonpose {
namespace {

/// Sequences that have this share of their frames in common are the same recording.
constexpr double kShareOfACopy = 0.5;

/// Nothing for a frame in which nothing was seen: those are all alike.
std::optional<std::uint64_t> FrameFingerprint(const std::vector<float>& keypoints, std::size_t frame,
                                              std::size_t joint_count) {
  Fingerprint fingerprint;
  std::size_t seen = 0;
  for (std::size_t i = 2 * frame * joint_count; i < 2 * (frame + 1) * joint_count; ++i) {
    const float value = keypoints[i];
    if (!std::isfinite(value)) continue;
    const std::size_t coordinate = i - 2 * frame * joint_count;
    fingerprint.Add(&coordinate, sizeof(coordinate));
    fingerprint.Add(&value, sizeof(value));
    ++seen;
  }
  if (seen < joint_count) return std::nullopt;  // fewer than half of the joints may be alike by chance
  return fingerprint.value();
}

/// The fingerprints of all frames of a sequence in which enough is seen: of each camera, and of each of its tracks.
std::vector<std::uint64_t> FingerprintsOf(const Sequence& sequence, std::size_t joint_count) {
  std::vector<const std::vector<float>*> arrays;
  for (const CameraView& view : sequence.cameras) {
    arrays.push_back(&view.keypoints);
    for (const CameraTrack& track : view.tracks) arrays.push_back(&track.keypoints);
  }
  std::vector<std::uint64_t> fingerprints;
  for (const std::vector<float>* keypoints : arrays) {
    for (std::size_t t = 0; t < static_cast<std::size_t>(sequence.frame_count); ++t) {
      if (const auto fingerprint = FrameFingerprint(*keypoints, t, joint_count)) fingerprints.push_back(*fingerprint);
    }
  }
  return fingerprints;
}

}  // namespace

void RequireDistinctRecordings(const std::vector<Dataset>& datasets, const std::vector<std::string>& files) {
  std::size_t sequences = 0;
  for (const Dataset& dataset : datasets) sequences += dataset.sequences.size();
  if (sequences < 2) return;
  std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> first_seen;  // dataset and sequence
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    const std::size_t joints = datasets[d].skeleton.joints.size();
    for (std::size_t s = 0; s < datasets[d].sequences.size(); ++s) {
      const Sequence& sequence = datasets[d].sequences[s];
      const std::vector<std::uint64_t> own = FingerprintsOf(sequence, joints);
      std::map<std::pair<std::size_t, std::size_t>, std::size_t> shared;  // with which sequence, how many
      for (const std::uint64_t fingerprint : own) {
        const auto [found, is_new] = first_seen.try_emplace(fingerprint, d, s);
        if (!is_new && found->second != std::pair(d, s)) ++shared[found->second];
      }
      for (const auto& [other, count] : shared) {
        const Sequence& first = datasets[other.first].sequences[other.second];
        const std::size_t frames_of_other = FingerprintsOf(first, datasets[other.first].skeleton.joints.size()).size();
        if (static_cast<double>(count) <= kShareOfACopy * static_cast<double>(std::min(own.size(), frames_of_other)))
          continue;
        ThrowBadInput({files[d], sequence.name, "recordings that are given once",
                       fmt::format("the keypoints of {} in {}", first.name, files[other.first]),
                       "leave one of them out: what is held out of one would be learned from the other"});
      }
    }
  }
}

}  // namespace canonpose
