// The page that shows scenes: one HTML file with its program and data in it, which a browser opens without a network.
#pragma once

#include <string>
#include <vector>

#include "canonpose/view/page_content.h"

namespace canonpose {

/// The page. Several results are shown side by side, the later ones turned, moved and scaled to lie upon the first.
///
/// The data are a JSON object (`canonpose-data`, which says what there is) and a gzip file in base64
/// (`canonpose-arrays`: packed_arrays.h). Positions are rounded to about 0.2 mm of an adult, keypoints to 1/8192 of the
/// image's diagonal (a quarter of a pixel at 1920x1080).
std::string MakePage(const std::vector<ShownResult>& results);

}  // namespace canonpose
