// knee_angles DATA.h5: finds the 3D poses of a recording from its keypoints alone and prints, for each camera's view of
// them, how far the right knee bends.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>

#include <canonpose/base/error.h>
#include <canonpose/pipeline/bootstrap.h>
#include <canonpose/solve/solver.h>

namespace {

using Pose = Eigen::Map<const canonpose::PoseSequence::Pose>;

/// Degrees that the joint between two limbs is away from straight; NaN where a joint is unknown.
double BendDeg(const Pose& pose, int above, int joint, int below) {
  const Eigen::RowVector3f upper = pose.row(joint) - pose.row(above);
  const Eigen::RowVector3f lower = pose.row(below) - pose.row(joint);
  const double cosine = upper.normalized().dot(lower.normalized());
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

void PrintKneeAngles(const canonpose::Dataset& dataset) {
  const canonpose::Skeleton& skeleton = dataset.skeleton;
  const int hip = skeleton.Find("RHip").value();
  const int knee = skeleton.Find("RKnee").value();
  const int ankle = skeleton.Find("RFoot").value();
  for (const canonpose::Sequence& sequence : dataset.sequences) {
    for (int frame = 0; frame < sequence.frame_count; ++frame) {
      std::cout << sequence.name << ' ' << frame;
      for (const canonpose::CameraView& view : sequence.cameras) {
        std::cout << ' ' << BendDeg(view.solved.PoseAt(frame), hip, knee, ankle);
      }
      std::cout << '\n';
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: knee_angles DATA.h5\n";
    return 2;
  }
  try {
    canonpose::Dataset dataset = canonpose::ReadDataset(argv[1]);
    canonpose::Solve(dataset, canonpose::Bootstrap(dataset, argv[1], {}), {});
    PrintKneeAngles(dataset);
  } catch (const canonpose::Error& error) {
    std::cerr << argv[1] << ": " << error.what() << '\n';
    return 1;
  }
}
