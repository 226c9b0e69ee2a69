// When the frames of several cameras were taken, and whether those of one number belong together.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/data/frame_alignment.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/video_facts.h"

namespace canonpose {

/// Frames per second as the user gives them.
struct GivenRates {
  double all = 0.0;                         ///< of the cameras that have no own one; 0: not given
  std::map<std::string, double> of_camera;  ///< by the cameras' names

  [[nodiscard]] double Of(const std::string& camera) const {
    const auto own = of_camera.find(camera);
    return own == of_camera.end() ? all : own->second;
  }
};

struct ClipTiming {
  double fps = 0.0;  ///< of all clips; 0 where unknown, and then they may even differ
  FrameTiming timing = FrameTiming::kCommon;
};

/// Gives all clips equally many frames of one rate. Logs what was done unless nothing was.
///
/// Frames of videos of one rate, and those of which no time is known, are matched by AlignFrames(), if `alignment` is
/// not kNone. Otherwise every clip counts from its own first frame: where the rates differ or vary, keypoints are
/// interpolated at common intervals (ResampleToCommonRate()), and shorter clips end in frames without detections.
///
/// Given rates of single cameras replace what `facts` say of all. One rate that is given for all cameras only becomes
/// the result's, with a warning where the times of the frames say otherwise. The result's timing is kOwn where kNone is
/// asked for or nothing matches the frames, and kUnsure where the videos differ in rate or by more than half a second
/// in length. Throws Error(kBadInput) where AlignFrames() does, and Error(kInvalidArgument) where rates are given of
/// some cameras and not known of others.
ClipTiming TimeClips(std::vector<KeypointClip>& clips, const std::vector<std::optional<VideoFacts>>& facts,
                     const GivenRates& given, FrameAlignment alignment);

/// Interpolates all clips at the intervals of one rate, each from its own first frame on: the highest of their rates up
/// to 60 per second, or the lowest where all are above that. `times_seconds` (clips, T) are those of the frames. A
/// keypoint needs detections in the frames before and after, which no lost frame separates; its confidence is
/// interpolated, too. Returns the rate.
double ResampleToCommonRate(const std::vector<std::vector<double>>& times_seconds, std::vector<KeypointClip>& clips);

}  // namespace canonpose
