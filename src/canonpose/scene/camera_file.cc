#include "canonpose/scene/camera_file.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

namespace canonpose {
namespace {

/// One matrix or T of them, each of `size` values; `tail` is the shape of one.
std::vector<double> ReadCalibrationArray(const h5::Group& group, const std::string& name,
                                         const std::vector<std::size_t>& tail, int frame_count, std::size_t* rows) {
  h5::Array<double> array = group.Read<double>(name);
  std::vector<std::size_t> moving = tail;
  moving.insert(moving.begin(), static_cast<std::size_t>(frame_count));
  if (array.shape != tail && array.shape != moving) {
    group.Fail(name, fmt::format("shape {} or {}", h5::FormatShape(tail), h5::FormatShape(moving)),
               h5::FormatShape(array.shape), "");
  }
  for (const double value : array.values) {
    if (!std::isfinite(value)) group.Fail(name, "finite numbers", fmt::format("{}", value), "");
  }
  *rows = array.shape == tail ? 1 : moving.front();
  return std::move(array.values);
}

void CheckCamera(const h5::Group& group, const Camera& camera, const std::string& prefix) {
  const Eigen::Matrix3d& K = camera.K;
  if (!(K(0, 0) > 0.0) || !(K(1, 1) > 0.0) || K(2, 2) != 1.0 || K(1, 0) != 0.0 || K(2, 0) != 0.0 || K(2, 1) != 0.0) {
    group.Fail(prefix + "K", "[[fx, s, cx], [0, fy, cy], [0, 0, 1]] with positive focal lengths in pixels",
               "something else", "");
  }
  constexpr double kTolerance = 1e-3;
  const Eigen::Matrix3d& R = camera.camera_from_world_rotation;
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kTolerance || R.determinant() < 0.0) {
    group.Fail(
        prefix + "R", "a rotation matrix, x_camera = R * x_world + t",
        error > kTolerance ? fmt::format("rows that are not orthonormal (off by {:.2g})", error) : "a reflection", "");
  }
}

/// The shape of one value per frame, or of a single one that all frames share.
std::vector<std::size_t> WithRows(std::size_t rows, std::vector<std::size_t> tail) {
  if (rows > 1) tail.insert(tail.begin(), rows);
  return tail;
}

void Write(h5::Group& group, const std::string& name, const std::vector<double>& values,
           const std::vector<std::size_t>& shape) {
  group.Write<double>(name, std::span<const double>(values), shape);
}

}  // namespace

std::vector<Camera> ReadCameras(const h5::Group& group, int frame_count, const std::string& prefix) {
  const std::string K_name = prefix + "K";
  const std::string R_name = prefix + "R";
  const std::string t_name = prefix + "t";
  const std::string distortion_name = prefix + "distortion";
  const bool any = group.Has(K_name) || group.Has(R_name) || group.Has(t_name) || group.Has(distortion_name);
  if (!any) return {};
  for (const std::string& name : {K_name, R_name, t_name}) {
    if (group.Has(name)) continue;
    group.Fail(name, fmt::format("{}, {} and {} together", K_name, R_name, t_name), "nothing",
               "write all of the calibration or none");
  }
  std::size_t k_rows = 1;
  std::size_t r_rows = 1;
  std::size_t t_rows = 1;
  std::size_t distortion_rows = 1;
  const std::vector<double> K = ReadCalibrationArray(group, K_name, {3, 3}, frame_count, &k_rows);
  const std::vector<double> R = ReadCalibrationArray(group, R_name, {3, 3}, frame_count, &r_rows);
  const std::vector<double> t = ReadCalibrationArray(group, t_name, {3}, frame_count, &t_rows);
  std::vector<double> distortion(4, 0.0);
  std::size_t coefficients = 4;
  if (group.Has(distortion_name)) {
    const std::vector<std::size_t> shape = group.Shape(distortion_name);
    if (!shape.empty() && shape.back() == 5) coefficients = 5;
    distortion = ReadCalibrationArray(group, distortion_name, {coefficients}, frame_count, &distortion_rows);
  }
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  std::vector<Camera> cameras(std::max({k_rows, r_rows, t_rows, distortion_rows}));
  const auto row = [](std::size_t rows, std::size_t i) { return rows == 1 ? 0 : i; };
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    cameras[i].K = Eigen::Map<const RowMajor>(&K[9 * row(k_rows, i)]);
    cameras[i].camera_from_world_rotation = Eigen::Map<const RowMajor>(&R[9 * row(r_rows, i)]);
    cameras[i].camera_from_world_translation = Eigen::Map<const Eigen::Vector3d>(&t[3 * row(t_rows, i)]);
    std::copy_n(&distortion[coefficients * row(distortion_rows, i)], coefficients, cameras[i].distortion.begin());
    CheckCamera(group, cameras[i], prefix);
  }
  return cameras;
}

void WriteCameras(h5::Group& group, const std::vector<Camera>& cameras, const std::string& prefix) {
  if (cameras.empty()) return;
  std::vector<double> K;
  std::vector<double> R;
  std::vector<double> t;
  std::vector<double> distortion;
  bool same_K = true;
  bool same_distortion = true;
  // Four, as readers of the first files know them, unless there is a fifth.
  const bool has_k3 =
      std::any_of(cameras.begin(), cameras.end(), [](const Camera& c) { return c.distortion[4] != 0.0; });
  const std::size_t coefficients = has_k3 ? 5 : 4;
  for (const Camera& camera : cameras) {
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        K.push_back(camera.K(r, c));
        R.push_back(camera.camera_from_world_rotation(r, c));
      }
      t.push_back(camera.camera_from_world_translation[r]);
    }
    distortion.insert(distortion.end(), camera.distortion.begin(),
                      camera.distortion.begin() + static_cast<std::ptrdiff_t>(coefficients));
    same_K &= camera.K == cameras.front().K;
    same_distortion &= camera.distortion == cameras.front().distortion;
  }
  const std::size_t K_rows = same_K ? 1 : cameras.size();
  const std::size_t distortion_rows = same_distortion ? 1 : cameras.size();
  K.resize(9 * K_rows);
  distortion.resize(coefficients * distortion_rows);
  Write(group, prefix + "K", K, WithRows(K_rows, {3, 3}));
  Write(group, prefix + "R", R, WithRows(cameras.size(), {3, 3}));
  Write(group, prefix + "t", t, WithRows(cameras.size(), {3}));
  Write(group, prefix + "distortion", distortion, WithRows(distortion_rows, {coefficients}));
}

}  // namespace canonpose
