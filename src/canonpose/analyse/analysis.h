// What movement scientists compute from the poses of one person: joint angles, segment lengths, symmetry and foot
// contacts over time.
#pragma once

#include <string>
#include <vector>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// A quantity over time.
struct TimeSeries {
  std::string name;            ///< without spaces, as files and plots show it: "knee_flexion_l"
  std::string unit;            ///< "deg", "mm", "body lengths" or "" for a ratio
  std::vector<double> values;  ///< (T); NaN where it is unknown
};

/// When a foot stands on the floor: frames first to last, both inclusive.
struct FootContact {
  bool is_left = false;
  int first_frame = 0;
  int last_frame = 0;
};

struct Analysis {
  std::vector<TimeSeries> angles;           ///< degrees; docs/analysis.md defines each
  std::vector<TimeSeries> segment_lengths;  ///< in the unit of the poses
  std::vector<TimeSeries> symmetry;         ///< of each pair of segments and angles: (left - right) / mean, or left - right
  std::vector<FootContact> contacts;        ///< by first frame; empty where the floor or the feet are unknown
};

/// Of poses in any unit. Quantities whose joints the skeleton lacks are left out; those of single frames whose joints are
/// unknown are NaN. Angles that refer to the floor need poses in a world whose z points up.
Analysis Analyse(const PoseSequence& person, bool up_is_known);

}  // namespace canonpose
