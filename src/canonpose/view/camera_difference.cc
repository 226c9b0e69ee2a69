#include "canonpose/view/camera_difference.h"

#include <cmath>
#include <limits>
#include <utility>

#include "canonpose/base/median.h"
#include "canonpose/view/display_frame.h"

namespace canonpose {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Distances {
  std::vector<double> px;
  std::vector<double> percent;
  std::vector<std::vector<double>> by_frame;  ///< (T)
  std::vector<std::vector<double>> by_joint;  ///< (J of the first person)
};

void AddPerson(const SceneCamera& camera, const PoseSequence& person, const ViewKeypoints& detections,
               Distances& distances) {
  const double bones = BoneLengthSum(person);
  const double frame_offset = camera.time_offset_seconds * person.fps;
  const int joints = person.joint_count();
  for (int t = 0; t < person.frame_count(); ++t) {
    const Camera& calibration = camera.At(t);
    for (int j = 0; j < joints; ++j) {
      const auto i = static_cast<std::size_t>(t) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(j);
      if (!(detections.confidence[i] > 0.0F)) continue;
      const Eigen::Vector3d in_camera = calibration.InCamera(JointAt(person, t + frame_offset, j));
      const Eigen::Vector2d found(detections.keypoints[2 * i], detections.keypoints[2 * i + 1]);
      const double px = (calibration.ProjectFromCamera(in_camera) - found).norm();
      if (!std::isfinite(px)) continue;
      distances.px.push_back(px);
      if (bones > 0.0) distances.percent.push_back(100.0 * px * in_camera.z() / (calibration.K(0, 0) * bones));
      distances.by_frame[static_cast<std::size_t>(t)].push_back(px);
      if (static_cast<std::size_t>(j) < distances.by_joint.size())
        distances.by_joint[static_cast<std::size_t>(j)].push_back(px);
    }
  }
}

}  // namespace

Eigen::Vector3d JointAt(const PoseSequence& person, double frame, int joint) {
  const double whole = std::floor(frame);
  const auto first = static_cast<int>(whole);
  const auto share = static_cast<float>(frame - whole);
  const int second = share > 0.0F ? first + 1 : first;
  if (first < 0 || second >= person.frame_count()) return Eigen::Vector3d::Constant(kNaN);
  return ((1.0F - share) * person.PoseAt(first).row(joint) + share * person.PoseAt(second).row(joint))
      .transpose()
      .cast<double>();
}

std::vector<CameraDifference> CompareCameras(const ShownScene& shown) {
  const Scene& scene = shown.scene;
  std::vector<CameraDifference> differences(scene.cameras.size());
  const auto frames = static_cast<std::size_t>(scene.people.empty() ? 0 : scene.people.front().frame_count());
  const auto joints = static_cast<std::size_t>(scene.people.empty() ? 0 : scene.people.front().joint_count());
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    Distances distances;
    distances.by_frame.resize(frames);
    distances.by_joint.resize(joints);
    for (std::size_t p = 0; p < shown.detections.size(); ++p) {
      const ViewKeypoints& detections = shown.detections[p][c];
      if (!detections.empty() && !scene.cameras[c].calibration.empty()) {
        AddPerson(scene.cameras[c], scene.people[p], detections, distances);
      }
    }
    CameraDifference& difference = differences[c];
    for (std::vector<double>& of_frame : distances.by_frame) {
      difference.by_frame_px.push_back(static_cast<float>(Median(std::move(of_frame))));
    }
    for (std::vector<double>& of_joint : distances.by_joint) {
      difference.by_joint_px.push_back(static_cast<float>(Median(std::move(of_joint))));
    }
    difference.median_px = Median(std::move(distances.px));
    difference.median_percent = Median(std::move(distances.percent));
  }
  return differences;
}

}  // namespace canonpose
