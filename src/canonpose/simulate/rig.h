// Virtual cameras: where they are, how they follow the subject, and how their lenses distort.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/geometry/camera.h"
#include "canonpose/motion/landmarks.h"

namespace canonpose {

struct RigOptions {
  std::string kind = "studio";  ///< studio, ring, ptz, handheld, or the path of a JSON file
  int cameras = 0;              ///< 0: the default of the kind (studio 4, ring 8 to 14, ptz 6, handheld 4)
  /// How the cameras are spread around the subject: "even", or "opposite", "quarter" (over 90 degrees),
  /// "clustered" (over 30 degrees). Two that are spread evenly are opposite each other; a quarter suits two better.
  std::string spread = "even";
  /// Mean distance from the subject; 0: the kind's default. Focal lengths change in proportion, so that the subject
  /// keeps its size in the image and only the perspective changes.
  double distance_m = 0.0;
  double distortion = 0.0;  ///< strength of the lenses' distortion: 0 none, 1 that of a typical sports camera

  /// Throws Error(kBadInput) for an impossible number of cameras, Error(kInvalidArgument) that names the first other
  /// option out of its range. A rig file cannot be combined with the other options.
  void Validate() const;
  /// Whether the kind is the path of a file.
  [[nodiscard]] bool IsFile() const;
};

/// One camera of a rig over a clip.
struct FilmingCamera {
  std::string name;
  std::array<int, 2> image_size{0, 0};  ///< width, height
  std::vector<Camera> cameras;          ///< one, or one per frame where it moves or zooms
};

/// The cameras of one capture.
class Rig {
 public:
  virtual ~Rig() = default;
  [[nodiscard]] virtual bool is_static() const = 0;
  /// The cameras over a clip of the capture. Cameras that follow the subject do so with an operator's lag, overshoot
  /// and slow zooming, for which `rng` is used. Those of a static rig are the same for every clip.
  [[nodiscard]] virtual std::vector<FilmingCamera> Film(const LandmarkTrack& track, Rng rng) const = 0;
};

/// A rig for one capture: its cameras vary with `rng` (positions, angles, focal lengths, lenses). They are aimed at a
/// subject whose path is centred on the origin, with the ground at z = 0. Throws what RigOptions::Validate() does, and
/// Error(kBadInput) for a rig file that cannot be used.
///
///   studio    4 static cameras in the corners of a room, 4 to 6 m away, 1.3 to 1.8 m high, 1000x1000 pixels, focal
///             length about 1145 px (Human3.6M)
///   ring      8 to 14 static cameras all around, from 0.6 m high to the ceiling, from which they look down, 2 to 4 m
///             away, 2048x2048 pixels, focal length 1050 to 1500 px (MPI-INF-3DHP)
///   ptz       6 pan-tilt-zoom cameras, 10 to 60 m away, below and above the subject, that follow it and zoom so that
///             it fills 25 to 60 % of the image's height, 1920x1080 (SkiPose). Each stands beside the course, and
///             farther back if a clip comes closer than 60 % of its distance
///   handheld  4 people who walk around with phones, 3.4 to 5.6 m away, 1920x1080 or upright
///
/// A rig file is JSON (world z up, mm; camera x right, y down, z forward; x_in_camera = R * x_in_world + t):
///
///   {"cameras": [{"name": "left", "image_size": [1920, 1080], "K": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]],
///                 "R": [[..], [..], [..]], "t": [x, y, z], "distortion": [k1, k2, p1, p2]},
///                {"name": "right", "image_size": [1920, 1080], "position_m": [4, 0, 1.5], "look_at_m": [0, 0, 0.9],
///                 "focal_px": 1500, "roll_deg": 0}]}
///
/// distortion and roll_deg are optional. K, R and t may each be an array over frames; such arrays must have the same
/// length, which must be enough for every clip. Film() throws Error(kBadInput) where it is not.
std::unique_ptr<Rig> MakeRig(const RigOptions& options, Rng rng);

}  // namespace canonpose
