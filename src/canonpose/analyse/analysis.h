// What movement scientists compute from the poses of one person: joint angles, segment lengths, symmetry and foot
// contacts over time. docs/analysis.md defines each.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// A quantity over time.
struct TimeSeries {
  std::string name;            ///< without spaces, as files and plots show it: "knee_angle_l"
  std::string unit;            ///< "deg", that of the poses (ToString(LengthUnit)), or "" for a ratio
  std::vector<double> values;  ///< (T); NaN where it is unknown
};

/// The series of that name; null where there is none.
const TimeSeries* FindSeries(const std::vector<TimeSeries>& series, std::string_view name);

/// When a foot stands on the floor: frames first to last, both inclusive.
struct FootContact {
  bool is_left = false;
  int first_frame = 0;
  int last_frame = 0;
};

struct Analysis {
  std::vector<TimeSeries> angles;           ///< degrees, without jumps of 360; names and signs are OpenSim's
  std::vector<TimeSeries> segment_lengths;  ///< in the unit of the poses
  std::vector<TimeSeries> symmetry;         ///< of each pair: (left - right) / mean of lengths, left - right of angles
  std::vector<FootContact> contacts;        ///< by first frame; empty where the floor or the feet are unknown
};

/// Of poses in any unit and frame. Quantities whose joints the skeleton lacks are left out; those of single frames
/// whose joints are unknown are NaN. Angles against the floor and contacts need `up_is_known`: poses in a world whose z
/// points up.
Analysis Analyse(const PoseSequence& person, bool up_is_known);

/// pelvis_tilt, pelvis_list and pelvis_rotation as OpenSim's models order them: tilt about the ground's z first, then
/// list, then rotation, in a ground that is our world with y up (x, z, -y). Analyse() turns about the vertical first,
/// so that tilt and list do not depend on where the person faces; a model that is posed by a file needs these. Needs
/// poses in a world whose z points up; empty where the skeleton has no hips and trunk.
std::vector<TimeSeries> OpenSimPelvis(const PoseSequence& person);

}  // namespace canonpose
