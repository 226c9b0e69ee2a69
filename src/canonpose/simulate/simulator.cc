#include "canonpose/simulate/simulator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/base/random.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/motion_files.h"

namespace canonpose {
namespace {

constexpr double kProceduralFps = 50.0;
/// A clip is kept in memory as a whole (about 5 kB per frame and camera).
constexpr int kMaxFramesPerClip = 100000;
/// Every thread keeps a clip in memory.
constexpr std::size_t kMaxThreads = 64;
constexpr int kMaxClips = 1000000;
constexpr double kLowestFps = 0.1;

/// What a generator is for, as its first stream number.
enum Stream : std::uint64_t {
  kRigStream = 1,
  kPlacement = 2,
  kFilming = 3,
  kDetection = 4,
  kPerson = 5,
  kMotion = 6,
  kGroup = 7
};

std::uint64_t NumberOf(const std::string& name) {
  Fingerprint fingerprint;
  fingerprint.Add(name);
  return fingerprint.value();
}

void RequireNumber(bool ok, const char* option, const char* expected, double found) {
  if (!ok) {
    throw Error(ErrorKind::kBadInput, fmt::format("{}: expected {}, found {:g}", option, expected, found));
  }
}

const Skeleton& RequireSkeleton(const std::string& name, const char* option) {
  const Skeleton* skeleton = FindSkeleton(name);
  if (skeleton == nullptr) {
    ThrowInvalidArgument("{}: expected one of {}, found \"{}\"", option, BuiltinSkeletonNames(), name);
  }
  return *skeleton;
}

/// The same name for all clips that the same static cameras film, even in different files.
std::string CaptureName(const std::string& subject, const std::vector<FilmingCamera>& cameras) {
  Fingerprint fingerprint;
  const auto add = [&](const auto& numbers) { fingerprint.Add(numbers.data(), sizeof(numbers[0]) * numbers.size()); };
  for (const FilmingCamera& filming : cameras) {
    const Camera& camera = filming.cameras.front();
    fingerprint.Add(filming.name);
    add(filming.image_size);
    add(camera.K.reshaped());
    add(camera.camera_from_world_rotation.reshaped());
    add(camera.camera_from_world_translation);
    // k3 was added later; cameras without it keep the names that they had before.
    add(std::span(camera.distortion).first(camera.distortion[4] != 0.0 ? 5 : 4));
  }
  return fmt::format("{}-{:016x}", subject, fingerprint.value());
}

/// A dataset's sequences are named after the files.
void RequireDifferentNames(const std::vector<std::filesystem::path>& files) {
  std::map<std::string, std::filesystem::path> by_name;
  for (const std::filesystem::path& file : files) {
    const auto [earlier, is_new] = by_name.try_emplace(file.stem().string(), file);
    if (file.stem() == "." || file.stem() == "..") {
      ThrowBadInput({file.string(), "", "a file with a name before its extension", "none", "rename it"});
    }
    if (is_new) continue;
    ThrowBadInput({file.string(), "", "files of different names",
                   fmt::format("one with the same name as {}", earlier->second.string()),
                   "rename one, or simulate them separately"});
  }
}

/// Keeps the frames that are nearest to those of a lower frame rate.
void ThinOut(ArticulatedMotion& motion, double fps) {
  if (fps <= 0.0 || fps >= motion.fps) return;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  const auto frames = static_cast<std::size_t>(motion.frame_count());
  ArticulatedMotion thin = motion;
  thin.fps = fps;
  thin.root_position_mm.clear();
  thin.parent_from_joint.clear();
  for (std::size_t n = 0;; ++n) {
    const auto t = static_cast<std::size_t>(std::lround(static_cast<double>(n) * motion.fps / fps));
    if (t >= frames) break;
    thin.root_position_mm.push_back(motion.root_position_mm[t]);
    const auto first = motion.parent_from_joint.begin() + static_cast<std::ptrdiff_t>(t * joints);
    thin.parent_from_joint.insert(thin.parent_from_joint.end(), first, first + static_cast<std::ptrdiff_t>(joints));
  }
  motion = std::move(thin);
}

/// Rotates the track to a random heading and moves the middle of its path near the origin, without changing its height.
void Place(LandmarkTrack& track, Rng rng) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (int t = 0; t < track.frame_count(); ++t) {
    low = low.cwiseMin(track.At(t, kHip).head<2>());
    high = high.cwiseMax(track.At(t, kHip).head<2>());
  }
  constexpr double kOffsetMm = 400.0;
  const Eigen::Vector2d middle = (low + high) / 2;
  const Eigen::Rotation2Dd heading(rng.Uniform(0.0, 2.0 * M_PI));
  const Eigen::Vector2d offset(rng.Uniform(-kOffsetMm, kOffsetMm), rng.Uniform(-kOffsetMm, kOffsetMm));
  for (Eigen::Vector3d& point : track.positions_mm) {
    point.head<2>() = heading * (point.head<2>() - middle) + offset;
  }
}

/// Moves somebody of a group to a place in its circle, a fraction of a turn from its first, at a random distance from
/// the middle.
void PlaceInGroup(LandmarkTrack& track, double around, Rng rng) {
  constexpr double kNearestMm = 900.0;
  constexpr double kFarthestMm = 1900.0;
  constexpr double kTurns = 0.05;
  const double distance_mm = rng.Uniform(kNearestMm, kFarthestMm);
  const double angle = 2.0 * M_PI * (around + rng.Uniform(-kTurns, kTurns));
  const Eigen::Vector2d offset(distance_mm * std::cos(angle), distance_mm * std::sin(angle));
  for (Eigen::Vector3d& point : track.positions_mm) point.head<2>() += offset;
}

/// Joint positions (T, K, 3) in a camera's frame, mapped to the skeleton like keypoints: float32 (T, J, 3).
std::vector<float> TruthInCamera(const std::vector<Eigen::Vector3d>& joints_mm, std::size_t joint_count,
                                 const FilmingCamera& camera, const std::optional<LayoutMapping>& mapping) {
  std::vector<float> truth;
  const std::size_t frames = joints_mm.size() / joint_count;
  const std::size_t targets = mapping ? mapping->joints.size() : joint_count;
  truth.reserve(frames * targets * 3);
  for (std::size_t t = 0; t < frames; ++t) {
    const Camera& at = camera.cameras.size() == 1 ? camera.cameras.front() : camera.cameras[t];
    for (std::size_t j = 0; j < targets; ++j) {
      Eigen::Vector3d point = joints_mm[t * joint_count + j];
      if (mapping) {
        point.setZero();
        for (const int source : mapping->joints[j].sources) {
          point += joints_mm[t * joint_count + static_cast<std::size_t>(source)];
        }
        point /= static_cast<double>(mapping->joints[j].sources.size());
      }
      const Eigen::Vector3d in_camera = at.InCamera(point);
      for (int c = 0; c < 3; ++c) truth.push_back(static_cast<float>(in_camera[c]));
    }
  }
  return truth;
}

}  // namespace

