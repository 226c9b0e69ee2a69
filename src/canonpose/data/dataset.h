// The dataset in memory: synchronised 2D keypoints of one person from several cameras, and what else is known.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "canonpose/geometry/camera.h"
#include "canonpose/scene/pose_sequence.h"
#include "canonpose/scene/provenance.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// One person as far as one camera alone can follow them: a track of that camera. Which tracks of other cameras are the
/// same person is not known.
struct CameraTrack {
  std::string id;                 ///< of this camera's tracks; says nothing about those of other cameras
  std::vector<float> keypoints;   ///< (T, J, 2) pixels, origin top left; NaN where not detected
  std::vector<float> confidence;  ///< (T, J) 0..1; 0 where not detected
};

/// What one camera of a sequence saw. T frames, J joints; all arrays row-major.
struct CameraView {
  std::string name;
  std::array<int, 2> image_size{0, 0};  ///< width, height in pixels
  std::vector<float> keypoints;         ///< (T, J, 2) pixels, origin top left; NaN where not detected
  std::vector<float> confidence;        ///< (T, J) 0..1; 0 where not detected
  /// What `solve` found that its clock differs by: its frame at time t shows what the other cameras show at this much
  /// more. `keypoints` and poses stay in the camera's own time.
  double time_offset_seconds = 0.0;
  /// Where `solve` found that its frames are not simply so much earlier or later (another frame rate, played backwards,
  /// frames lost): (T) the frame of the sequence, in the other cameras' time, that each of its frames shows; NaN where
  /// it was left out. Otherwise empty.
  std::vector<double> solved_frames{};
  /// Poses in the frame of this camera; empty where there are none. Their fps and the person's name are left to the
  /// Sequence.
  PoseSequence truth;  ///< in millimetres
  PoseSequence
      solved;  ///< as `solve` finds them: with uncertainties, in millimetres if it knew a size, or body lengths
  /// The cameras that `solve` found, one or T as in `calibration`. Their translations are in the unit of `solved`:
  /// `solved` in camera c is R_c x_in_world + t_c, and K projects it to pixels. Their world is as in scene/scene.h;
  /// Sequence::solved_world says what is known of it. Empty where there are none.
  std::vector<Camera> solved_calibration;
  /// Calibration, for evaluation only: one camera, or T of them for a moving camera, in millimetres; empty where there
  /// is none.
  std::vector<Camera> calibration;

  /// Of several people, where it is not known yet who is who across the cameras; `keypoints` then shows nobody.
  std::vector<CameraTrack> tracks{};

  [[nodiscard]] const Camera& CalibrationAt(int frame) const {
    return calibration.size() == 1 ? calibration.front() : calibration[static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] const Camera& SolvedCalibrationAt(int frame) const {
    return solved_calibration.size() == 1 ? solved_calibration.front()
                                          : solved_calibration[static_cast<std::size_t>(frame)];
  }
};

/// Poses (T, J, 3) in millimetres in the frame of `camera`, for CameraView::truth; none where there are no positions.
PoseSequence TruthPoses(const Skeleton& skeleton, std::vector<float> positions, const std::string& camera);

/// Whether joints of CameraView::solved are known, but the uncertainty of none of them.
bool LacksUncertainty(const PoseSequence& solved);

/// Whether the n-th frames of a sequence's cameras show the same moment.
enum class FrameTiming {
  kCommon,  ///< they do, but for what `solve` notices
  kUnsure,  ///< the recordings differ in length or rate, so that they may have begun at different times
  kOwn,     ///< they do not: every camera counts from its own first frame
};

/// T synchronised frames of one person from the same cameras, or of several people, not yet told apart
/// (CameraView::tracks).
struct Sequence {
  std::string name;
  std::string subject;
  double fps = 0.0;  ///< 0 where unknown
  bool static_cameras = true;
  std::string capture;  ///< sequences with the same capture share their cameras; never empty
  int frame_count = 0;
  std::vector<CameraView> cameras;
  bool capture_is_named = true;        ///< false where the file names none; then no other file has the same cameras
  std::vector<std::string> actions{};  ///< what the person does, for protocols that report it; empty where unknown
  std::vector<std::uint8_t> action{};  ///< (T) index into `actions`; empty: all frames are the first one
  std::string truth_kind{};  ///< which of a benchmark's annotations `truth` comes from, "univ_annot3"; may be empty
  WorldProvenance solved_world{};  ///< what is known of the world of the solved cameras
  FrameTiming timing = FrameTiming::kCommon;
  /// People who were filmed together, each of whom is a sequence: the same time and the same world. Empty where the
  /// person is alone.
  std::string scene{};

