#include "canonpose/simulate/wild_capture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <future>
#include <limits>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/random.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/simulate/procedural.h"
#include "canonpose/simulate/rig_parts.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

/// What a generator is for, as its first stream number.
enum WildStream : std::uint64_t {
  kWildMotion = 0x3171,
  kWildChanges = 0x3172,
  kWildCamera = 0x3173,
  kWildDetection = 0x3174
};

constexpr std::size_t kClipsOfATask = 8;

/// From the simulator's landmarks to the detector's layout, and from there to the skeleton.
struct JointSources {
  DetectorLayout layout;
  LayoutMapping skeleton_from_layout;
};

bool IsMade(const LayoutMapping& mapping, int joint) {
  return !mapping.joints[static_cast<std::size_t>(joint)].sources.empty();
}

/// The joints of a skeleton that the simulator knows, each attached to its nearest known ancestor.
Skeleton KnownJoints(const Skeleton& skeleton, const LayoutMapping& from_landmarks) {
  Skeleton known;
  known.name = skeleton.name;
  std::vector<int> number(skeleton.joints.size(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (!IsMade(from_landmarks, j)) continue;
    number[static_cast<std::size_t>(j)] = known.joint_count();
    known.joints.push_back(skeleton.joints[static_cast<std::size_t>(j)]);
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const auto i = static_cast<std::size_t>(j);
    if (number[i] < 0) continue;
    int parent = skeleton.parents[i];
    while (parent >= 0 && number[static_cast<std::size_t>(parent)] < 0) {
      parent = skeleton.parents[static_cast<std::size_t>(parent)];
    }
    known.parents.push_back(parent < 0 ? -1 : number[static_cast<std::size_t>(parent)]);
    const int mirror = number[static_cast<std::size_t>(skeleton.mirror[i])];
    known.mirror.push_back(mirror < 0 ? number[i] : mirror);
    if (j == skeleton.root) known.root = number[i];
  }
  CANONPOSE_CHECK(known.Problem().empty(), "{}", known.Problem());
  return known;
}

/// A detector's layout or a benchmark's joints by name; null if there is none.
const Skeleton* FindLayout(const std::string& name) {
  if (const Skeleton* builtin = FindSkeleton(name)) return builtin;
  const auto found = std::ranges::find(BenchmarkSkeletons(), name, &Skeleton::name);
  return found == BenchmarkSkeletons().end() ? nullptr : &*found;
}

JointSources FindSources(const Skeleton& skeleton, const std::string& layout_name) {
  if (!IsKnownPerson(skeleton)) {
    ThrowBadInput({"", skeleton.name.empty() ? "the skeleton" : fmt::format("skeleton {}", skeleton.name),
                   "a person's joints with known names (hips, knees, shoulders, elbows, the root)",
                   fmt::format("{}", fmt::join(skeleton.joints, ", ")),
                   "simulated people cannot stand in for it: train on the recording itself"});
  }
  if (layout_name.empty()) {
    const Skeleton known = KnownJoints(skeleton, MapAvailableJoints(LandmarkSkeleton(), skeleton));
    LayoutMapping by_name{known, skeleton, {}};
    for (const std::string& joint : skeleton.joints) {
      const std::optional<int> source = known.Find(joint);
      by_name.joints.push_back({source ? std::vector<int>{*source} : std::vector<int>{}});
    }
    return {MakeDetectorLayout(known), by_name};
  }
  const Skeleton* layout = FindLayout(layout_name);
  if (layout == nullptr)
    ThrowInvalidArgument("layout: expected one of {}, found \"{}\"", BuiltinSkeletonNames(), layout_name);
  const Skeleton known = KnownJoints(*layout, MapAvailableJoints(LandmarkSkeleton(), *layout));
  JointSources sources{MakeDetectorLayout(known), MapAvailableJoints(known, skeleton)};
  if (!IsMade(sources.skeleton_from_layout, skeleton.root)) {
    ThrowBadInput({"", fmt::format("layout {}", layout_name), "a joint from which to make the root", "none",
                   "leave out the layout"});
  }
  return sources;
}

// --- cameras --------------------------------------------------------------------------------------------------------

/// A camera that keeps the person in the image and slowly circles around them.
FilmingCamera FilmFromAnywhere(const LandmarkTrack& track, const std::string& name, double off_centre, Rng& rng) {
  static constexpr std::array<std::array<int, 2>, 4> kSizes = {{{1920, 1080}, {1080, 1920}, {1000, 1000}, {1280, 960}}};
  const Lens lens = MakeLens(kSizes.at(rng.Index(kSizes.size())), rng.Uniform(), rng);
  const double width = lens.image_size[0];
  const double height = lens.image_size[1];
  // From wide to long lenses; the distance follows from the person's size in the image.
  const double focal_px = std::hypot(width, height) * 0.55 * std::pow(5.0, rng.Uniform());
  const double fill = rng.Uniform(0.25, 0.85);
  const double distance_mm = std::max(1600.0, StatureMm(&track.At(0, 0)) * focal_px / (fill * height));
  const double azimuth = rng.Uniform(0.0, 2.0 * M_PI);
  const double azimuth_rate = RadFromDeg(6.0) * rng.Normal();
  const bool is_level = rng.Uniform() < 0.4;
  const double elevation = RadFromDeg(is_level ? 4.0 + 8.0 * rng.Normal() : rng.Uniform(-30.0, 65.0));
  const double elevation_rate = RadFromDeg(1.5) * rng.Normal();
  const double roll = RadFromDeg(rng.Uniform() < 0.9 ? 3.0 : 12.0) * rng.Normal();
  const Eigen::Vector2d offset_px{width * rng.Uniform(-0.33, 0.33),
                                  0.45 * height * (1.0 - fill) * rng.Uniform(-1.0, 1.0)};
  FilmingCamera filming{name, lens.image_size, {}};
  for (int t = 0; t < track.frame_count(); ++t) {
    const double seconds = t / track.fps;
    const double a = azimuth + azimuth_rate * seconds;
    const double e = std::clamp(elevation + elevation_rate * seconds, RadFromDeg(-60.0), RadFromDeg(80.0));
    const Eigen::Vector3d& pelvis = track.At(t, kHip);
    const Eigen::Vector3d away(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    const Eigen::Vector3d position = pelvis + distance_mm * away;
    Camera camera;
    lens.Apply(focal_px, camera);
    Aim(position, pelvis, 0.0, camera);
    const Eigen::Vector2d shift_mm = -off_centre * offset_px * (distance_mm / focal_px);
    const Eigen::Vector3d target = pelvis + camera.camera_from_world_rotation.topRows<2>().transpose() * shift_mm;
    Aim(position, target, roll, camera);
    filming.cameras.push_back(camera);
  }
  return filming;
}

// --- clips ----------------------------------------------------------------------------------------------------------

ArticulatedMotion MakeMotion(const WildCaptureOptions& options, int number) {
  Rng rng(options.seed, {kWildMotion, static_cast<std::uint64_t>(number)});
  const std::vector<Activity>& activities = AllActivities();
  ProceduralClip clip;
  clip.activity = activities[static_cast<std::size_t>(number) % activities.size()];
  clip.subject_seed = rng.Bits();
  clip.motion_seed = rng.Bits();
  clip.fps = options.fps;
  clip.frames = options.frames;
  clip.name = fmt::format("wild-{}-{}", options.seed, number + 1);
  clip.subject = clip.name;
  ArticulatedMotion motion = MakeProceduralMotion(clip);
  if (rng.Uniform() >= options.wild_share) return motion;
  if (rng.Uniform() < options.mixed_share) {
    clip.activity = activities[rng.Index(activities.size())];
    clip.motion_seed = rng.Bits();
    TakeUpperBody(MakeProceduralMotion(clip), motion);
  }
  MakeWild(motion, options.wild, Rng(options.seed, {kWildChanges, static_cast<std::uint64_t>(number)}));
  return motion;
}

/// The detectors of clips differ in how confident they are.
struct ConfidenceScale {
  bool is_always_one;
  double power;
  [[nodiscard]] float Apply(float confidence) const {
    if (!(confidence > 0.0F)) return 0.0F;
    return is_always_one ? 1.0F : static_cast<float>(std::pow(static_cast<double>(confidence), power));
  }
};

/// Appends joint positions (K), mapped to the skeleton and in the camera's frame, to `truth`.
void AppendTruth(const LayoutMapping& mapping, const Eigen::Vector3d* joints_mm, const Camera& camera,
                 std::vector<float>& truth) {
  for (const JointSource& joint : mapping.joints) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (const int source : joint.sources) point += joints_mm[source];
    point = camera.InCamera(point / static_cast<double>(joint.sources.size()));
    for (int c = 0; c < 3; ++c) {
      truth.push_back(joint.sources.empty() ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(point[c]));
    }
  }
}

CameraView MakeView(const JointSources& sources, const FilmingCamera& filming, const Detections& detections,
                    const std::vector<Eigen::Vector3d>& joints_mm, const ConfidenceScale& scale) {
  const std::size_t layout_joints = sources.layout.from_landmarks.joints.size();
  const std::size_t joints = sources.skeleton_from_layout.joints.size();
  const std::size_t frames = filming.cameras.size();
  CameraView view;
  view.name = filming.name;
  view.image_size = filming.image_size;
  view.keypoints.resize(frames * joints * 2);
  view.confidence.resize(frames * joints);
  std::vector<float> truth;
  truth.reserve(frames * joints * 3);
  for (std::size_t t = 0; t < frames; ++t) {
    ApplyMapping(sources.skeleton_from_layout, &detections.keypoints[2 * t * layout_joints],
                 &detections.confidence[t * layout_joints], &view.keypoints[2 * t * joints],
                 &view.confidence[t * joints]);
    AppendTruth(sources.skeleton_from_layout, &joints_mm[t * layout_joints], filming.cameras[t], truth);
  }
  view.truth = TruthPoses(sources.skeleton_from_layout.target, std::move(truth), view.name);
  for (float& confidence : view.confidence) confidence = scale.Apply(confidence);
  return view;
}

Sequence MakeClip(const JointSources& sources, const WildCaptureOptions& options, int number) {
  const auto stream = static_cast<std::uint64_t>(number);
  const ArticulatedMotion motion = MakeMotion(options, number);
  const LandmarkTrack track = MakeLandmarkTrack(motion, motion.name);
  const std::vector<Eigen::Vector3d> joints_mm = JointPositions(track, sources.layout);
  Rng detector(options.seed, {kWildDetection, stream});
  const std::uint64_t detector_seed = detector.Bits();
  const bool is_always_one = detector.Uniform() < 0.2;
  const double power = std::pow(1.0 + options.confidence_spread, detector.Uniform(-1.0, 1.0));
  Sequence sequence;
  sequence.name = sequence.subject = sequence.capture = motion.name;
  sequence.fps = motion.fps;
  sequence.static_cameras = false;
  sequence.frame_count = track.frame_count();
  for (int c = 0; c < options.cameras; ++c) {
    Rng camera(options.seed, {kWildCamera, stream, static_cast<std::uint64_t>(c)});
    const FilmingCamera filming = FilmFromAnywhere(track, fmt::format("cam{}", c + 1), options.off_centre, camera);
    const Detections detections =
        Detect(track, filming, sources.layout, options.detector, detector_seed, Rng(detector.Bits()));
    sequence.cameras.push_back(MakeView(sources, filming, detections, joints_mm, {is_always_one, power}));
  }
  return sequence;
}

}  // namespace

