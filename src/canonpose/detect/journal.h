// What the network said of each frame of a video, on disk while it is at work: a run that was killed goes on from
// there.
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "canonpose/detect/pose_network.h"

namespace canonpose {

/// One answer of a network: which question, and the numbers of the answer.
struct NetworkAnswer {
  enum class Kind { kPeople, kPose, kAppearance };
  Kind kind = Kind::kPose;
  std::vector<float> numbers;  ///< 52 per pose (x, y, score of each joint, and its own score), or 6 colours
};

/// The answers about one frame, in the order of the questions.
using FrameAnswers = std::vector<NetworkAnswer>;

/// A text file: a line that says what the answers are about, then a line per frame. A line that was not finished is
/// dropped when the file is opened.
class Journal {
 public:
  /// Opens or creates the file. `subject` is what the answers are about: the video, the networks, the options, in one
  /// line. Throws Error(kBadInput) where the file cannot be read or written, or has answers about something else, which
  /// are left as they are.
  Journal(std::filesystem::path path, const std::string& subject);

  /// The answers about the first frames that are known already.
  [[nodiscard]] std::deque<FrameAnswers>& known() { return known_; }
  /// Adds the next frame's. Throws Error(kBadInput) where the disk is full.
  void Append(const FrameAnswers& answers);
  /// Deletes the file; nothing may be appended any more.
  void Remove();

 private:
  std::filesystem::path path_;
  std::deque<FrameAnswers> known_;
  std::ofstream stream_;
};

/// Throws Error(kBadInput) where `path` is a journal with answers about something other than `subject`. One without any
/// answer is no loss.
void RequireJournalOf(const std::filesystem::path& path, const std::string& subject);

/// Passes questions on to a network and keeps its answers; where those to this frame are known, gives them instead.
class RecordedNetwork final : public PoseNetwork {
 public:
  explicit RecordedNetwork(PoseNetwork& network) : network_(network) {}

  /// Begins a frame, with its answers where they are known, or none.
  void Begin(FrameAnswers known);
  /// All answers given since.
  [[nodiscard]] const FrameAnswers& answers() const { return answers_; }

  std::vector<DetectedPose> FindPeople(const cv::Mat& image) override;
  DetectedPose PoseInCrop(const cv::Mat& image, const Crop& crop) override;
  Appearance AppearanceOf(const cv::Mat& image, const DetectedPose& pose) override;

 private:
  /// The next known answer, if it is one to this kind of question.
  [[nodiscard]] const NetworkAnswer* Known(NetworkAnswer::Kind kind);

  PoseNetwork& network_;
  FrameAnswers known_;
  FrameAnswers answers_;
};

}  // namespace canonpose
