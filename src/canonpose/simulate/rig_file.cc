#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include <Eigen/LU>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"
#include "canonpose/simulate/rig_parts.h"

namespace canonpose {
namespace {

/// Rotations must be written with at least five digits.
constexpr double kRotationTolerance = 1e-4;

Eigen::Vector3d Vector3(const JsonValue& value) {
  const std::vector<double> numbers = value.Numbers();
  if (numbers.size() != 3) value.Fail("3 values", "", fmt::format("{}", numbers.size()));
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Matrix3d Matrix3(const JsonValue& value) {
  if (value.ArraySize() != 3) value.Fail("3 rows of 3 values");
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) matrix.row(row) = Vector3(value.At(static_cast<std::size_t>(row))).transpose();
  return matrix;
}

Eigen::Matrix3d Rotation(const JsonValue& value) {
  const Eigen::Matrix3d rotation = Matrix3(value);
  const double error = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kRotationTolerance) {
    value.Fail("a rotation, camera_from_world", "write it with at least six digits; rows are the camera's x, y, z",
               fmt::format("a matrix whose rows are not orthonormal (R R^T is off by {:.2g})", error));
  }
  if (rotation.determinant() < 0.0) {
    value.Fail("a rotation with determinant +1", "flip one axis: x points right, y down, z forward",
               "a reflection (determinant -1)");
  }
  return rotation;
}

Eigen::Matrix3d Intrinsics(const JsonValue& value) {
  const Eigen::Matrix3d K = Matrix3(value);
  if (!(K(0, 0) > 0.0 && K(1, 1) > 0.0)) {
    value.Fail("focal lengths above 0", "", fmt::format("fx {:g}, fy {:g}", K(0, 0), K(1, 1)));
  }
  if (K(1, 0) != 0.0 || K(2, 0) != 0.0 || K(2, 1) != 0.0 || K(2, 2) != 1.0) {
    value.Fail("[[fx, s, cx], [0, fy, cy], [0, 0, 1]]", "rows of K, not columns", "another matrix");
  }
  return K;
}

std::array<int, 2> ImageSize(const JsonValue& value) {
  if (value.ArraySize() != 2) value.Fail("width and height");
  std::array<int, 2> size{};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::int64_t pixels = value.At(i).Integer();
    if (pixels < 1 || pixels > 100'000) {
      value.At(i).Fail("a number of pixels, 1 to 100000", "", fmt::format("{}", pixels));
    }
    size[i] = static_cast<int>(pixels);
  }
  return size;
}

/// How deeply arrays are nested: 1 for [..], 2 for [[..]].
int Depth(const JsonValue& value) {
  int depth = 0;
  const nlohmann::json* inner = &value.json();
  for (; inner->is_array() && !inner->empty(); inner = &inner->front()) ++depth;
  return depth;
}

/// Calls `read` on a value that all frames share, or, if there is one more level of arrays, on the value of each frame.
/// Returns the number of frames, 1 for a shared value.
std::size_t ReadFrames(const JsonValue& value, int own_depth, const std::function<void(const JsonValue&)>& read) {
  if (Depth(value) <= own_depth) {
    read(value);
    return 1;
  }
  const std::size_t frames = value.ArraySize();
  for (std::size_t t = 0; t < frames; ++t) read(value.At(t));
  return frames;
}

void CheckFrames(const JsonValue& value, std::size_t frames, std::size_t found) {
  if (found == 1 || found == frames) return;
  value.Fail(fmt::format("{} frames, as many as the camera's other parts have", frames),
             "give each part once, or once per frame", fmt::format("{}", found));
}

/// R and t, or K, that change over time: as many cameras as there are frames.
std::vector<Camera> ReadCalibrated(const JsonValue& value) {
  std::vector<Eigen::Matrix3d> K;
  std::vector<Eigen::Matrix3d> R;
  std::vector<Eigen::Vector3d> t;
  ReadFrames(value["K"], 2, [&](const JsonValue& v) { K.push_back(Intrinsics(v)); });
  ReadFrames(value["R"], 2, [&](const JsonValue& v) { R.push_back(Rotation(v)); });
  ReadFrames(value["t"], 1, [&](const JsonValue& v) { t.push_back(Vector3(v)); });
  const std::size_t frames = std::max({K.size(), R.size(), t.size()});
  CheckFrames(value["K"], frames, K.size());
  CheckFrames(value["R"], frames, R.size());
  CheckFrames(value["t"], frames, t.size());
  std::vector<Camera> cameras(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    cameras[i].K = K[K.size() == 1 ? 0 : i];
    cameras[i].camera_from_world_rotation = R[R.size() == 1 ? 0 : i];
    cameras[i].camera_from_world_translation = t[t.size() == 1 ? 0 : i];
  }
  return cameras;
}

