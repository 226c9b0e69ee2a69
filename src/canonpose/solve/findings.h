// What was found wrong with the cameras of a capture, for the report.
#pragma once

#include <string>
#include <vector>

#include "canonpose/solve/camera_check.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Something that was wrong with a camera, and what was done about it.
struct CameraFinding {
  std::string camera;
  int clip = 0;  ///< of the capture
  /// "mirrored", "sides-exchanged", "image-size", "frame-rate", "backwards", "camera-moved", "frames-lost" or
  /// "does-not-fit".
  std::string kind;
  int first_frame = 0;     ///< in the camera's own frames of the clip
  int frames = 0;          ///< how many are concerned
  bool corrected = false;  ///< otherwise these frames are left out
  std::string text;        ///< one line, with the camera's name
};

/// Shifts in time are not among them: CaptureReport::offsets has them.
std::vector<CameraFinding> MakeFindings(const CaptureObservations& capture, const CameraCheck& check);

}  // namespace canonpose
