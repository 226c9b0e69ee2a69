#include "canonpose/data/readers/benchmarks/canonpose_detections.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/data/codecs/pickle.h"
#include "canonpose/data/layout_check.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/benchmarks/builder.h"

namespace canonpose {
namespace {

constexpr std::size_t kDetectedJoints = 16;
constexpr std::array<int, 2> kUsualSize{1000, 1002};
constexpr const char* kUsualLayout = "canonpose-16";
constexpr const char* kOtherLayout = "mpii-16";
/// If another order explains the keypoints better by this factor, there is a warning.
constexpr double kClearlyBetter = 1.25;

/// One camera's keypoints of all subjects.
struct Rows {
  std::string camera;
  std::vector<double> keypoints;   ///< (N, 16, 2) pixels
  std::vector<double> confidence;  ///< (N, 16)
};

pickle::Numbers ReadRows(const pickle::Value& value, std::size_t rows, std::size_t columns) {
  pickle::Numbers numbers = value.ToNumbers();
  if (numbers.shape != std::vector{rows, columns}) {
    value.Fail(fmt::format("an array ({}, {}) = subjects, {}", rows, columns,
                           columns == kDetectedJoints ? "joints" : "x of all joints and y of all joints"),
               "", fmt::format("shape ({})", fmt::join(numbers.shape, ", ")));
  }
  return numbers;
}

std::vector<Rows> ReadCameras(const pickle::Value& root, std::size_t count, const std::string& file) {
  const pickle::Value poses = root["poses_2d_pred"];
  const pickle::Value confidences = root["confidences"];
  std::vector<Rows> cameras;
  for (const std::string& name : poses.Keys()) {
    Rows rows;
    rows.camera = name;
    const std::vector<double> planar = ReadRows(poses[name], count, 2 * kDetectedJoints).values;
    for (std::size_t n = 0; n < count; ++n) {
      for (std::size_t j = 0; j < kDetectedJoints; ++j) {
        rows.keypoints.push_back(planar[(2 * n) * kDetectedJoints + j]);
        rows.keypoints.push_back(planar[(2 * n + 1) * kDetectedJoints + j]);
      }
    }
    rows.confidence = ReadRows(confidences[name], count, kDetectedJoints).values;
    MarkMissing(rows.keypoints, rows.confidence);
    RequireFiniteOrMissing(rows.keypoints, kDetectedJoints, 2, file, poses[name].place());
    RequirePixels(rows.keypoints, file, poses[name].place());
    RequireFinite(rows.confidence, kDetectedJoints, 1, file, confidences[name].place());
    const auto lowest = std::min_element(rows.confidence.begin(), rows.confidence.end());
    if (lowest != rows.confidence.end() && *lowest < 0.0) {
      confidences[name].Fail("confidences of 0 or more", "", fmt::format("{}", *lowest));
    }
    cameras.push_back(std::move(rows));
  }
  if (cameras.empty()) poses.Fail("at least one camera");
  return cameras;
}

/// All rows of all cameras, in the form for the layout check.
std::vector<KeypointClip> ToClips(const std::vector<Rows>& cameras, const std::string& file) {
  std::vector<KeypointClip> clips;
  for (const Rows& rows : cameras) {
    KeypointClip clip;
    clip.name = rows.camera;
    clip.path = file;
    clip.keypoint_count = kDetectedJoints;
    clip.frame_numbers.resize(rows.confidence.size() / kDetectedJoints);
    clip.keypoints = ToFloats(rows.keypoints);
    clip.confidence = ToFloats(rows.confidence);
    clips.push_back(std::move(clip));
  }
  return clips;
}

void CheckOrder(const std::vector<Rows>& cameras, const std::string& chosen, const std::string& file) {
  const std::vector<KeypointClip> clips = ToClips(cameras, file);
  const std::string other = chosen == kUsualLayout ? kOtherLayout : kUsualLayout;
  const LayoutFit fit = MeasureLayout(BenchmarkLayout(chosen), clips);
  const LayoutFit other_fit = MeasureLayout(BenchmarkLayout(other), clips);
  if (fit.frames == 0) {
    LogWarning("too few joints are visible to check that their order is that of {}", chosen);
  } else if (fit.misfit() > kClearlyBetter * other_fit.misfit() && other_fit.fits()) {
    LogWarning(
        "the joints look like those of {} rather than {} (limbs are {:.1f} times as long as necessary, instead of "
        "{:.1f}); to read them as such, set `layout` {}",
        other, chosen, fit.tree_ratio, other_fit.tree_ratio, other);
  } else if (!fit.fits()) {
    LogWarning(
        "the joints hardly look like a person in the order of {}: limbs are {:.1f} times as long as necessary; rows "
        "should be x of all joints, then y of all",
        chosen, fit.tree_ratio);
  } else {
    LogInfo("the order of the joints is that of {}, which anatomy confirms", chosen);
  }
}

double ConfidenceScale(const std::vector<Rows>& cameras) {
  double largest = 1.0;
  for (const Rows& rows : cameras) {
    for (const double confidence : rows.confidence) largest = std::max(largest, confidence);
  }
  if (largest > 1.0) LogInfo("confidences reach {:.3g}; all are divided by this value", largest);
  return largest;
}

/// The rows `chosen` of one camera's keypoints.
CameraView MakeView(const Rows& rows, const std::vector<std::size_t>& chosen, double scale,
                    const std::array<int, 2>& image_size) {
  CameraView view;
  view.name = rows.camera;
  view.image_size = image_size;
  for (const std::size_t n : chosen) {
    for (std::size_t i = n * kDetectedJoints; i < (n + 1) * kDetectedJoints; ++i) {
      const auto confidence = static_cast<float>(std::min(1.0, rows.confidence[i] / scale));
      view.confidence.push_back(confidence);
      for (std::size_t axis = 0; axis < 2; ++axis) {
        view.keypoints.push_back(confidence > 0.0F ? static_cast<float>(rows.keypoints[2 * i + axis]) : NAN);
      }
    }
  }
  return view;
}

}  // namespace

Dataset ImportCanonPoseDetections(const BenchmarkOptions& options) {
  if (options.paths.size() != 1)
    ThrowInvalidArgument("canonpose-detections takes one file, not {}", options.paths.size());
  const std::string layout = options.layout.empty() ? kUsualLayout : options.layout;
  if (layout != kUsualLayout && layout != kOtherLayout) {
    ThrowInvalidArgument("canonpose-detections takes `layout` {} or {}, not \"{}\"", kUsualLayout, kOtherLayout,
                         layout);
  }
  const std::string file = options.paths.front().string();
  const pickle::Value root = pickle::Load(options.paths.front());
  const std::vector<std::int64_t> subjects = root["subjects"].Integers();
  if (subjects.empty()) root["subjects"].Fail("at least one row");
  const std::vector<Rows> cameras = ReadCameras(root, subjects.size(), file);
  CheckOrder(cameras, layout, file);
  const double scale = ConfidenceScale(cameras);
  const std::array<int, 2> image_size = options.image_size[0] > 0 ? options.image_size : kUsualSize;
  if (options.image_size[0] == 0) {
    LogInfo("the file does not contain the image size; using {}x{} (set another with `image_size`)", image_size[0],
            image_size[1]);
  }

  std::vector<std::int64_t> in_order;
  for (const std::int64_t subject : subjects) {
    if (std::find(in_order.begin(), in_order.end(), subject) == in_order.end()) in_order.push_back(subject);
  }
  const Skeleton& joints = BenchmarkLayout(layout);
  BenchmarkBuilder builder(options, joints, joints, kUsualLayout);
  for (const std::int64_t subject : in_order) {
    std::vector<std::size_t> rows;
    for (std::size_t n = 0; n < subjects.size(); ++n) {
      if (subjects[n] == subject) rows.push_back(n);
    }
    Sequence sequence;
    sequence.name = sequence.subject = sequence.capture = fmt::format("S{}", subject);
    sequence.fps = options.fps;
    sequence.frame_count = static_cast<int>(rows.size());
    for (const Rows& camera : cameras) sequence.cameras.push_back(MakeView(camera, rows, scale, image_size));
    builder.Add(std::move(sequence), file);
  }
  return builder.Finish(scale);
}

}  // namespace canonpose
