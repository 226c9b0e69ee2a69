#include "canonpose/data/import.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/calibration_check.h"
#include "canonpose/data/clip_timing.h"
#include "canonpose/data/detection_cleaning.h"
#include "canonpose/data/everybody.h"
#include "canonpose/data/keypoint_checks.h"
#include "canonpose/data/own_layout.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/calibration.h"
#include "canonpose/data/readers/formats.h"
#include "canonpose/data/readers/skeleton_json.h"
#include "canonpose/data/readers/video_facts.h"
#include "canonpose/data/video_times.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ImageSize = std::array<int, 2>;

constexpr const char* kUsualSkeleton = "h36m-17";
using Calibration = std::map<std::string, CalibratedCamera>;

bool SamePath(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

void CheckCameraNamesAndPaths(const std::vector<CameraInput>& cameras) {
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CameraInput& camera = cameras[i];
    if (camera.name.empty() || camera.name.front() == '.' || camera.name.find('/') != std::string::npos) {
      ThrowBadInput({camera.path.string(), "", "a camera name without '/' that does not begin with '.'",
                     "\"" + camera.name + "\"", "name it with `camera` NAME=PATH"});
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (cameras[k].name == camera.name) {
        ThrowBadInput({camera.path.string(), "", "another name for each camera",
                       fmt::format("camera {} also at {}", camera.name, cameras[k].path.string()),
                       "name them with `camera` NAME=PATH"});
      }
      if (cameras[k].part == camera.part && SamePath(cameras[k].path, camera.path)) {
        ThrowBadInput({camera.path.string(), "", "another folder or file for each camera",
                       fmt::format("the same for cameras {} and {}", cameras[k].name, camera.name),
                       "give every camera once, with its own detections"});
      }
    }
  }
}

std::vector<CameraInput> FindCameras(const ImportOptions& options, const DetectionFormat& format) {
  std::vector<CameraInput> cameras;
  for (const fs::path& path : options.paths) {
    for (CameraInput& camera : format.find_cameras(path)) {
      const bool is_named_by_user =
          std::any_of(options.cameras.begin(), options.cameras.end(), [&](const CameraInput& named) {
            return named.name == camera.name || (camera.part.empty() && SamePath(named.path, camera.path));
          });
      if (!is_named_by_user) cameras.push_back(std::move(camera));
    }
  }
  for (const CameraInput& named : options.cameras) {
    const std::vector<CameraInput> found = format.find_cameras(named.path);
    if (found.size() != 1) {
      ThrowBadInput({named.path.string(), "", fmt::format("one camera for {}", named.name),
                     fmt::format("{} cameras", found.size()), "give the path of that camera alone"});
    }
    cameras.push_back(found.front());
    cameras.back().name = named.name;
  }
  std::stable_sort(cameras.begin(), cameras.end(),
                   [](const CameraInput& a, const CameraInput& b) { return a.name < b.name; });
  CheckCameraNamesAndPaths(cameras);
  if (cameras.size() < 2) {
    ThrowBadInput({cameras.empty() ? "" : cameras.front().path.string(), "", "at least two cameras",
                   cameras.empty() ? "none" : "one, " + cameras.front().name,
                   "give the paths of all cameras that filmed the person at the same time"});
  }
  return cameras;
}

