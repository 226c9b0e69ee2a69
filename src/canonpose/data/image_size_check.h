// Whether keypoints fit the declared size of their image.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace canonpose {

struct OtherImageSize {
  std::array<int, 2> size;  ///< width and height in pixels
  bool is_turned;           ///< the declared width and height exchanged
  double scale;             ///< of the declared size
};

/// Other sizes that the image may have had, the most usual first: width and height exchanged, the size of a video that
/// was scaled down before detection, or up. A size is returned if nearly all keypoints lie in such an image and if they
/// lie about its centre rather than that of the declared one, from which their median is at least `min_off_centre` away
/// (a fraction of the image). Cameras follow the person, so this rarely holds for a wrong size; it is no proof.
/// `keypoints` is (N, 2) pixels; those with NaN are not looked at.
std::vector<OtherImageSize> OtherImageSizes(std::span<const float> keypoints, const std::array<int, 2>& declared,
                                            double min_off_centre);

}  // namespace canonpose