void SimulationOptions::Validate() const {
  RequireNumber(subjects >= 1 && subjects <= kMaxClips, "`subjects`", "1 to 1000000", subjects);
  RequireNumber(clips >= 0 && clips <= kMaxClips, "`clips`", "1 to 1000000", clips);
  RequireNumber(static_cast<double>(subjects) * std::max(1, clips) <= kMaxClips, "`clips`",
                "at most 1000000 clips for all subjects together", clips);
  RequireNumber(people >= 1 && people <= subjects, "`people`", "1 to the number of subjects", people);
  RequireNumber(subjects % people == 0, "`people`", fmt::format("a divisor of {} subjects", subjects).c_str(), people);
  RequireNumber(people == 1 || motion_files.empty(), "`people`", "1 with motion capture files", people);
  RequireNumber(seconds > 0.0 && std::isfinite(seconds), "`seconds`", "more than 0", seconds);
  RequireNumber(fps == 0.0 || (fps >= kLowestFps && fps <= 1000.0), "`fps`", "0.1 to 1000 frames per second", fps);
  if (motion_files.empty()) {
    const double frames = seconds * (fps > 0.0 ? fps : kProceduralFps);
    RequireNumber(frames <= kMaxFramesPerClip, "`seconds`", "a clip of at most 100000 frames; make more clips instead",
                  seconds);
    RequireNumber(frames >= 2.0, "`seconds`", "a clip of at least two frames", seconds);
  }
  RequireSkeleton(skeleton, "`skeleton`");
  if (!layout.empty()) RequireSkeleton(layout, "`layout`");
  rig.Validate();
  detector.Validate();
}