Camera ReadLookingAt(const JsonValue& value, std::array<int, 2> image_size) {
  for (const char* key : {"K", "R", "t"}) {
    if (const std::optional<JsonValue> other = value.Find(key)) {
      other->Fail("none of these together with position_m", "give K, R and t, or position_m, look_at_m and focal_px");
    }
  }
  const Eigen::Vector3d position = 1000.0 * Vector3(value["position_m"]);
  const Eigen::Vector3d target = 1000.0 * Vector3(value["look_at_m"]);
  const double focal_px = value["focal_px"].Number();
  if (!(focal_px > 0.0)) value["focal_px"].Fail("a focal length above 0", "", fmt::format("{:g}", focal_px));
  if ((target - position).norm() < 1.0) value["look_at_m"].Fail("a point other than position_m");
  Camera camera;
  camera.K << focal_px, 0.0, image_size[0] / 2.0, 0.0, focal_px, image_size[1] / 2.0, 0.0, 0.0, 1.0;
  const std::optional<JsonValue> roll = value.Find("roll_deg");
  Aim(position, target, roll ? RadFromDeg(roll->Number()) : 0.0, camera);
  return camera;
}

FilmingCamera ReadCamera(const JsonValue& value) {
  FilmingCamera filming;
  filming.name = value["name"].String();
  const bool is_plain = std::none_of(filming.name.begin(), filming.name.end(),
                                     [](unsigned char c) { return c == '/' || std::iscntrl(c) != 0; });
  if (filming.name.empty() || filming.name == "." || filming.name == ".." || !is_plain) {
    value["name"].Fail("a name without '/' that can name a folder", "", fmt::format("\"{}\"", filming.name));
  }
  filming.image_size = ImageSize(value["image_size"]);
  if (value.Has("position_m")) {
    filming.cameras = {ReadLookingAt(value, filming.image_size)};
  } else {
    filming.cameras = ReadCalibrated(value);
  }
  if (const std::optional<JsonValue> distortion = value.Find("distortion")) {
    const std::vector<double> numbers = distortion->Numbers();
    if (numbers.size() != 4 && numbers.size() != 5)
      distortion->Fail("4 or 5 values (k1, k2, p1, p2, k3)", "", fmt::format("{}", numbers.size()));
    for (Camera& camera : filming.cameras) std::copy(numbers.begin(), numbers.end(), camera.distortion.begin());
  }
  return filming;
}

/// Cameras whose parameters over time are given by a file.
class MovingFileRig : public Rig {
 public:
  MovingFileRig(std::string file, std::vector<FilmingCamera> cameras)
      : file_(std::move(file)), cameras_(std::move(cameras)) {}
  [[nodiscard]] bool is_static() const override { return false; }

  [[nodiscard]] std::vector<FilmingCamera> Film(const LandmarkTrack& track, Rng /*rng*/) const override {
    std::vector<FilmingCamera> filming = cameras_;
    const auto frames = static_cast<std::size_t>(track.frame_count());
    for (std::size_t i = 0; i < filming.size(); ++i) {
      std::vector<Camera>& cameras = filming[i].cameras;
      if (cameras.size() == 1) continue;
      if (cameras.size() < frames) {
        ThrowBadInput({file_, fmt::format("cameras[{}]", i),
                       fmt::format("at least the {} frames of clip {}", frames, track.name),
                       fmt::format("{}", cameras.size()), "give the camera more frames or make the clips shorter"});
      }
      cameras.resize(frames);
    }
    return filming;
  }

 private:
  std::string file_;
  std::vector<FilmingCamera> cameras_;
};

}  // namespace

std::unique_ptr<Rig> ReadRigFile(const std::filesystem::path& path) {
  const JsonValue root = JsonValue::Load(path);
  const JsonValue list = root["cameras"];
  const std::size_t count = list.ArraySize();
  if (count < 2) list.Fail("at least 2 cameras", "nothing can be learned from a single view", fmt::format("{}", count));
  std::vector<FilmingCamera> cameras;
  std::set<std::string> names;
  std::size_t frames = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue value = list.At(i);
    FilmingCamera camera = ReadCamera(value);
    if (!names.insert(camera.name).second) {
      value["name"].Fail("another name", "rename one of the two cameras", fmt::format("{} again", camera.name));
    }
    const std::size_t own = camera.cameras.size();
    if (own > 1 && frames > 1 && own != frames) {
      value.Fail(fmt::format("{} frames, as many as the previous cameras", frames), "", fmt::format("{}", own));
    }
    frames = std::max(frames, own);
    cameras.push_back(std::move(camera));
  }
  if (frames > 1) return std::make_unique<MovingFileRig>(path.string(), std::move(cameras));
  return std::make_unique<StaticRig>(std::move(cameras));
}

}  // namespace canonpose
