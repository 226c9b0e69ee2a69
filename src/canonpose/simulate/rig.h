// Virtual cameras: where they stand, how they follow the subject, and what their lenses do.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/geometry/camera.h"
#include "canonpose/simulate/landmarks.h"

namespace canonpose {

struct RigOptions {
  std::string kind = "studio";  ///< studio, ring, ptz, handheld, or the path of a JSON file
  int cameras = 0;              ///< 0: as many as the kind has by itself (studio 4, ring 8 to 14, ptz 6, handheld 4)
  /// How the cameras are spread around the subject: "even", or "opposite", "quarter" (within 90 degrees), "clustered"
  /// (within 30 degrees). For studio, ptz and handheld rigs.
  std::string spread = "even";
  double distance_m = 0.0;  ///< mean distance from the subject; 0: the kind's own
  double distortion = 0.0;  ///< strength of the lenses' distortion: 0 none, 1 that of a usual sports camera

  /// Throws Error(kUsage) naming the first option that is out of range.
  void Validate() const;
};

/// What one camera of a rig is over a clip.
struct FilmingCamera {
  std::string name;
  std::array<int, 2> image_size{0, 0};  ///< width, height
  std::vector<Camera> cameras;          ///< one, or one a frame where it moves or zooms
};

/// The cameras of one capture.
class Rig {
 public:
  virtual ~Rig() = default;
  [[nodiscard]] virtual bool is_static() const = 0;
  /// The cameras over a clip of the capture. Cameras that follow the subject look at it with an operator's lag,
  /// overshoot and slow zooming; `rng` is for that. A static rig's are the same for every clip.
  [[nodiscard]] virtual std::vector<FilmingCamera> Film(const LandmarkTrack& track, Rng rng) const = 0;
};

/// A rig for one capture: its cameras differ with `rng` (positions, angles, focal lengths, lenses). Throws
/// Error(kBadInput) for a rig file that cannot be used.
///
///   studio    4 static cameras in the corners of a room, 4 to 6 m away, 1.3 to 1.8 m high, 1000x1000 pixels, focal
///             length about 1145 px (Human3.6M)
///   ring      8 to 14 static cameras all around at several heights, some at the ceiling looking down, 2048x2048 pixels
///             (MPI-INF-3DHP)
///   ptz       6 pan-tilt-zoom cameras, 10 to 60 m away, that follow the subject and zoom so that it fills a given
///   share
///             of the picture (SkiPose)
///   handheld  4 people who walk around with cameras, 3 to 6 m away
std::unique_ptr<Rig> MakeRig(const RigOptions& options, Rng rng);

}  // namespace canonpose
