// When each camera began, as far as motion tells that does not depend on the view: several answers, the likeliest
// first. Motion that repeats itself, such as walking, has many; reprojection decides between them (synchronisation.h).
#pragma once

#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

struct ClockSearch {
  /// Whether the cameras' frames are equally far apart in time. Otherwise the usual ratios of frame rates are tried.
  bool rates_are_equal = true;
  /// By how much a view's frame 0 is later than the reference's, in frames (V); NaN: to be found.
  std::vector<double> known_offsets{};
  double min_overlap_seconds = 5.0;
  int candidates = 6;
  bool as_recorded = false;  ///< also answer that all views begin together, however unlikely that is
};

/// One answer for one clip.
struct ClockCandidate {
  int root = 0;                  ///< the view whose time is that of the others
  std::vector<TimeMap> times;    ///< (V) from a view's own frames to those of the root
  std::vector<double> evidence;  ///< (V) how much more alike the views' motion is than by chance, standard deviations
  double score = 0.0;            ///< the sum of it over pairs of views
};

/// At most ClockSearch::candidates answers, the likeliest first, and one more for `as_recorded`; none where fewer than
/// two views show anything. A view that shows nothing keeps its own time, with evidence 0.
std::vector<ClockCandidate> FindClockCandidates(const CaptureObservations& capture, int clip,
                                                const ClockSearch& search);

}  // namespace canonpose
