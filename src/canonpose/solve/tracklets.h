// The people whom each camera sees, before it is known who is who: tracks cut into tracklets, which are packed into
// lanes so that the rest of the solver can read them like any capture.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// One person, probably, in one view without a long gap.
struct Tracklet {
  int view = 0;
  int track = 0;  ///< index into CameraView::tracks
  int lane = 0;
  int first = 0;  ///< its first frame with a keypoint
  int last = 0;   ///< inclusive
};

/// The tracklets of one sequence: V views, T frames, L lanes. Those of one view that share no frame may share a lane.
struct Lanes {
  /// One sequence of static cameras per lane, all of one capture, whose keypoints are those of the lane's tracklets.
  Dataset dataset;
  std::vector<Tracklet> tracklets;
  int lane_count = 0;
  int view_count = 0;
  int frame_count = 0;
  double fps = 0.0;        ///< never 0: 30 where the sequence does not say
  std::vector<int> owner;  ///< (L, V, T) the tracklet; -1 where the lane is empty

  [[nodiscard]] int Owner(int lane, int view, int frame) const {
    return owner[(static_cast<std::size_t>(lane) * static_cast<std::size_t>(view_count) +
                  static_cast<std::size_t>(view)) *
                     static_cast<std::size_t>(frame_count) +
                 static_cast<std::size_t>(frame)];
  }
};

/// Cuts the tracks of a sequence where nothing is seen for half a second: somebody else may have come meanwhile.
Lanes MakeLanes(const Skeleton& skeleton, const Sequence& sequence);

/// Tracklets with what they show. Frame t of a lane is frame FrameOf(lane, t) of the capture.
struct PeopleObservations {
  CaptureObservations capture;
  Lanes lanes;

  [[nodiscard]] int FrameOf(int lane, int frame) const { return lane * lanes.frame_count + frame; }
  [[nodiscard]] int FrameOf(const Tracklet& tracklet, int frame) const { return FrameOf(tracklet.lane, frame); }
};

/// `start` has poses of `lanes.dataset`.
PeopleObservations CollectPeople(Lanes lanes, const StartPoses& start);

/// One person across the views.
struct Person {
  std::vector<int> lanes;  ///< (T, V) in which lane the view shows the person; -1: it does not

  Person() = default;
  explicit Person(const Lanes& all)
      : lanes(static_cast<std::size_t>(all.frame_count) * static_cast<std::size_t>(all.view_count), -1),
        view_count_(all.view_count) {}
  [[nodiscard]] int& At(int frame, int view) {
    return lanes[static_cast<std::size_t>(frame) * static_cast<std::size_t>(view_count_) +
                 static_cast<std::size_t>(view)];
  }
  [[nodiscard]] int At(int frame, int view) const { return const_cast<Person*>(this)->At(frame, view); }
  /// How many views show the person.
  [[nodiscard]] int ViewsAt(int frame) const;
  /// The frames in which at least `views` views show the person.
  [[nodiscard]] std::vector<int> FramesWith(int views) const;

 private:
  int view_count_ = 0;
};

/// A static capture in which each person is a subject of their own: person p in frames[p].
CaptureObservations AssembleCapture(const PeopleObservations& people, std::span<const Person> persons,
                                    std::span<const std::vector<int>> frames);

/// The sequence of one person, with all frames and cameras of `sequence`, whose tracks the lanes were made of.
Sequence SequenceOf(const Lanes& lanes, const Person& person, const Sequence& sequence, const std::string& name);

/// The start's poses of one person, by view.
std::vector<PoseSequence> StartOf(const Lanes& lanes, const Person& person, const StartPoses& start);

}  // namespace canonpose