std::vector<std::uint8_t> KnownJointsOf(const Skeleton& skeleton) {
  std::vector<std::uint8_t> known;
  for (const JointSource& joint : MapAvailableJoints(LandmarkSkeleton(), skeleton).joints) {
    known.push_back(joint.sources.empty() ? 0 : 1);
  }
  return known;
}

bool IsKnownPerson(const Skeleton& skeleton) {
  for (const char* part : {"lhip", "rhip", "lknee", "rknee", "lshoulder", "rshoulder", "lelbow", "relbow"}) {
    if (!FindPart(skeleton, part)) return false;
  }
  const std::vector<std::uint8_t> known = KnownJointsOf(skeleton);
  return known[static_cast<std::size_t>(skeleton.root)] == 1 &&
         3 * std::count(known.begin(), known.end(), 1) >= 2 * skeleton.joint_count();
}

Sequence MakeWildClip(const Skeleton& skeleton, const WildCaptureOptions& options, int number) {
  return MakeClip(FindSources(skeleton, options.layout), options, number);
}

Dataset MakeWildCapture(const Skeleton& skeleton, const WildCaptureOptions& options) {
  const JointSources sources = FindSources(skeleton, options.layout);
  const std::size_t threads = options.threads > 0 ? static_cast<std::size_t>(options.threads)
                                                  : std::max(1U, std::thread::hardware_concurrency());
  const auto clips = static_cast<std::size_t>(options.clips);
  Dataset dataset;
  dataset.skeleton = skeleton;
  dataset.source.format = "simulated";
  dataset.sequences.resize(clips);
  const auto make = [&](std::size_t first) {
    for (std::size_t i = first; i < std::min(first + kClipsOfATask, clips); ++i) {
      dataset.sequences[i] = MakeClip(sources, options, static_cast<int>(i));
    }
  };
  Progress progress("simulate", options.clips);
  std::deque<std::future<void>> pending;
  std::size_t done = 0;
  for (std::size_t next = 0; next < clips || !pending.empty();) {
    while (next < clips && pending.size() < threads) {
      pending.push_back(std::async(std::launch::async, make, next));
      next += kClipsOfATask;
    }
    pending.front().get();
    pending.pop_front();
    done = std::min(done + kClipsOfATask, clips);
    progress.Update(static_cast<long>(done), "clips");
  }
  return dataset;
}

}  // namespace canonpose