  /// Whether the cameras have tracks of several people rather than keypoints of one person.
  [[nodiscard]] bool HasTracks() const;
};

/// Where the keypoints came from, so that a model can read the same kind of file later. Empty for datasets that were
/// not written by this program.
struct DatasetSource {
  std::string format;                ///< "openpose", ...
  std::string layout;                ///< the detector's layout, "body_25b"
  double confidence_scale = 1.0;     ///< what confidences were divided by
  std::vector<std::string> mapping;  ///< (J) LayoutMapping::DescribeAll()
  std::string morph{};               ///< the morphing network that the keypoints went through; empty: none
};

struct Dataset {
  Skeleton skeleton;
  DatasetSource source;
  std::vector<Sequence> sequences;

  [[nodiscard]] bool HasTruth() const;
  [[nodiscard]] bool HasSolved() const;
  [[nodiscard]] bool HasCalibration() const;
  /// A hash of skeleton, keypoints and confidences, which is all that training without labels uses.
  [[nodiscard]] std::uint64_t Fingerprint() const;
};

/// Which frames of a view show what the sequence's frames do, by its time offset or its `solved_frames`.
class ViewClock {
 public:
  ViewClock(const Sequence& sequence, const CameraView& view);
  /// The view's own frame that shows what the other cameras show in `frame`, which may lie outside of the sequence; -1
  /// where none is as near as 0.25 frames, or it was left out. Where the view has about the rate of the others, as with
  /// a constant offset, it is the nearest one.
  [[nodiscard]] int OwnFrame(int frame) const;
  /// What the view's own frame shows, in frames of the sequence, between them where the clocks differ by fractions; NaN
  /// where it was left out.
  [[nodiscard]] double TimeOf(int own) const;
  /// The frames of the sequence, or outside of it, in which the first and the last of the view's own ones are.
  [[nodiscard]] int first_frame() const { return own_.empty() ? offset_ : 0; }
  [[nodiscard]] int last_frame() const { return own_.empty() ? count_ - 1 + offset_ : count_ - 1; }

 private:
  /// How far from a frame of the sequence its own one may be.
  [[nodiscard]] double SameMoment(int own) const;

  int count_ = 0;
  double shift_ = 0.0;  ///< frames
  int offset_ = 0;      ///< the same, whole
  std::vector<double> solved_frames_;
  std::vector<int> own_;  ///< (T) or empty: offset_ says all
};

/// First and last frame, both inclusive, counted from 0.
struct FrameRange {
  int first = 0;
  int last = INT32_MAX;
  /// Parses "A-B", "A-" or "A". Throws Error(kInvalidArgument).
  static FrameRange Parse(const std::string& text);
  /// Throws Error(kBadInput) that names `file` where the range begins within `frame_count` frames and ends beyond them.
  void RequireLast(int frame_count, const std::string& file) const;
};

/// Keeps only the frames first, first + step, ... up to `last`, which the sequence must have; none where `first` is
/// after `last`.
void KeepFrames(Sequence& sequence, int first, int last, int step = 1);

/// Keeps only the frames of `range` in every sequence; sequences left without frames are removed. Throws
/// Error(kBadInput) where no sequence remains, or the range ends beyond the longest sequence.
void KeepFrames(Dataset& dataset, const FrameRange& range, const std::string& file);

/// Whether whoever reads a dataset can do something with tracks of several people.
enum class TracksInDataset { kRefused, kAllowed };

/// Reads a dataset file of version 1 or 2 (layout in docs/dataset.md), whether written by this program or by others
/// with h5py. Throws Error(kBadInput), also where `tracks` says so and there are any.
Dataset ReadDataset(const std::filesystem::path& path, TracksInDataset tracks = TracksInDataset::kRefused);

/// Whether `path` is an HDF5 file that says it is a dataset.
bool IsDatasetFile(const std::filesystem::path& path);

/// Throws Error(kInvalidArgument) where the name of a dataset to be written says that it is another kind of file: it
/// must end in .h5 or .hdf5, or have no extension. To be called before any work is done.
void RequireDatasetName(const std::filesystem::path& path);

/// Writes a dataset file sequence by sequence, so that a large one need not be in memory as a whole.
class DatasetWriter {
 public:
  /// Throws Error(kBadInput) where `path` cannot be written.
  /// `tracks` says whether sequences with tracks may be added, which makes it a file of version 2.
  DatasetWriter(const std::filesystem::path& path, const Skeleton& skeleton, const DatasetSource& source = {},
                TracksInDataset tracks = TracksInDataset::kRefused);
  ~DatasetWriter();
  void Add(const Sequence& sequence);
  /// Moves the finished file into place.
  void Commit();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

void WriteDataset(const std::filesystem::path& path, const Dataset& dataset);

}  // namespace canonpose
