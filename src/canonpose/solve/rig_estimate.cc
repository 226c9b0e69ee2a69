#include "canonpose/solve/rig_estimate.h"

#include <algorithm>

namespace canonpose {

RigEstimate RigEstimate::Unknown(bool static_cameras, int frames, int views, int joints, int subjects) {
  RigEstimate estimate;
  estimate.static_cameras = static_cameras;
  estimate.view_count = views;
  estimate.joint_count = joints;
  estimate.cameras.resize(static_cast<std::size_t>(static_cameras ? views : frames * views));
  estimate.joints.assign(static_cast<std::size_t>(frames) * static_cast<std::size_t>(joints),
                         Eigen::Vector3d::Constant(std::nan("")));
  estimate.log_bone_lengths.assign(static_cast<std::size_t>(subjects),
                                   std::vector<double>(static_cast<std::size_t>(joints), std::nan("")));
  return estimate;
}

double RigEstimate::ImageScale(int frame, int view, int root) const {
  const CameraEstimate& camera = CameraAt(frame, view);
  if (!static_cameras) return std::exp(camera.placement[2]);
  if (Joint(frame, root).allFinite()) return camera.Focal() / InCamera(frame, view, root).z();
  double depth = 0.0;
  int count = 0;
  for (int j = 0; j < joint_count; ++j) {
    if (!Joint(frame, j).allFinite()) continue;
    depth += InCamera(frame, view, j).z();
    ++count;
  }
  return camera.Focal() * count / depth;
}

std::vector<int> RigEstimate::ValidViews(int frame) const {
  std::vector<int> valid;
  for (int v = 0; v < view_count; ++v) {
    if (CameraAt(frame, v).valid) valid.push_back(v);
  }
  return valid;
}

RigEstimate RigEstimate::Slice(int first, int count) const {
  RigEstimate slice = Unknown(static_cameras, count, view_count, joint_count, 0);
  slice.first_frame = first;
  slice.log_bone_lengths = log_bone_lengths;
  if (static_cameras) slice.cameras = cameras;
  slice.Adopt(*this, first, count);
  return slice;
}

void RigEstimate::Adopt(const RigEstimate& slice, int first, int count) {
  std::copy_n(&slice.Joint(first, 0), count * joint_count, &Joint(first, 0));
  if (!static_cameras) std::copy_n(&slice.CameraAt(first, 0), count * view_count, &CameraAt(first, 0));
}

}  // namespace canonpose