/// An option that names a camera which does not exist is a typing error.
template <typename Value>
void CheckNamesExist(const std::map<std::string, Value>& by_camera, const std::vector<CameraInput>& cameras,
                     const char* option) {
  for (const auto& [name, value] : by_camera) {
    const std::string& wanted = name;
    if (std::any_of(cameras.begin(), cameras.end(), [&](const CameraInput& camera) { return camera.name == wanted; }))
      continue;
    std::string names;
    for (const CameraInput& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
    ThrowInvalidArgument("{} names camera {}, but the cameras are {}", option, name, names);
  }
}

ImageSize ImageSizeOf(const CameraInput& camera, const ImportOptions& options, const Calibration& calibration,
                      const std::optional<VideoFacts>& facts) {
  const auto own = options.camera_image_size.find(camera.name);
  if (own != options.camera_image_size.end()) return own->second;
  if (options.image_size[0] > 0) return options.image_size;
  if (facts) return facts->image_size;
  if (options.calibration.empty()) {
    ThrowBadInput({camera.path.string(), "", fmt::format("the image size of camera {}", camera.name),
                   "none in the file", fmt::format("give `image_size` WxH, or {}=WxH for one camera", camera.name)});
  }
  const CalibratedCamera& calibrated = FindCalibration(calibration, camera.name, options.calibration);
  if (!calibrated.image_size) {
    ThrowBadInput({options.calibration.string(), "image_size", "width and height", "nothing", "give `image_size` WxH"});
  }
  return *calibrated.image_size;
}

/// A calibration of other images is of no use: it may be that of the sensor, before the video was cut or scaled.
void WarnOfOtherImageSize(const CameraInput& camera, const CalibratedCamera& calibrated, const ImageSize& size,
                          const std::string& file) {
  if (!calibrated.image_size || *calibrated.image_size == size) return;
  LogWarning(
      "{}: camera {} is calibrated for images of {}x{} pixels, but its video has {}x{}: figures that compare with "
      "the calibration are only right if its pixels are the video's, counted from the same corner",
      file, camera.name, (*calibrated.image_size)[0], (*calibrated.image_size)[1], size[0], size[1]);
}

/// One camera, or one per frame.
std::vector<Camera> CamerasOf(const CalibratedCamera& calibrated, int frame_count, const std::string& name,
                              const std::string& file) {
  if (calibrated.per_frame.empty()) return {calibrated.camera};
  if (std::ssize(calibrated.per_frame) != frame_count) {
    ThrowBadInput({file, "cameras." + name, fmt::format("{} frames, as the keypoints have", frame_count),
                   fmt::format("{}", calibrated.per_frame.size()), "give the calibration of this very recording"});
  }
  return calibrated.per_frame;
}

/// Reads a camera and puts it right. Adds what the files have and is not read to `unused_parts`.
DetectedCamera ReadCamera(const DetectionFormat& format, const CameraInput& input,
                          std::set<std::string>& unused_parts) {
  DetectedCamera camera = format.read(input);
  RefuseAbsurdConfidences(camera);
  MergeDuplicates(camera);
  DropUselessTrackIds(camera);
  unused_parts.insert(camera.unused_parts.begin(), camera.unused_parts.end());
  return camera;
}

void ReportUnusedParts(const std::set<std::string>& parts) {
  if (parts.empty()) return;
  LogInfo("the keypoints of {} are left out; only those of the body are read", fmt::join(parts, ", "));
}

void CheckKeypointCounts(const std::vector<KeypointClip>& clips) {
  for (const KeypointClip& clip : clips) {
    if (clip.keypoint_count == clips.front().keypoint_count || clip.layout) continue;
    ThrowBadInput(
        {clip.path, "", fmt::format("{} keypoints as in camera {}", clips.front().keypoint_count, clips.front().name),
         fmt::format("{} in camera {}", clip.keypoint_count, clip.name), "all cameras must come from one detector"});
  }
}

/// The largest confidence where that is above 1; otherwise 1.
double ConfidenceScale(const std::vector<KeypointClip>& clips) {
  double largest = 1.0;
  for (const KeypointClip& clip : clips) {
    for (const float confidence : clip.confidence) largest = std::max(largest, static_cast<double>(confidence));
  }
  return largest;
}

CameraView MapClip(const KeypointClip& clip, const LayoutMapping& mapping, double confidence_scale) {
  const auto source_count = static_cast<std::size_t>(mapping.source.joint_count());
  const auto target_count = static_cast<std::size_t>(mapping.target.joint_count());
  const auto frames = clip.frame_numbers.size();
  std::vector<float> confidence = clip.confidence;
  for (float& c : confidence) c = static_cast<float>(std::min(1.0, static_cast<double>(c) / confidence_scale));
  CameraView view;
  view.name = clip.name;
  view.keypoints.resize(frames * target_count * 2);
  view.confidence.resize(frames * target_count);
  for (std::size_t t = 0; t < frames; ++t) {
    ApplyMapping(mapping, &clip.keypoints[t * source_count * 2], &confidence[t * source_count],
                 &view.keypoints[t * target_count * 2], &view.confidence[t * target_count]);
  }
  return view;
}

/// The view with a track for each of the people who stand side by side in `clip`.
CameraView MapPeople(const KeypointClip& clip, const LayoutMapping& mapping, double confidence_scale) {
  CameraView view;
  view.name = clip.name;
  const std::size_t values = clip.frame_numbers.size() * mapping.target.joints.size();
  view.keypoints.assign(2 * values, std::numeric_limits<float>::quiet_NaN());
  view.confidence.assign(values, 0.0F);
  for (KeypointClip& person : SplitPeople(clip, mapping.source.joint_count())) {
    CameraView mapped = MapClip(person, mapping, confidence_scale);
    CameraTrack& track = view.tracks.emplace_back();
    // Names sort in the order of the tracks.
    track.id = fmt::format("{:04}", view.tracks.size());
    track.keypoints = std::move(mapped.keypoints);
    track.confidence = std::move(mapped.confidence);
  }
  return view;
}

LayoutMapping MappingTo(const Skeleton& layout, const std::string& skeleton) {
  if (skeleton.empty()) {
    const Skeleton& usual = *FindSkeleton(kUsualSkeleton);
    if (FindSkeleton(layout.name) != nullptr) return MapLayout(layout, usual);
    const LayoutMapping mapping = MapAvailableJoints(layout, usual);
    if (std::none_of(mapping.joints.begin(), mapping.joints.end(),
                     [](const JointSource& joint) { return joint.sources.empty(); })) {
      return mapping;
    }
    LogInfo("the joints of {} are not a person's, so they are kept as they are", layout.name);
    return MapLayout(layout, layout);
  }
  if (skeleton == "native") return MapLayout(layout, layout);
  const Skeleton* target = FindSkeleton(skeleton);
  if (target == nullptr) {
    ThrowInvalidArgument("there is no skeleton \"{}\"; the skeletons are {} and native", skeleton,
                         BuiltinSkeletonNames());
  }
  return MapLayout(layout, *target);
}

/// One line about what a layout that is not one of the program's has and the skeleton does not use.
void ReportLeftOutJoints(const LayoutMapping& mapping) {
  if (FindSkeleton(mapping.source.name) != nullptr) return;
  std::vector<bool> is_used(mapping.source.joints.size(), false);
  for (const JointSource& joint : mapping.joints) {
    for (const int source : joint.sources) is_used[static_cast<std::size_t>(source)] = true;
  }
  std::vector<std::string> left_out;
  for (std::size_t j = 0; j < is_used.size(); ++j) {
    if (!is_used[j]) left_out.push_back(mapping.source.joints[j]);
  }
  if (left_out.empty()) return;
  LogInfo("{} of {} keypoints have no place in {} and are left out ({}); `skeleton` native keeps them", left_out.size(),
          is_used.size(), mapping.target.name, fmt::join(left_out, ", "));
}

/// The person of each camera; with ImportOptions::everybody all of its people, one after the other (everybody.h).
std::vector<KeypointClip> ReadClips(const ImportOptions& options, const DetectionFormat& format,
                                    const std::vector<CameraInput>& cameras) {
  std::vector<KeypointClip> clips;
  std::set<std::string> unused_parts;
  for (const CameraInput& input : cameras) {
    const DetectedCamera camera = ReadCamera(format, input, unused_parts);
    const auto person = options.camera_person.find(input.name);
    clips.push_back(options.everybody ? FollowEverybody(camera)
                                      : FollowPerson(camera, person == options.camera_person.end() ? options.person
                                                                                                   : person->second));
    RefuseFractions(clips.back());
  }
  ReportUnusedParts(unused_parts);
  return clips;
}

}  // namespace

