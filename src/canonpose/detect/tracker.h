// Follows people through one video: looks for them now and then in the whole image, and in every frame at each of them
// in a crop around where the person was before.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/detect/pose_network.h"

namespace canonpose {

struct TrackerOptions {
  /// Frames from one search of the whole image to the next, while nobody is lost.
  int search_interval = 15;
  /// At most so many people are followed at a time.
  int most_people = 8;

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// One person in one frame.
struct TrackedPose {
  int id = 0;  ///< the same for a person in all frames, counted from 0 in the order in which people appear
  DetectedPose pose;
};

/// Who is who follows from motion: a person is where the poses before lead. Where two crops show the same person, the
/// track whose motion and colours fit worse has lost its own; it looks for it in the whole image, in this frame and, at
/// growing distances, in later ones. A person found there continues the lost track that fits in position, size and
/// colours, however long ago that was, or is a new one. The same answers of the network give the same tracks.
class PersonTracker {
 public:
  PersonTracker(PoseNetwork& network, int image_width, int image_height, TrackerOptions options = {});

  /// The people in the next frame, in the order of their ids.
  std::vector<TrackedPose> Next(const cv::Mat& image);

 private:
  struct Track {
    int id = 0;
    DetectedPose pose;                     ///< when it was last seen
    Eigen::Vector2f velocity{0.0F, 0.0F};  ///< of its centre, pixels per frame
    Appearance appearance{};               ///< mean
    long last_frame = 0;                   ///< when it was last seen
    int sightings = 0;
    int doubts = 0;  ///< searches in a row that did not find it
  };
  /// What may be a track's person in this frame.
  struct Candidate {
    std::size_t track = 0;
    DetectedPose pose;
    Appearance appearance{};
    float cost = 0.0F;  ///< how badly it fits the track
  };

  [[nodiscard]] bool IsLost(const Track& track) const { return track.last_frame + 1 < frame_; }
  [[nodiscard]] DetectedPose Predict(const Track& track) const;
  [[nodiscard]] std::optional<DetectedPose> LookAt(const cv::Mat& image, const DetectedPose& where) const;
  void Follow(const cv::Mat& image);
  /// Leaves one of the candidates that show the same person.
  void DropDuplicates();
  [[nodiscard]] bool IsSearchDue() const;
  void Search(const cv::Mat& image);
  /// Gives tracks the people found in the whole image who fit them best, where their crops showed somebody else.
  void CorrectCandidates(const cv::Mat& image, const std::vector<DetectedPose>& found);
  /// The pose of a person found in the whole image: that of its crop, unless the crop shows one of the others.
  [[nodiscard]] DetectedPose Refine(const cv::Mat& image, const std::vector<DetectedPose>& found,
                                    std::size_t person) const;
  void DoubtWhoWasNotFound(const std::vector<DetectedPose>& found);
  /// The lost track that a person continues; null where it is somebody new.
  [[nodiscard]] std::optional<std::size_t> FindLost(const DetectedPose& pose, const Appearance& appearance) const;
  /// Of two candidates, in sizes of the larger; infinity where there are fewer.
  [[nodiscard]] float NearestDistance() const;
  [[nodiscard]] bool IsTaken(const DetectedPose& pose) const;
  void Update(const Candidate& candidate);

  PoseNetwork& network_;
  int width_;
  int height_;
  TrackerOptions options_;
  std::vector<Track> tracks_;
  int next_id_ = 0;                    ///< only grows: an id is not given again when its track is forgotten
  std::vector<Candidate> candidates_;  ///< of this frame
  long frame_ = -1;
  long last_search_ = -1;
  long next_try_ = 0;  ///< the frame in which somebody who was lost is looked for again
  long try_gap_ = 1;
};

}  // namespace canonpose
