#include "canonpose/data/dataset_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

void DatasetPlace::Fail(const std::string& array, std::size_t frame, std::size_t joint, const std::string& expected,
                        float found, const std::string& advice) const {
  ThrowBadInput({file, fmt::format("{}/{}, frame {}, joint {}", group, array, frame, skeleton->joints[joint]), expected,
                 fmt::format("{}", found), advice});
}

void CheckKeypoints(const DatasetPlace& place, std::vector<float>& keypoints, std::vector<float>& confidence) {
  const std::size_t joints = place.skeleton->joints.size();
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    float* pixel = &keypoints[2 * i];
    float& seen = confidence[i];
    for (int axis = 0; axis < 2; ++axis) {
      if (std::isinf(pixel[axis])) {
        place.Fail("keypoints", i / joints, i % joints, "a pixel, or NaN where not detected", pixel[axis],
                   "write NaN and confidence 0 where a joint was not detected");
      }
    }
    if (!(seen >= 0.0F && seen <= 1.0F)) {
      place.Fail("confidence", i / joints, i % joints, "a number from 0 to 1", seen,
                 "divide by the detector's largest possible confidence, and write 0 where not detected");
    }
    if (seen == 0.0F || std::isnan(pixel[0]) || std::isnan(pixel[1])) {
      pixel[0] = pixel[1] = kNaN;
      seen = 0.0F;
    }
  }
}

void CheckPoses(std::vector<float>& poses, const std::string& array, const DatasetPlace& place) {
  const std::size_t joints = place.skeleton->joints.size();
  for (std::size_t i = 0; 3 * i < poses.size(); ++i) {
    bool unknown = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = poses[3 * i + axis];
      if (std::isinf(value)) {
        place.Fail(array, i / joints, i % joints, "a coordinate, or NaN where unknown", value,
                   "write NaN where unknown");
      }
      unknown |= std::isnan(value);
    }
    if (unknown) std::fill_n(&poses[3 * i], 3, kNaN);
  }
}

std::vector<float> ReadArray(const h5::Group& group, const std::string& name, const std::vector<std::size_t>& shape,
                             const std::string& meaning) {
  const std::vector<std::size_t> found = group.Shape(name);
  if (found != shape) {
    group.Fail(name, fmt::format("shape {} = {}", h5::FormatShape(shape), meaning), h5::FormatShape(found), "");
  }
  return group.Read<float>(name).values;
}

}  // namespace canonpose
