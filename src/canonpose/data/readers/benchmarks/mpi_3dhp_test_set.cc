#include "canonpose/data/readers/benchmarks/mpi_3dhp_test_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/base/log.h"
#include "canonpose/data/readers/benchmarks/anatomy.h"
#include "canonpose/data/readers/benchmarks/builder.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTestJoints = 17;
/// Activities by number, from 1, with the names that the benchmark's evaluation uses.
constexpr std::array<const char*, 7> kActivities = {
    "Standing/Walking", "Exercising", "Sitting", "Reaching/Crouching", "On The Floor", "Sports", "Miscellaneous"};

/// The number in the last folder of the form "TS5"; 0 if there is none.
int TestSequenceOf(const fs::path& path) {
  int number = 0;
  for (const fs::path& part : fs::absolute(path).parent_path()) {
    const std::string name = part.string();
    if (name.size() == 3 && name.starts_with("TS") && name[2] >= '1' && name[2] <= '6') number = name[2] - '0';
  }
  return number;
}

void RequireHdf5(const fs::path& path) {
  std::error_code error;
  const std::string expected = "a MATLAB file of version 7.3, which is HDF5";
  if (!fs::exists(path, error))
    ThrowBadInput({path.string(), "", "a file", error ? error.message() : "nothing", "check the path"});
  if (h5::File::IsHdf5(path)) return;
  std::string start(10, '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), 10);
  const bool is_old = start == "MATLAB 5.0";
  ThrowBadInput(
      {path.string(), "", expected, is_old ? "one of version 5" : "another format",
       is_old ? "annot.mat of the training set is read by import 3dhp-train" : "give annot_data.mat as published"});
}

/// The values of an array that MATLAB or Python may have written: (N, 1, 17, axes), or these dimensions in reverse
/// order.
struct Annotation {
  std::size_t frames = 0;
  bool is_reversed = false;
  std::vector<double> values;  ///< (N, 17, axes)
};

Annotation ReadAnnotation(const h5::Group& root, const std::string& name, std::size_t axes) {
  const h5::Array<double> array = ReadNumbers(root, name);
  const std::vector<std::size_t>& shape = array.shape;
  Annotation annotation;
  const bool is_four = shape.size() == 4;
  annotation.is_reversed = is_four && shape[0] == axes && shape[1] == kTestJoints && shape[2] == 1;
  const bool is_direct = is_four && shape[1] == 1 && shape[2] == kTestJoints && shape[3] == axes;
  if (!is_direct && !annotation.is_reversed) {
    root.Fail(name, fmt::format("shape (N, 1, 17, {0}) = frames, person, joints, axes, or ({0}, 17, 1, N)", axes),
              h5::FormatShape(shape), "give annot_data.mat of the test set as published");
  }
  annotation.frames = is_direct ? shape[0] : shape[3];
  if (annotation.frames == 0) root.Fail(name, "at least one frame", "none", "");
  if (is_direct) {
    annotation.values = array.values;
    return annotation;
  }
  const std::size_t frames = annotation.frames;
  annotation.values.resize(array.values.size());
  for (std::size_t axis = 0; axis < axes; ++axis) {
    for (std::size_t joint = 0; joint < kTestJoints; ++joint) {
      for (std::size_t t = 0; t < frames; ++t) {
        annotation.values[(t * kTestJoints + joint) * axes + axis] =
            array.values[(axis * kTestJoints + joint) * frames + t];
      }
    }
  }
  return annotation;
}

/// One number per frame: (N, 1), (1, N) or (N).
std::vector<double> ReadPerFrame(const h5::Group& root, const std::string& name, std::size_t frames) {
  const h5::Array<double> array = ReadNumbers(root, name);
  if (array.values.size() != frames) {
    root.Fail(name, fmt::format("{} numbers, one per frame", frames), h5::FormatShape(array.shape), "");
  }
  return array.values;
}

void ReadActivities(const h5::Group& root, Sequence& sequence) {
  if (!root.Has("activity_annotation")) {
    LogWarning("{}: there is no activity_annotation, so actions are unknown", sequence.name);
    return;
  }
  sequence.actions.assign(kActivities.begin(), kActivities.end());
  for (const double value : ReadPerFrame(root, "activity_annotation", static_cast<std::size_t>(sequence.frame_count))) {
    if (!(value >= 1.0 && value <= static_cast<double>(kActivities.size())) || value != std::trunc(value)) {
      root.Fail("activity_annotation", fmt::format("whole numbers from 1 to {}", kActivities.size()),
                fmt::format("{}", value), "");
    }
    sequence.action.push_back(static_cast<std::uint8_t>(value - 1.0));
  }
}

/// Removes the truth of frames that are not valid, and their keypoints where these are not finite.
int LeaveOutInvalid(const std::vector<double>& valid, std::vector<double>& keypoints, std::vector<double>& poses) {
  int count = 0;
  for (std::size_t t = 0; t < valid.size(); ++t) {
    if (valid[t] != 0.0) {
      ++count;
      continue;
    }
    std::fill_n(poses.begin() + static_cast<std::ptrdiff_t>(t * kTestJoints * 3), kTestJoints * 3, std::nan(""));
    for (std::size_t i = t * kTestJoints * 2; i < (t + 1) * kTestJoints * 2; ++i) {
      if (!std::isfinite(static_cast<float>(keypoints[i]))) keypoints[i] = std::nan("");
    }
  }
  return count;
}

/// Checks only valid frames, since the others may contain anything. NaN is missing.
void RequireFiniteOrMissingWhere(const std::vector<double>& valid, const std::vector<double>& values, std::size_t axes,
                                 const fs::path& path, const std::string& name) {
  const auto size = static_cast<std::ptrdiff_t>(kTestJoints * axes);
  for (std::size_t t = 0; t < valid.size(); ++t) {
    if (valid[t] == 0.0) continue;
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(t) * size;
    RequireFiniteOrMissing({begin, begin + size}, kTestJoints, axes, path.string(),
                           fmt::format("/{}, frame {}", name, t));
  }
}

class TestSetImporter {
 public:
  explicit TestSetImporter(const BenchmarkOptions& options)
      : options_(options), truth_(options.truth.empty() ? "univ_annot3" : options.truth) {}

  Dataset Run() {
    const Skeleton& layout = BenchmarkLayout("3dhp-17");
    BenchmarkBuilder builder(options_, layout, layout, "h36m-17");
    for (const fs::path& path : FindFiles("annot_data.mat", options_.paths)) builder.Add(ReadSequence(path), path);
    LogInfo("truth is {}{}; the annotations have no confidences: all are 1", truth_,
            truth_ == "annot3"
                ? ", the original poses; published results compare with univ_annot3"
                : ", poses scaled to one height, with which published results compare (annot3: the original poses)");
    sides_.Warn();
    return builder.Finish();
  }

 private:
  Sequence ReadSequence(const fs::path& path) {
    RequireHdf5(path);
    h5::File file = h5::File::OpenForReading(path);
    const h5::Group& root = file.root();
    Annotation keypoints = ReadAnnotation(root, "annot2", 2);
    Annotation poses = ReadAnnotation(root, truth_, 3);
    if (poses.frames != keypoints.frames) {
      root.Fail(truth_, fmt::format("{} frames as in annot2", keypoints.frames), fmt::format("{}", poses.frames), "");
    }
    Sequence sequence;
    const int number = TestSequenceOf(path);
    sequence.name = number > 0 ? fmt::format("TS{}", number) : fs::absolute(path).parent_path().filename().string();
    if (sequence.name.empty()) sequence.name = path.stem().string();
    sequence.subject = sequence.capture = sequence.name;
    sequence.fps = options_.fps;
    sequence.truth_kind = truth_;
    sequence.frame_count = static_cast<int>(keypoints.frames);
    ReadActivities(root, sequence);
    const std::vector<double> valid = ReadPerFrame(root, "valid_frame", keypoints.frames);
    RequireFiniteOrMissingWhere(valid, keypoints.values, 2, path, "annot2");
    RequireFiniteOrMissingWhere(valid, poses.values, 3, path, truth_);
    const int valid_count = LeaveOutInvalid(valid, keypoints.values, poses.values);
    RequirePixels(keypoints.values, path.string(), "/annot2");
    LogInfo("{}: {} of {} frames are valid and have truth; arrays are {}", sequence.name, valid_count, keypoints.frames,
            keypoints.is_reversed ? "in MATLAB's order, axes first" : "frames first");
    sequence.cameras = {MakeView(std::move(keypoints.values), poses.values, ImageSize(number, path), path)};
    sides_.Add(CheckSides(BenchmarkLayout("3dhp-17"), sequence.cameras.front().truth.positions()), sequence.name);
    return sequence;
  }

  CameraView MakeView(std::vector<double> keypoints, const std::vector<double>& poses,
                      const std::array<int, 2>& image_size, const fs::path& path) const {
    const PoseUnit unit = DetectUnit(BenchmarkLayout("3dhp-17"), ToFloats(poses), path.string(), truth_);
    ReportUnit(unit, fmt::format("{}: {}", path.string(), truth_));
    CameraView view;
    view.name = "camera";
    view.image_size = image_size;
    view.confidence.assign(keypoints.size() / 2, 1.0F);
    MarkMissing(keypoints, view.confidence);
    view.keypoints = ToFloats(keypoints);
    view.truth = TruthPoses(BenchmarkLayout("3dhp-17"), ToFloats(poses, unit.mm_per_unit), view.name);
    return view;
  }

  [[nodiscard]] std::array<int, 2> ImageSize(int number, const fs::path& path) const {
    if (options_.image_size[0] > 0) return options_.image_size;
    if (number == 0) {
      ThrowBadInput({path.string(), "", "a folder TS1 to TS6, from which the image size is known", "another",
                     "give `image_size` WxH, or the file in the benchmark's original folder"});
    }
    if (number >= 5) return {1920, 1080};
    return {2048, 2048};
  }

  const BenchmarkOptions& options_;
  std::string truth_;
  SideReport sides_;
};

}  // namespace

Dataset ImportMpi3dhpTest(const BenchmarkOptions& options) { return TestSetImporter(options).Run(); }

}  // namespace canonpose
