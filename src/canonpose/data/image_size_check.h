// Whether keypoints fit the declared size of their image.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace canonpose {

using ImageSize = std::array<int, 2>;  ///< width, height in pixels

/// Other sizes that the image may have had, the most usual first: width and height exchanged, the size of a video that
/// was scaled down before detection, or up. A size is returned if nearly all keypoints lie in such an image and if
/// they lie about its centre rather than that of the declared one. Cameras follow the person, so this rarely
/// holds for the wrong size; it is no proof. `keypoints` is (N, 2) pixels; those with NaN are not looked at.
std::vector<ImageSize> OtherImageSizes(std::span<const float> keypoints, const ImageSize& declared);

}  // namespace canonpose
