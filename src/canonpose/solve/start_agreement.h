// How well tracklets of two views agree in what the start's poses show, and which rotations between the cameras many of
// them agree on.
//
// Each view's start poses are relative to its own camera. If two tracklets show the same person, one rotation takes the
// poses of one to those of the other in all frames; and between two static cameras that rotation is the same for
// everybody. So a rotation that many pairs of tracklets agree on is right, and pairs that disagree with it are
// different people.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/tracklets.h"

namespace canonpose {

/// Two tracklets of different views, from.view < to.view, in the frames that they share.
struct TrackletPair {
  int from = 0;  ///< index into Lanes::tracklets
  int to = 0;
  std::vector<int> slots;  ///< numbers of the sampled frames in which both have a start pose
  /// Sum over these frames of Y^T X, where X and Y are the poses (J, 3) of unit norm in `from` and `to`.
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();

  /// The mean squared distance of poses of unit norm, Y - R X, for a rotation R.
  [[nodiscard]] double Misfit(const Eigen::Matrix3d& rotation) const {
    return 2.0 - 2.0 * (rotation.transpose() * moment).trace() / static_cast<double>(slots.size());
  }
};

/// Rotations of all cameras, camera_from_world (V), NaN for those that nothing connects to the others.
struct RotationProposal {
  std::vector<Eigen::Matrix3d> camera_from_world;
  double support = 0.0;  ///< how many frames of how many pairs agree with them
};

class StartAgreement {
 public:
  /// `people` must outlive this.
  explicit StartAgreement(const PeopleObservations& people);

  /// All pairs of tracklets of two views, from < to.
  [[nodiscard]] const std::vector<TrackletPair>& PairsOf(int from, int to) const {
    return pairs_[static_cast<std::size_t>(from * view_count_ + to)];
  }
  /// How many frames agree with a rotation, camera `to` from camera `from`: those of the pairs that fit, each counted
  /// by how well it does. In a frame each tracklet counts in one pair only. Improves the rotation where `improved` is
  /// given.
  [[nodiscard]] double Support(int from, int to, const Eigen::Matrix3d& rotation,
                               Eigen::Matrix3d* improved = nullptr) const;
  /// The sets of rotations with most support, best first, at most `count`. Sets that differ by less than about 15
  /// degrees in every camera are one.
  [[nodiscard]] std::vector<RotationProposal> Propose(int count) const;
  /// The misfit of two tracklets under rotations; infinite where they share too few frames.
  [[nodiscard]] double Misfit(int tracklet, int other, const RotationProposal& proposal) const;

  /// The sampled frames, by slot.
  [[nodiscard]] const std::vector<int>& frames() const { return frames_; }

 private:
  /// Of one pair of views.
  struct RelativeRotation {
    int from = 0;
    int to = 0;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    double support = 0.0;
  };

  void AddPair(int tracklet, int other);
  [[nodiscard]] std::vector<RelativeRotation> ProposePair(int from, int to) const;
  [[nodiscard]] double SupportOf(const RotationProposal& proposal, int view) const;

  const PeopleObservations& people_;
  int view_count_;
  std::vector<int> frames_;
  std::vector<std::vector<TrackletPair>> pairs_;         ///< (V, V)
  std::map<std::pair<int, int>, std::size_t> index_of_;  ///< of a pair's tracklets, into the pairs of their views
};

/// People whose views the start's poses alone tell, under rotations: pairs that fit, and clearly better than any other
/// tracklet at the same time would. Each of them in the sampled frames only.
std::vector<Person> ConfidentPeople(const PeopleObservations& people, const StartAgreement& agreement,
                                    const RotationProposal& proposal);

}  // namespace canonpose