void ImportOptions::Validate() const {
  FindDetectionFormat(format);
  if (paths.empty() && cameras.empty()) ThrowInvalidArgument("give the paths of the cameras");
  RequireLayoutName(layout);
  if (!skeleton.empty() && skeleton != "native" && FindSkeleton(skeleton) == nullptr) {
    ThrowInvalidArgument("there is no skeleton \"{}\"; the skeletons are {} and native", skeleton,
                         BuiltinSkeletonNames());
  }
  if (person < 1) ThrowInvalidArgument("`person` counts from 1, not {}", person);
  if (everybody && (person != 1 || !camera_person.empty())) {
    ThrowInvalidArgument("`person`: expected all or numbers, found both; all keeps everybody");
  }
  for (const auto& [camera, number] : camera_person) {
    if (number < 1) ThrowInvalidArgument("`person` counts from 1, not {}", number);
  }
  if (!std::isfinite(fps) || fps < 0.0) ThrowInvalidArgument("`fps` must be above 0, not {}", fps);
  for (const auto& [camera, rate] : camera_fps) {
    if (!std::isfinite(rate) || rate <= 0.0) ThrowInvalidArgument("`fps` must be above 0, not {}", rate);
  }
  if (name.empty() || name.front() == '.' || name.find('/') != std::string::npos) {
    ThrowInvalidArgument(
        "\"{}\" is not a valid name for a sequence: it must not be empty, begin with '.' or contain '/'", name);
  }
}

