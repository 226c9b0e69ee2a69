#include "canonpose/solve/findings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace canonpose {
namespace {

std::string KindOf(const ViewReading& reading) {
  if (reading.is_mirrored) return "mirrored";
  if (reading.sides_are_exchanged) return "sides-exchanged";
  if (reading.time.rate != 1.0) return "frame-rate";
  return "";
}

/// " in clip 2"; nothing where there is only one.
std::string InClip(const CaptureObservations& capture, int clip) {
  return capture.clips.size() > 1 ? fmt::format(" in clip {}", clip + 1) : "";
}

CameraFinding DescribeStretch(const CaptureObservations& capture, int clip, const std::string& camera,
                              const BadStretch& stretch) {
  CameraFinding finding{camera, clip, "does-not-fit", stretch.first, stretch.count, false, ""};
  const int last = stretch.first + stretch.count - 1;
  const std::string frames = fmt::format("frames {} to {}{}", stretch.first, last, InClip(capture, clip));
  switch (stretch.fault) {
    case StretchFault::kCameraMoved:
      finding.kind = "camera-moved";
      finding.text = fmt::format("{} was moved at frame {}: its {} are left out", camera,
                                 stretch.first > 0 ? stretch.first : last + 1, frames);
      break;
    case StretchFault::kTimeJump:
      finding.kind = "frames-lost";
      finding.corrected = true;
      finding.text = fmt::format("{} jumps by {} frames in time at frame {}: its {} are taken at the others' time",
                                 camera, stretch.jump_frames, stretch.first, frames);
      break;
    case StretchFault::kOther:
      finding.text = fmt::format(
          "{} does not fit the other cameras in its {}: another person, or wrong keypoints? They are left out", camera,
          frames);
      break;
  }
  return finding;
}

}  // namespace

std::vector<CameraFinding> MakeFindings(const CaptureObservations& capture, const CameraCheck& check) {
  std::vector<CameraFinding> findings;
  for (std::size_t v = 0; v < capture.cameras.size(); ++v) {
    const std::string& camera = capture.cameras[v].name;
    const std::array<int, 2>& size = capture.cameras[v].image_size_px;
    if (size != capture.cameras[v].declared_size_px) {
      findings.push_back(
          {camera, 0, "image-size", 0, capture.frame_count, true,
           fmt::format("{} has keypoints of images of {} x {} pixels: corrected", camera, size[0], size[1])});
    }
    if (check.dropped[v]) {
      findings.push_back({camera, 0, check.dropped_as[v], 0, capture.frame_count, false,
                          fmt::format("{} {}: it is left out", camera, check.why_dropped[v])});
      continue;
    }
    for (std::size_t c = 0; c < capture.clips.size(); ++c) {
      const int clip = static_cast<int>(c);
      const ViewCorrection& correction = check.corrections[c][v];
      const std::string kind = KindOf(correction.reading);
      if (!kind.empty()) {
        findings.push_back({camera, clip, kind, 0, capture.clips[c].count, true,
                            fmt::format("{} {}{}: corrected", camera,
                                        Describe(correction.reading, capture.clips[c].fps), InClip(capture, clip))});
      }
      for (const BadStretch& stretch : correction.bad) {
        findings.push_back(DescribeStretch(capture, clip, camera, stretch));
      }
    }
  }
  return findings;
}

}  // namespace canonpose