Simulator::Simulator(SimulationOptions options) : options_(std::move(options)) {
  options_.Validate();
  skeleton_ = RequireSkeleton(options_.skeleton, "`skeleton`");
  const std::string& layout = options_.layout.empty() ? options_.skeleton : options_.layout;
  layout_ = MakeDetectorLayout(RequireSkeleton(layout, "`layout`"));
  if (!layout_skeleton().SameJoints(skeleton_)) skeleton_from_layout_ = MapLayout(layout_skeleton(), skeleton_);
  // An unusable rig is reported before any motion is read. A rig from a file is the same for all captures.
  std::unique_ptr<Rig> rig = MakeRig(options_.rig, Rng(options_.seed, {kRigStream}));
  if (options_.people > 1 && !rig->is_static()) {
    ThrowBadInput({"", "`people`", "1 where the cameras follow the person", fmt::format("{}", options_.people),
                   "choose a `rig` of static cameras"});
  }
  if (options_.rig.IsFile()) rig_of_file_ = std::move(rig);
  if (options_.motion_files.empty()) {
    ListProceduralClips();
  } else {
    const std::vector<std::filesystem::path> files = FindMotionFiles(options_.motion_files);
    RequireDifferentNames(files);
    for (const std::filesystem::path& file : files) clips_.push_back(ClipSource{file, {}, "", "", 0.0});
  }
}

void Simulator::ListProceduralClips() {
  std::vector<Activity> activities = options_.activities;
  if (activities.empty()) {
    activities = AllActivities();
    std::erase(activities, Activity::kSki);
  }
  const int clips = options_.clips > 0 ? options_.clips : static_cast<int>(activities.size());
  const double fps = options_.fps > 0.0 ? options_.fps : kProceduralFps;
  for (int s = 0; s < options_.subjects; ++s) {
    const auto subject = static_cast<std::uint64_t>(s);
    for (int c = 0; c < clips; ++c) {
      ProceduralClip clip;
      // People of a group do different things at a time.
      const int turn = options_.people > 1 ? c + s : c;
      clip.activity = activities[static_cast<std::size_t>(turn) % activities.size()];
      clip.subject_seed = Rng(options_.seed, {kPerson, subject}).Bits();
      clip.motion_seed = Rng(options_.seed, {kMotion, subject, static_cast<std::uint64_t>(c)}).Bits();
      clip.fps = fps;
      clip.frames = static_cast<int>(std::lround(options_.seconds * fps));
      clip.subject = fmt::format("person{}-{}", options_.seed, s + 1);
      clip.name = fmt::format("{}-{:03}-{}", clip.subject, c + 1, ActivityName(clip.activity));
      ClipSource& source = clips_.emplace_back(ClipSource{{}, clip, "", "", 0.0});
      if (options_.people == 1) continue;
      source.group = fmt::format("group{}-{}", options_.seed, s / options_.people + 1);
      source.scene = fmt::format("{}-{:03}", source.group, c + 1);
      source.around = static_cast<double>(s % options_.people) / options_.people;
    }
  }
}

DatasetSource Simulator::source() const {
  DatasetSource source;
  source.format = "simulated";
  if (skeleton_from_layout_) {
    source.layout = layout_skeleton().name;
    source.mapping = skeleton_from_layout_->DescribeAll();
  }
  return source;
}

ArticulatedMotion Simulator::LoadMotion(const ClipSource& source) const {
  if (source.file.empty()) return MakeProceduralMotion(source.procedural);
  ArticulatedMotion motion = ReadMotion(source.file);
  ThinOut(motion, options_.fps);
  if (motion.frame_count() > kMaxFramesPerClip) {
    ThrowBadInput({source.file.string(), "", fmt::format("at most {} frames", kMaxFramesPerClip),
                   fmt::format("{}", motion.frame_count()), "cut it into clips, or reduce its frame rate with `fps`"});
  }
  return motion;
}

