// What the solver reports of its result.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/scene/pose_sequence.h"
#include "canonpose/scene/provenance.h"
#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/findings.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"
#include "canonpose/solve/synchronisation.h"
#include "canonpose/solve/windows.h"

namespace canonpose {

/// What was found about a camera of a capture.
struct CameraReport {
  std::string name;
  double focal_px = 0.0;  ///< the median over frames, where it changes
  /// How far outwards its lens moves a point that it would show in the image's corner without distortion; negative:
  /// inwards; 0 where no distortion was found.
  double corner_shift_px = 0.0;
  double reprojection_percent = 0.0;  ///< median error of keypoints, in percent of the sum of bone lengths
  double outlier_percent = 0.0;       ///< of keypoints, those off by more than five times their usual scatter
  bool used = true;
  std::string why_not_used;  ///< empty where unknown
};

/// A camera whose clock was off in a clip: its frame n was taken to show what the others show in frame n + frames.
struct OffsetReport {
  int clip = 0;  ///< of the capture
  std::string camera;
  int frames = 0;
};

struct CaptureReport {
  std::string name;
  bool static_cameras = true;
  std::vector<CameraReport> cameras;
  int frames = 0;
  int frames_solved = 0;             ///< with a pose in at least one view
  int frames_too_few_views = 0;      ///< not solved since fewer than two cameras saw the person
  int frames_unseen = 0;             ///< of these, in which no camera did: the person may not have been there
  int frames_in_failed_windows = 0;  ///< seen well enough, but not solved: see `windows`
  double reprojection_percent = 0.0;
  double largest_view_angle_deg = 0.0;  ///< between the viewing directions of two cameras
  /// "kept", "flipped", "undecided, kept as in the start's poses", "kept by request" or "flipped by request"; the
  /// start's poses are what is kept or flipped.
  std::string mirror;
  double mirror_sigma = 0.0;  ///< standard errors by which the solution explains the keypoints better than its mirror
  /// Undecided, and the start's poses do not say which way round depth is either (StartPoses::knows_depth_sign).
  bool mirror_is_a_guess = false;
  int swaps_corrected = 0;  ///< frames, summed over cameras, in which left and right were exchanged
  std::vector<OffsetReport> offsets;
  std::vector<ViewClockEstimate> clocks;  ///< of clips whose cameras were not synchronised, or whose offsets are given
  std::vector<CameraFinding> findings;
  WorldProvenance world;                         ///< what is known of the world that the result is in
  LengthUnit unit = LengthUnit::kBodyLengths;    ///< of the result
  std::vector<std::string> unseen_joints;        ///< that no camera ever sees; they are not in the result
  std::optional<AdjustmentSummary> calibration;  ///< of the cameras; empty where it was not tried
  std::optional<WindowsSummary> windows;         ///< of all frames; empty where they were not tried
  bool agrees_poorly = false;  ///< keypoints and bones are so far off that the cameras may show different things
  std::vector<std::string> warnings;
  std::string failure;  ///< why the capture could not be solved; empty where it was

  /// One sentence for people who have not read the rest: whether the result can be relied on, and if not, why.
  [[nodiscard]] std::string Trust() const;
  /// Why nothing in the result can be relied on: there are three cameras or more, and so many keypoints of half of them
  /// do not fit that nothing says which of the cameras are wrong. Fewer suffice where the cameras agree poorly. Empty
  /// otherwise.
  [[nodiscard]] std::string Contradiction() const;
};

/// Somebody whom several cameras were found to show, and who is a sequence of the result.
struct PersonReport {
  std::string name;  ///< of the sequence
  int frames = 0;    ///< in which two cameras or more show the person
  std::vector<std::pair<std::string, int>> frames_of_camera;
  double reprojection_percent = 0.0;  ///< mean error of keypoints, in percent of the sum of bone lengths
  /// Share of the places in which a camera shows the person that nobody else in its image could take.
  double sure_percent = 0.0;
};

/// Who is who in a recording of several people.
struct PeopleReport {
  std::string scene;
  int frames = 0;
  std::vector<PersonReport> people;   ///< the most prominent first
  std::vector<std::string> left_out;  ///< what was not taken for a person, one line each
  double explained_percent = 0.0;     ///< of what the cameras' detector found, those that are somebody of `people`
};

struct SolveReport {
  std::vector<CaptureReport> captures;
  /// Of recordings of several people; set by whoever told them apart.
  std::vector<PeopleReport> people{};
  /// Why the poses of some captures cannot be believed although they are solved, and what to do about it: which way
  /// round depth is remained a guess. Empty where nothing speaks against them.
  [[nodiscard]] std::string Doubt() const;
  /// A table for people.
  [[nodiscard]] std::string ToText() const;
  [[nodiscard]] std::string ToJson() const;
};

CaptureReport MakeReport(const CaptureObservations& capture, const Solution& solution, const WindowsSummary& windows,
                         const std::string& mirror_option);

}  // namespace canonpose
