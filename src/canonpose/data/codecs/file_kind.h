// Recognises files that are of no use to a reader of keypoints, so that messages can say what was given instead.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace canonpose {

/// What a file is according to its first bytes: "a video", "an image", "an HDF5 file", "a NumPy file", "a zip archive",
/// ...; empty where they say nothing, as with text.
std::string KindOfBytes(std::string_view first_bytes);

/// The same for a file, by its first bytes or, where these say nothing, by the extension of a video. Empty where it
/// cannot be read.
std::string KindOfFile(const std::filesystem::path& path);

/// What to do about a file of this kind where keypoints are expected; empty for an unknown kind.
std::string AdviceForKind(std::string_view kind);

}  // namespace canonpose
