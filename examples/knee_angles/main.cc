// knee_angles DATA.h5: finds the 3D poses of a recording from its keypoints alone and prints, for each camera's view of
// them, how far the right knee bends.
#include <iostream>
#include <vector>

#include <canonpose/analyse/analysis.h>
#include <canonpose/base/error.h>
#include <canonpose/pipeline/bootstrap.h>
#include <canonpose/solve/solver.h>

namespace {

void PrintKneeAngles(const canonpose::Dataset& dataset) {
  for (const canonpose::Sequence& sequence : dataset.sequences) {
    std::vector<std::vector<double>> knees;  // of each camera's view
    for (const canonpose::CameraView& view : sequence.cameras) {
      if (view.solved.empty()) continue;  // a camera that was left out
      const canonpose::Analysis analysis = canonpose::Analyse(view.solved, false);
      knees.push_back(canonpose::FindSeries(analysis.angles, "knee_angle_r")->values);
    }
    for (int frame = 0; frame < sequence.frame_count; ++frame) {
      std::cout << sequence.name << ' ' << frame;
      for (const std::vector<double>& knee : knees) std::cout << ' ' << knee.at(frame);
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