Dataset ImportDetections(const ImportOptions& options) {
  options.Validate();
  const DetectionFormat& format = FindDetectionFormat(options.format);
  std::vector<CameraInput> cameras = FindCameras(options, format);
  CheckNamesExist(options.camera_person, cameras, "`person`");
  CheckNamesExist(options.camera_image_size, cameras, "`image_size`");
  CheckNamesExist(options.camera_fps, cameras, "`fps`");
  // Cheap checks come before reading, which may take minutes.
  Calibration calibration;
  if (!options.calibration.empty()) calibration = ReadCalibration(options.calibration);
  const int keypoint_count = KeypointCountOf(options.layout);
  std::vector<std::optional<VideoFacts>> facts;
  for (CameraInput& camera : cameras) {
    facts.push_back(ReadVideoFacts(camera.path));
    camera.image_size = ImageSizeOf(camera, options, calibration, facts.back());
    camera.keypoint_count = keypoint_count;
    if (options.calibration.empty()) continue;
    const CalibratedCamera& calibrated = FindCalibration(calibration, camera.name, options.calibration);
    if (facts.back()) WarnOfOtherImageSize(camera, calibrated, facts.back()->image_size, options.calibration.string());
  }

  std::vector<KeypointClip> clips = ReadClips(options, format, cameras);
  CheckKeypointCounts(clips);
  const Skeleton layout = LayoutOf(clips, options.layout);
  if (options.everybody) std::ranges::transform(clips, clips.begin(), PeopleSideBySide);
  const ClipTiming timing = TimeClips(clips, facts, {options.fps, options.camera_fps}, options.alignment);
  RefuseIdenticalClips(clips);
  const LayoutMapping mapping = MappingTo(layout, options.skeleton);
  ReportLeftOutJoints(mapping);
  const double scale = ConfidenceScale(clips);
  if (scale > 1.0) LogInfo("confidences reach {:.3g}; all are divided by this value", scale);

  Dataset dataset;
  dataset.skeleton = mapping.target;
  dataset.source = {std::string(format.name), layout.name, scale, mapping.DescribeAll()};
  Sequence sequence;
  sequence.name = options.name;
  sequence.subject = options.subject.empty() ? options.name : options.subject;
  sequence.fps = timing.fps;
  sequence.timing = timing.timing;
  sequence.static_cameras = !options.moving_cameras;
  sequence.frame_count = clips.front().frame_count();
  for (std::size_t i = 0; i < clips.size(); ++i) {
    CheckImageSize(clips[i], cameras[i].image_size);
    CameraView view = options.everybody ? MapPeople(clips[i], mapping, scale) : MapClip(clips[i], mapping, scale);
    view.image_size = cameras[i].image_size;
    if (!options.calibration.empty()) {
      view.calibration = CamerasOf(FindCalibration(calibration, view.name, options.calibration), sequence.frame_count,
                                   view.name, options.calibration.string());
    }
    sequence.cameras.push_back(std::move(view));
  }
  dataset.sequences.push_back(std::move(sequence));
  // With everybody only `solve` can tell: nothing says yet which keypoints belong together.
  if (!options.calibration.empty() && !options.everybody) CheckCalibration(dataset, options.calibration.string());
  dataset.sequences.front().capture = options.capture.empty()
                                          ? fmt::format("{}-{:08x}", options.name, dataset.Fingerprint() & 0xFFFFFFFFU)
                                          : options.capture;
  return dataset;
}

