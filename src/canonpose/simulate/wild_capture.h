// A capture to train a lifter on that knows no one: procedural people in every pose, seen from everywhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/wild_motion.h"

namespace canonpose {

struct WildCaptureOptions {
  int clips = 1000;          ///< each of a person of its own
  int frames = 40;           ///< of a clip
  double fps = 4.0;          ///< low: neighbouring frames teach the same
  int cameras = 4;           ///< of a clip, each circling around the person from anywhere
  double off_centre = 1.0;   ///< how far from the middle of the picture the person is: 1 anywhere in it
  double wild_share = 0.85;  ///< of the clips; the others move as the activities have it
  double mixed_share = 0.3;  ///< of the wild clips: upper and lower body of different activities
  WildOptions wild;
  DetectorOptions detector;  ///< each clip has a detector of its own
  /// How far confidences are from the simulated detector's: in a clip each is taken to a power of 1 to 1 + this or its
  /// inverse. In one clip of five all joints that are found have confidence 1.
  double confidence_spread = 1.0;
  /// The detector's layout, a built-in or a benchmark's skeleton by name, whose joints are mapped onto the skeleton as
  /// `import` maps them. Empty: the detector finds the skeleton's own joints.
  std::string layout;
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: as many as the machine has cores; the result does not depend on it
};

/// Whether the joints are those of a person that the simulator knows by name: the root, the hips, knees, shoulders and
/// elbows of both sides, and two thirds of all joints.
bool IsKnownPerson(const Skeleton& skeleton);
/// (J) 1 for each joint that the simulator knows.
std::vector<std::uint8_t> KnownJointsOf(const Skeleton& skeleton);

/// Clip `number` of the capture, with truth and without calibration. Joints that the simulator does not know are never
/// detected and have no truth. The same bits for the same options and number. Throws Error(kBadInput) where
/// IsKnownPerson() is false or the layout cannot be mapped onto the skeleton, Error(kInvalidArgument) for an unknown
/// layout.
Sequence MakeWildClip(const Skeleton& skeleton, const WildCaptureOptions& options, int number);

/// All clips, made by several threads; with progress.
Dataset MakeWildCapture(const Skeleton& skeleton, const WildCaptureOptions& options);

}  // namespace canonpose
