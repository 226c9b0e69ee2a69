// The protocols of the field's benchmarks: which poses are compared, and how their errors become one figure. Everything
// that distinguishes one protocol from another is a value here, so that a figure can always be printed with what it
// means.
//
// Published sources differ. This is what was chosen, and why:
//
// clang-format off
//   h36m     Subjects S9 and S11, and of each sequence the first frame and every 64th after it: CanonPose (Wandt et
//            al., CVPR 2021) evaluates every 64th frame, and code that uses this step counts from the first (Moon et
//            al., ICCV 2019). Martinez et al. (ICCV 2017) and Pavllo et al. (CVPR 2019) first take the mean of every
//            action over both subjects and all cameras, where "Walking" and "Walking 1" are one action, and then the
//            mean over actions: so do we. Others take the mean over poses; the JSON report has it as `by_pose`.
//   3dhp     The script of MPI-INF-3DHP (Mehta et al., 3DV 2017; mpii_test_predictions.m, mpii_evaluate_errors.m,
//            mpii_compute_3d_pck.m): poses are centred on the pelvis and compared with univ_annot3, the poses on a
//            skeleton of one size; PCK at 150 mm and AUC over 0, 5, ..., 150 mm of 14 joints (its first list of joints
//            also had pelvis, spine and head centre; in the list that is used they are commented out); MPJPE of all 17;
//            in its row "All" every valid frame of all six sequences has the same weight. The script does not scale.
//            Methods without labels do not know scale, so theirs are scaled first (Rhodin et al., CVPR 2018); here
//            every method is.
//   skipose  All rows of the test part, a mean over poses; CanonPose reports N-MPJPE, PMPJPE, PCK at 150 mm and CPS.
// clang-format on
//
// Only for Human3.6M do the subjects show which part of a benchmark a dataset holds; for the other two, pass the test
// part. CanonPose's own evaluation code was not published, so only its paper describes it.
#pragma once

#include <string>
#include <vector>

namespace canonpose {

/// The figure by which a protocol's results are usually ranked; all figures are always reported.
enum class Headline { kNMpjpe, kPMpjpe, kPck };

/// What has equal weight in a mean.
enum class Weighting {
  kPoses,      ///< every pose, or for errors of joints every joint of every pose
  kSequences,  ///< every sequence: the mean over sequences of the means of each
  kActions,    ///< every action, likewise
};

/// What counts as a correct joint.
struct PckRule {
  double threshold_mm = 150.0;
  /// Each joint by its possible names, the least ambiguous first: names of a joint, or of a part of the body
  /// (FindPart()). Empty: all joints that are used.
  std::vector<std::vector<std::string>> joints;
};

struct Protocol {
  std::string name;                   ///< value of the option `protocol`
  std::string summary;                ///< one line, for lists
  std::vector<std::string> subjects;  ///< that are evaluated; empty: all
  int first_frame = 0;                ///< of a sequence, counted from 0
  int frame_step = 1;                 ///< between evaluated frames
  Headline headline = Headline::kNMpjpe;
  PckRule pck;
  Weighting weighting = Weighting::kPoses;
  bool merge_takes = false;  ///< "Walking 1" is the action "Walking"
  std::string benchmark;     ///< whose protocol it is; empty: anybody's
  /// The formats (DatasetSource::format) in which that benchmark's data are imported.
  std::vector<std::string> formats;
  std::string truth_kind;  ///< the kind of truth for which it is defined ("univ_annot3"); empty: any
};

/// The default: every frame of every subject, with equal weights for all poses.
inline constexpr const char* kAllFrames = "all-frames";

/// All protocols, the default first.
const std::vector<Protocol>& Protocols();

/// A protocol by name. Throws Error(kInvalidArgument) that lists the protocols, one per line, if there is none.
const Protocol& FindProtocol(const std::string& name);

/// The headline's name, such as "N-MPJPE", and its key in the evaluation's JSON.
std::string HeadlineName(const Protocol& protocol);
std::string HeadlineKey(const Protocol& protocol);

/// The key of PCK in the evaluation's JSON, such as "pck150_percent".
std::string PckKey(const Protocol& protocol);

/// Which poses are compared, in words: "frames 0, 64, 128, ... of every sequence and view of S9 and S11".
std::string PosesInWords(const Protocol& protocol);
/// What the means are over, in words.
std::string WeightingInWords(const Protocol& protocol);

/// All protocols with all of their values in words, one paragraph each.
std::string ProtocolList();
/// The same as JSON: {"protocols": [{name, summary, poses, truth_kind, pck {threshold_mm, joints}, means,
/// headline}]}, where truth_kind is null for any, joints are empty for all, and headline is the key of its figure.
std::string ProtocolListAsJson();

/// The action to which a pose with the action `action` is assigned.
std::string ActionOf(const Protocol& protocol, const std::string& action);

/// Whether `subject` is evaluated, ignoring case.
bool HasSubject(const Protocol& protocol, const std::string& subject);

}  // namespace canonpose
