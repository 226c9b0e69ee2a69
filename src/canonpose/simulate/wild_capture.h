// A capture for training a lifter for any person: procedural people in all kinds of poses, seen from everywhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/wild_motion.h"

namespace canonpose {

struct WildCaptureOptions {
  int clips = 1000;          ///< each with a different person
  int frames = 40;           ///< of a clip
  double fps = 4.0;          ///< low, since similar neighbouring frames add little
  int cameras = 4;           ///< of a clip, each circling around the person from a random position
  double off_centre = 1.0;   ///< how far the person is from the centre of the image; 1: anywhere in it
  double wild_share = 0.85;  ///< fraction of the clips; the others show unchanged activities
  double mixed_share = 0.3;  ///< fraction of the wild clips whose upper and lower bodies perform different activities
  WildOptions wild;
  DetectorOptions detector;  ///< each clip has its own detector
  /// How much confidences differ from the simulated detector's: in each clip they are raised to a power between 1 and 1
  /// + this, or its inverse. In one clip of five, all joints that are found have confidence 1.
  double confidence_spread = 1.0;
  /// The detector's layout: a built-in or a benchmark's skeleton by name, whose joints are mapped to the skeleton in
  /// the same way as by `import`. Empty: the detector finds the skeleton's joints.
  std::string layout;
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: as many as the machine has cores; the result does not depend on it
};

/// Whether the joints are those of a person: the simulator must know the root, the hips, knees, shoulders and elbows of
/// both sides, and two thirds of all joints by name.
bool IsKnownPerson(const Skeleton& skeleton);
/// (J) 1 for each joint that the simulator knows.
std::vector<std::uint8_t> KnownJointsOf(const Skeleton& skeleton);

/// Clip `number` of the capture, with truth and without calibration. Joints that the simulator does not know are never
/// detected and have no truth. The same options and number give the same bits. Throws Error(kBadInput) where
/// IsKnownPerson() is false or the layout cannot be mapped to the skeleton, Error(kInvalidArgument) for an unknown
/// layout.
Sequence MakeWildClip(const Skeleton& skeleton, const WildCaptureOptions& options, int number);

/// All clips, made by several threads, with progress.
Dataset MakeWildCapture(const Skeleton& skeleton, const WildCaptureOptions& options);

}  // namespace canonpose
