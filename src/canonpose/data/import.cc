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
#include "canonpose/data/image_size_check.h"
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

/// Coordinates that never exceed this are fractions of the image, not pixels.
constexpr float kLargestFraction = 2.0F;
/// A keypoint outside the image by this fraction of its size is not just beyond its border.
constexpr float kFarOutside = 0.1F;
/// If this fraction of the keypoints is far outside, the image size is wrong.
constexpr double kManyOutside = 0.02;
/// Of the keypoints' centre, as a fraction of the image: about 0.35 for a video of half the size or with width and
/// height exchanged, up to 0.26 where the size is right but only arms and head are detected.
constexpr double kClearlyOffCentre = 0.3;
/// No detector's confidences exceed this; AlphaPose's, which are maxima of heat maps, reach about 6.
constexpr float kLargestConfidence = 100.0F;
/// Nor does one exceed both this and kOutlierFactor times the value that 99 % of them stay below.
constexpr float kSuspiciousConfidence = 10.0F;
constexpr float kOutlierFactor = 10.0F;

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

void RefuseFractions(const KeypointClip& clip) {
  float largest = 0.0F;
  for (const float coordinate : clip.keypoints) {
    if (!std::isnan(coordinate)) largest = std::max(largest, std::abs(coordinate));
  }
  if (largest > kLargestFraction) return;
  ThrowBadInput({clip.path, "", "coordinates in pixels",
                 fmt::format("none above {:.3g}, so fractions of the image", largest),
                 "run the detector again so that it writes pixels (OpenPose: with keypoint_scale 0)"});
}

/// Warns where the keypoints say that the images were of another size.
void CheckImageSize(const KeypointClip& clip, const ImageSize& size) {
  std::size_t seen = 0;
  std::size_t outside = 0;
  std::array<float, 2> reach{0.0F, 0.0F};
  for (std::size_t i = 0; i + 1 < clip.keypoints.size(); i += 2) {
    if (std::isnan(clip.keypoints[i])) continue;
    ++seen;
    bool is_far = false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const float coordinate = clip.keypoints[i + axis];
      const auto extent = static_cast<float>(size[axis]);
      reach[axis] = std::max(reach[axis], coordinate);
      is_far = is_far || coordinate < -kFarOutside * extent || coordinate > (1.0F + kFarOutside) * extent;
    }
    outside += is_far ? 1 : 0;
  }
  if (static_cast<double>(outside) <= kManyOutside * static_cast<double>(seen)) {
    const std::vector<OtherImageSize> others = OtherImageSizes(clip.keypoints, size, kClearlyOffCentre);
    if (others.empty()) return;
    LogWarning(
        "{}: the keypoints lie as in images of {}x{} pixels, not {}x{}: check `image_size`, which is that of the video "
        "that the detector was given",
        clip.name, others.front().size[0], others.front().size[1], size[0], size[1]);
    return;
  }
  LogWarning(
      "{}: {:.0f} % of the keypoints lie far outside an image of {}x{} pixels (they reach {:.0f}, {:.0f}); check "
      "`image_size`{}",
      clip.name, 100.0 * static_cast<double>(outside) / static_cast<double>(seen), size[0], size[1], reach[0], reach[1],
      size[0] != size[1] ? ", width comes first" : "");
}

/// Confidences are divided by the largest, so one absurd value would make all others nearly zero.
void RefuseAbsurdConfidences(const DetectedCamera& camera) {
  std::vector<float> seen;
  float largest = 0.0F;
  std::string place;
  for (const DetectedFrame& frame : camera.frames) {
    for (std::size_t p = 0; p < frame.people.size(); ++p) {
      const std::vector<float>& confidence = frame.people[p].confidence;
      for (std::size_t k = 0; k < confidence.size(); ++k) {
        if (confidence[k] > 0.0F) seen.push_back(confidence[k]);
        if (!(confidence[k] > largest)) continue;
        largest = confidence[k];
        if (largest > kSuspiciousConfidence)
          place = fmt::format("frame {} ({}), person {}, keypoint {}", frame.number, frame.image, p, k);
      }
    }
  }
  if (largest <= kSuspiciousConfidence) return;
  const auto rank = seen.begin() + static_cast<std::ptrdiff_t>((seen.size() - 1) * 99 / 100);
  std::nth_element(seen.begin(), rank, seen.end());
  if (largest <= kLargestConfidence && largest <= kOutlierFactor * *rank) return;
  ThrowBadInput({camera.path, place,
                 fmt::format("a confidence like the others, 99 % of which are at most {:.3g}, and never above {:.0f}",
                             *rank, kLargestConfidence),
                 fmt::format("{:.6g}", largest), "correct or remove that detection, or run the detector again"});
}

/// Reads a camera and follows the person. Adds what the files have and is not read to `unused_parts`.
KeypointClip ReadClip(const DetectionFormat& format, const CameraInput& input, int person,
                      std::set<std::string>& unused_parts) {
  DetectedCamera camera = format.read(input);
  RefuseAbsurdConfidences(camera);
  MergeDuplicates(camera);
  DropUselessTrackIds(camera);
  unused_parts.insert(camera.unused_parts.begin(), camera.unused_parts.end());
  KeypointClip clip = FollowPerson(camera, person);
  RefuseFractions(clip);
  return clip;
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

/// A camera given twice would look like two views that agree in everything. The clips are aligned.
void RefuseIdenticalClips(const std::vector<KeypointClip>& clips) {
  const auto is_same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  for (std::size_t i = 0; i < clips.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!std::equal(clips[i].keypoints.begin(), clips[i].keypoints.end(), clips[k].keypoints.begin(),
                      clips[k].keypoints.end(), is_same))
        continue;
      ThrowBadInput({clips[i].path, "", fmt::format("camera {} to have its own keypoints", clips[i].name),
                     fmt::format("those of camera {} ({}) in every frame", clips[k].name, clips[k].path),
                     "give every camera once, with its own detections"});
    }
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

std::vector<KeypointClip> ReadClips(const ImportOptions& options, const DetectionFormat& format,
                                    const std::vector<CameraInput>& cameras) {
  std::vector<KeypointClip> clips;
  std::set<std::string> unused_parts;
  for (const CameraInput& camera : cameras) {
    const auto person = options.camera_person.find(camera.name);
    clips.push_back(ReadClip(format, camera, person == options.camera_person.end() ? options.person : person->second,
                             unused_parts));
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
    CameraView view = MapClip(clips[i], mapping, scale);
    view.image_size = cameras[i].image_size;
    if (!options.calibration.empty()) {
      view.calibration = CamerasOf(FindCalibration(calibration, view.name, options.calibration), sequence.frame_count,
                                   view.name, options.calibration.string());
    }
    sequence.cameras.push_back(std::move(view));
  }
  dataset.sequences.push_back(std::move(sequence));
  if (!options.calibration.empty()) CheckCalibration(dataset, options.calibration.string());
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
  std::vector<KeypointClip> clips{ReadClip(format, cameras.front(), options.person, unused_parts)};
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
