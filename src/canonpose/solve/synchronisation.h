// Cameras that nobody synchronised: when each began and how fast its clock runs, from the motion that they show.
//
//   1. Candidates from motion that does not depend on the view (clock_candidates.h).
//   2. Each candidate is calibrated and refined to a fraction of a frame by reprojection (clock_refinement.h), in
//   turns.
//   3. The candidate under which the cameras agree best is taken, if it is clearly better than the others. A view whose
//      place in time the motion does not tell is left out rather than guessed.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

/// How the clock of a view is known.
enum class ClockSource {
  kReference,   ///< the others are compared with it
  kMotion,      ///< found
  kGiven,       ///< by the user
  kAsRecorded,  ///< the motion does not tell more than the frames' numbers
  kUnknown,     ///< not found; the view is left out
};

/// "reference", "found", "given", "as recorded" or "not found".
const char* NameOf(ClockSource source);

/// The clock of a view in a clip, against that of the clip's reference.
struct ViewClockEstimate {
  int clip = 0;
  std::string camera;
  ClockSource source = ClockSource::kReference;
  TimeMap time;  ///< from the view's own frames to those of the clip
  /// The view's frame 0 shows what the reference shows so much after its own frame 0.
  double offset_seconds = 0.0;
  double deviation_seconds = 0.0;  ///< standard deviation of the offset, where it was found
  double evidence = 0.0;           ///< of 1., in standard deviations
  double runner_up = 0.0;          ///< error of the best other candidate, relative; 0 where there is none
  std::string reason;              ///< kUnknown: why, in words that follow the camera's name
};

struct Synchronisation {
  std::vector<ViewClockEstimate> clocks;    ///< of all views of the clips that were looked at
  std::vector<std::vector<TimeMap>> times;  ///< (clips, V) identity where nothing was done
  std::string failure;                      ///< why it cannot be solved; empty where it can

  [[nodiscard]] const ViewClockEstimate* Find(int clip, std::string_view camera) const;
};

/// How much later than the others cameras began, by name, in seconds: given rather than found.
using GivenOffsets = std::map<std::string, double>;

/// Parses "cam3=1.25". Throws Error(kInvalidArgument).
std::pair<std::string, double> ParseOffset(const std::string& text);

/// Whether any clip of a capture needs Synchronise().
bool NeedsSynchronising(const CaptureObservations& capture, const GivenOffsets& given);

/// Brings the views of every clip to one time, that of a view of the clip: what they show in `capture` is resampled
/// there (view_resampling.h), and views that are not placed are emptied. Clips whose frames belong together
/// (FrameTiming::kCommon) stay as they are, unless an offset is given.
Synchronisation Synchronise(CaptureObservations& capture, const GivenOffsets& given,
                            const Calibrate& calibrate_quickly);

}  // namespace canonpose
