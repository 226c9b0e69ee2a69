#include "canonpose/data/image_size_check.h"

#include <algorithm>
#include <cmath>

namespace canonpose {
namespace {

constexpr std::size_t kMinKeypoints = 100;
/// The share of keypoints that a detector places beyond the border, and how far, as a fraction of the image.
constexpr double kShareBeyond = 0.01;
constexpr double kBeyond = 0.02;
/// The centre of the keypoints must be this much nearer to that of the image, as a fraction of the image.
constexpr double kNearer = 0.08;

struct Extent {
  std::array<double, 2> low{};
  std::array<double, 2> centre{};
  std::array<double, 2> high{};
};

Extent ExtentOf(std::array<std::vector<float>, 2>& coordinates) {
  Extent extent;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<float>& values = coordinates[axis];
    std::ranges::sort(values);
    const auto at = [&](double share) {
      return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
    };
    extent.low[axis] = at(kShareBeyond);
    extent.centre[axis] = at(0.5);
    extent.high[axis] = at(1.0 - kShareBeyond);
  }
  return extent;
}

bool Holds(const std::array<int, 2>& size, const Extent& extent) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (extent.low[axis] < -kBeyond * size[axis] || extent.high[axis] > (1.0 + kBeyond) * size[axis]) return false;
  }
  return true;
}

/// The distance of the keypoints' centre from that of the image, as a fraction of the image.
double OffCentre(const std::array<int, 2>& size, const Extent& extent) {
  return std::hypot(extent.centre[0] / size[0] - 0.5, extent.centre[1] / size[1] - 0.5);
}

}  // namespace

std::vector<OtherImageSize> OtherImageSizes(std::span<const float> keypoints, const std::array<int, 2>& declared,
                                            double min_off_centre) {
  std::array<std::vector<float>, 2> coordinates;
  for (std::size_t i = 0; i + 1 < keypoints.size(); i += 2) {
    if (!std::isfinite(keypoints[i]) || !std::isfinite(keypoints[i + 1])) continue;
    coordinates[0].push_back(keypoints[i]);
    coordinates[1].push_back(keypoints[i + 1]);
  }
  if (coordinates[0].size() < kMinKeypoints) return {};
  const Extent extent = ExtentOf(coordinates);
  if (OffCentre(declared, extent) < min_off_centre) return {};
  std::vector<OtherImageSize> candidates;
  if (declared[0] != declared[1]) candidates.push_back({{declared[1], declared[0]}, true, 1.0});
  for (const double scale : {1.0 / 2.0, 2.0 / 3.0, 1.0 / 3.0, 3.0 / 2.0, 2.0, 3.0}) {
    const auto scaled = [&](int length) { return static_cast<int>(std::lround(scale * length)); };
    candidates.push_back({{scaled(declared[0]), scaled(declared[1])}, false, scale});
  }
  std::erase_if(candidates, [&](const OtherImageSize& other) {
    return !Holds(other.size, extent) || OffCentre(other.size, extent) + kNearer > OffCentre(declared, extent);
  });
  return candidates;
}

}  // namespace canonpose
