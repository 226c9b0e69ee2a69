// Simulates captures clip by clip: motion, filmed by virtual cameras and detected by a detector with errors.
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
  /// Motion capture files and folders with such files; empty: procedural people.
  std::vector<std::filesystem::path> motion_files;

  // Procedural people; ignored with files.
  std::vector<Activity> activities;  ///< used in turn for a subject's clips; empty: all but skiing
  int subjects = 4;
  int clips = 0;  ///< of each subject; 0: one per activity
  double seconds = 10.0;
  /// How many of the subjects are filmed together, each with an own sequence: subjects 1 to `people`, and so on. They
  /// stand apart, but walk into each other's way.
  int people = 1;

  /// 0: that of the file, or 50 for procedural people; frames of files are only dropped, never added.
  double fps = 0.0;
  RigOptions rig;
  DetectorOptions detector;
  std::string skeleton = "h36m-17";  ///< of the dataset
  /// The detector's layout, which is mapped to the skeleton in the same way as by `import`. Empty: the detector finds
  /// the skeleton's joints.
  std::string layout;
  std::uint64_t seed = 0;
  std::optional<std::uint64_t> detector_seed;  ///< of the detector's systematic offset; none: `seed`

  /// Throws Error(kInvalidArgument) for unknown names and strengths out of range, Error(kBadInput) for impossible
  /// counts, lengths and rates.
  void Validate() const;
};

/// One simulated clip.
struct SimulatedClip {
  Sequence sequence;                   ///< in the dataset's skeleton, with truth and calibration
  ArticulatedMotion motion;            ///< before it was placed in the rig
  LandmarkTrack track;                 ///< after
  std::vector<FilmingCamera> cameras;  ///< those of `sequence`
  std::vector<Detections> detections;  ///< one per camera, in the detector's layout
};

/// Makes the clips of a simulation. A clip depends only on the options and its number, so clips can be made in any
/// order and in parallel.
class Simulator {
 public:
  /// Throws Error for options or motion files that cannot be used.
  explicit Simulator(SimulationOptions options);

  [[nodiscard]] int clip_count() const { return static_cast<int>(clips_.size()); }
  [[nodiscard]] const Skeleton& skeleton() const { return skeleton_; }
  [[nodiscard]] const DetectorLayout& layout() const { return layout_; }
  [[nodiscard]] const Skeleton& layout_skeleton() const { return layout_.from_landmarks.target; }
  [[nodiscard]] DatasetSource source() const;

  /// Makes clip 0 .. clip_count() - 1. May be called from several threads at once. Throws Error(kBadInput) for a
  /// damaged motion file.
  [[nodiscard]] SimulatedClip Make(int clip) const;

 private:
  /// Where a clip's motion comes from: a file, or the recipe of a procedural clip.
  struct ClipSource {
    std::filesystem::path file;
    ProceduralClip procedural;
    std::string group;    ///< of people who are filmed together; empty: alone
    std::string scene;    ///< the clips of the group at one time
    double around = 0.0;  ///< where in the group's circle this one is, 0 to 1
  };

  void ListProceduralClips();
  [[nodiscard]] ArticulatedMotion LoadMotion(const ClipSource& source) const;
  [[nodiscard]] CameraView MakeView(const SimulatedClip& clip, const std::vector<Eigen::Vector3d>& joints_mm,
                                    std::size_t camera) const;

  SimulationOptions options_;
  Skeleton skeleton_;
  DetectorLayout layout_;
  std::shared_ptr<const Rig> rig_of_file_;             ///< nothing where every capture has its own rig
  std::optional<LayoutMapping> skeleton_from_layout_;  ///< nothing where they are the same
  std::vector<ClipSource> clips_;
};

/// The clips of a simulator in order; other threads make a few in advance.
class ClipStream {
 public:
  /// `threads` 0: as many as the machine has cores; at most 64.
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
