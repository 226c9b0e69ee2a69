// Times the networks of `detect`, for benchmarks/detect: detect_networks MODELS REPEATS. Prints the best milliseconds
// of a crop of 256x256 and of an image of 512x512 pixels as JSON.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>

#include "canonpose/detect/movenet.h"
#include "canonpose/model/runtime.h"

namespace {

template <typename Work>
double BestMilliseconds(int repeats, const Work& work) {
  using Clock = std::chrono::steady_clock;
  work();  // fills the memory that is used again
  double best = 1e9;
  for (int i = 0; i < repeats; ++i) {
    const Clock::time_point start = Clock::now();
    work();
    best = std::min(best, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const int repeats = std::atoi(argv[2]);
  const canonpose::ThreadScope one_thread(1);
  canonpose::MoveNet network(canonpose::MoveNetFiles::Read(argv[1]));
  const cv::Mat image(512, 512, CV_8UC3, cv::Scalar());
  const double crop = BestMilliseconds(repeats, [&] { (void)network.PoseInCrop(image, {{100.0F, 100.0F}, 256.0F}); });
  const double whole = BestMilliseconds(repeats, [&] { (void)network.FindPeople(image); });
  std::cout << "{\"crop\": " << crop << ", \"image\": " << whole << "}\n";
  return 0;
}
