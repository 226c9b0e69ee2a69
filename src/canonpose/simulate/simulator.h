// A capture simulated: clips of motion, seen by virtual cameras, found by a detector that errs, clip by clip.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/motion/articulated_motion.h"
#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/procedural.h"
#include "canonpose/simulate/rig.h"

namespace canonpose {

struct SimulationOptions {
  /// Motion capture files and folders of them; none: procedural people.
  std::vector<std::filesystem::path> motion_files;

  // Procedural people; ignored with files.
  std::vector<Activity> activities;  ///< taken in turn by a subject's clips; none: all but skiing
  int subjects = 4;
  int clips = 0;  ///< of each subject; 0: one of each activity
  double seconds = 10.0;

  double fps = 0.0;  ///< 0: a file's own, 50 for procedural people; files are only ever thinned out
  RigOptions rig;
  DetectorOptions detector;
  std::string skeleton = "h36m-17";  ///< of the dataset
  /// The detector's layout, which is mapped onto the skeleton as `import` does. Empty: the detector finds the
  /// skeleton's own joints.
  std::string layout;
  std::uint64_t seed = 0;
  std::optional<std::uint64_t> detector_seed;  ///< of the detector's systematic offset; none: `seed`

  /// Throws Error(kInvalidArgument) for unknown names and strengths out of range, Error(kBadInput) for counts, lengths
  /// and rates that cannot be.
  void Validate() const;
};

/// One clip as it was simulated.
struct SimulatedClip {
  Sequence sequence;                   ///< in the dataset's skeleton, with truth and calibration
  ArticulatedMotion motion;            ///< before it was placed in the rig
  LandmarkTrack track;                 ///< after
  std::vector<FilmingCamera> cameras;  ///< those of `sequence`
  std::vector<Detections> detections;  ///< one a camera, in the detector's layout
};

/// Makes the clips of a simulation. Every clip depends on the options and its number alone, so they can be made in any
/// order and at the same time.
class Simulator {
 public:
  /// Throws Error for options or motion files that cannot be used.
  explicit Simulator(SimulationOptions options);

  [[nodiscard]] int clip_count() const { return static_cast<int>(clips_.size()); }
  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  [[nodiscard]] const DetectorLayout& layout() const { return layout_; }
  [[nodiscard]] const Skeleton& layout_skeleton() const { return layout_.from_landmarks.target; }
  [[nodiscard]] DatasetSource source() const;

  /// Clip 0 .. clip_count() - 1. May be called by several threads at a time. Throws Error(kBadInput) for a damaged
  /// motion file.
  [[nodiscard]] SimulatedClip Make(int clip) const;

 private:
  /// Where a clip's motion comes from: a file, or the recipe of a procedural clip.
  struct ClipSource {
    std::filesystem::path file;
    ProceduralClip procedural;
  };

  void ListProceduralClips();
  [[nodiscard]] ArticulatedMotion LoadMotion(const ClipSource& source) const;
  [[nodiscard]] CameraView MakeView(const SimulatedClip& clip, const std::vector<Eigen::Vector3d>& joints_mm,
                                    std::size_t camera) const;

  SimulationOptions options_;
  Skeleton skeleton_;
  DetectorLayout layout_;
  std::shared_ptr<const Rig> rig_of_file_;             ///< nothing where every capture has a rig of its own
  std::optional<LayoutMapping> skeleton_from_layout_;  ///< nothing where they are the same
  std::vector<ClipSource> clips_;
};

/// The clips of a simulator in order, made a few ahead by other threads.
class ClipStream {
 public:
  /// `threads` 0: as many as the machine has cores; 64 at most.
  ClipStream(const Simulator& simulator, int threads);
  /// The next clip; nothing after the last. Throws what making it threw.
  std::optional<SimulatedClip> Next();

 private:
  void Refill();

  const Simulator& simulator_;
  std::size_t ahead_;
  int started_ = 0;
  std::deque<std::future<SimulatedClip>> pending_;
};

}  // namespace canonpose