CameraView Simulator::MakeView(const SimulatedClip& clip, const std::vector<Eigen::Vector3d>& joints_mm,
                               std::size_t camera) const {
  const FilmingCamera& filming = clip.cameras[camera];
  const Detections& detections = clip.detections[camera];
  CameraView view;
  view.name = filming.name;
  view.image_size = filming.image_size;
  view.calibration = filming.cameras;
  const auto joints = static_cast<std::size_t>(layout_skeleton().joint_count());
  view.truth = TruthPoses(skeleton_, TruthInCamera(joints_mm, joints, filming, skeleton_from_layout_), view.name);
  if (!skeleton_from_layout_) {
    view.keypoints = detections.keypoints;
    view.confidence = detections.confidence;
    return view;
  }
  const std::size_t targets = skeleton_.joints.size();
  const std::size_t frames = detections.confidence.size() / joints;
  view.keypoints.resize(frames * targets * 2);
  view.confidence.resize(frames * targets);
  for (std::size_t t = 0; t < frames; ++t) {
    ApplyMapping(*skeleton_from_layout_, &detections.keypoints[2 * t * joints], &detections.confidence[t * joints],
                 &view.keypoints[2 * t * targets], &view.confidence[t * targets]);
  }
  return view;
}

SimulatedClip Simulator::Make(int index) const {
  const ClipSource& source = clips_[static_cast<std::size_t>(index)];
  SimulatedClip clip;
  clip.motion = LoadMotion(source);
  clip.track = MakeLandmarkTrack(clip.motion, source.file.empty() ? clip.motion.name : source.file.string());
  // By name, so that a clip does not depend on the other clips, and held-out clips of a subject are filmed by the same
  // cameras.
  const std::string& filmed_as = source.group.empty() ? clip.motion.subject : source.group;
  const std::uint64_t name = NumberOf(clip.motion.name);
  Place(clip.track, Rng(options_.seed, {kPlacement, name}));
  if (!source.group.empty()) PlaceInGroup(clip.track, source.around, Rng(options_.seed, {kGroup, name}));
  const std::shared_ptr<const Rig> rig =
      rig_of_file_ ? rig_of_file_ : MakeRig(options_.rig, Rng(options_.seed, {kRigStream, NumberOf(filmed_as)}));
  clip.cameras = rig->Film(clip.track, Rng(options_.seed, {kFilming, name}));
  for (std::size_t c = 0; c < clip.cameras.size(); ++c) {
    clip.detections.push_back(Detect(clip.track, clip.cameras[c], layout_, options_.detector,
                                     options_.detector_seed.value_or(options_.seed),
                                     Rng(options_.seed, {kDetection, name, c})));
  }

  clip.sequence.name = clip.motion.name;
  clip.sequence.subject = clip.motion.subject;
  clip.sequence.scene = source.scene;
  clip.sequence.fps = clip.motion.fps;
  clip.sequence.static_cameras = rig->is_static();
  clip.sequence.capture_is_named = rig->is_static();
  clip.sequence.capture = rig->is_static() ? CaptureName(filmed_as, clip.cameras) : clip.motion.name;
  clip.sequence.frame_count = clip.track.frame_count();
  const std::vector<Eigen::Vector3d> joints_mm = JointPositions(clip.track, layout_);
  for (std::size_t c = 0; c < clip.cameras.size(); ++c) {
    clip.sequence.cameras.push_back(MakeView(clip, joints_mm, c));
  }
  return clip;
}

ClipStream::ClipStream(const Simulator& simulator, int threads)
    : simulator_(simulator),
      ahead_(threads > 0 ? std::min<std::size_t>(threads, kMaxThreads)
                         : std::max(1U, std::thread::hardware_concurrency())) {
  Refill();
}

void ClipStream::Refill() {
  while (pending_.size() < ahead_ && started_ < simulator_.clip_count()) {
    // What a reader has to say about a file reaches the caller.
    pending_.push_back(std::async(std::launch::async,
                                  [&simulator = simulator_, clip = started_, context = internal::CurrentContext()] {
                                    const internal::ContextOfThread adopted(context);
                                    return simulator.Make(clip);
                                  }));
    ++started_;
  }
}

std::optional<SimulatedClip> ClipStream::Next() {
  if (pending_.empty()) return std::nullopt;
  SimulatedClip clip = pending_.front().get();
  pending_.pop_front();
  Refill();
  return clip;
}

}  // namespace canonpose