SingleCamera ReadSingleCamera(const fs::path& path, const SingleCameraOptions& options) {
  const DetectionFormat& format = FindDetectionFormat(options.format.empty() ? DetectFormat(path) : options.format);
  std::vector<CameraInput> cameras = format.find_cameras(path);
  std::string names;
  for (const CameraInput& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  const bool is_one = cameras.size() == 1;
  if (!options.camera.empty()) {
    std::erase_if(cameras, [&](const CameraInput& camera) { return camera.name != options.camera; });
  }
  if (cameras.size() != 1) {
    ThrowBadInput({path.string(), "", options.camera.empty() ? "one camera" : "camera " + options.camera,
                   (is_one ? "the camera " : "the cameras ") + names,
                   is_one ? "leave out `camera`, or give its name" : "choose one with `camera` NAME"});
  }
  cameras.front().image_size = options.image_size;
  const bool is_native = options.skeleton.joints.empty();
  cameras.front().keypoint_count = IsSkeletonFile(options.layout) || FindSkeleton(options.layout) != nullptr
                                       ? KeypointCountOf(options.layout)
                                       : options.skeleton.joint_count();
  std::set<std::string> unused_parts;
  std::vector<KeypointClip> clips{FollowPerson(ReadCamera(format, cameras.front(), unused_parts), options.person)};
  RefuseFractions(clips.front());
  ReportUnusedParts(unused_parts);
  const Skeleton layout = LayoutOf(clips, options.layout, is_native ? nullptr : &options.skeleton);
  const LayoutMapping mapping = MapLayout(layout, is_native ? layout : options.skeleton);
  const double scale = options.confidence_scale > 0.0 ? options.confidence_scale : ConfidenceScale(clips);
  SingleCamera single;
  const std::vector<std::optional<VideoFacts>> facts{ReadVideoFacts(cameras.front().path)};
  const double video_fps = NumberByVideoTimes(clips, facts);
  const double times_fps = CountFrames(clips.front());
  single.fps = times_fps > 0.0 ? times_fps : video_fps;
  single.view = MapClip(clips.front(), mapping, scale);
  single.view.image_size = options.image_size;
  if (options.image_size[0] == 0 && facts.front()) single.view.image_size = facts.front()->image_size;
  if (single.view.image_size[0] > 0) CheckImageSize(clips.front(), single.view.image_size);
  single.frame_numbers = clips.front().frame_numbers;
  single.skeleton = mapping.target;
  single.source = {std::string(format.name), layout.name, scale, mapping.DescribeAll()};
  return single;
}

std::array<int, 2> ParseImageSize(const std::string& text) {
  int width = 0;
  int height = 0;
  const char* const end = text.data() + text.size();
  const auto [after_width, width_error] = std::from_chars(text.data(), end, width);
  bool is_size = width_error == std::errc() && after_width != end && (*after_width == 'x' || *after_width == 'X');
  if (is_size) {
    const auto [after_height, height_error] = std::from_chars(after_width + 1, end, height);
    is_size = height_error == std::errc() && after_height == end && width > 0 && height > 0;
  }
  if (!is_size) ThrowInvalidArgument("\"{}\" is not an image size; write it as 1920x1080", text);
  return {width, height};
}

}  // namespace canonpose
