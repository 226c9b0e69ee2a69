#include "canonpose/data/codecs/file_kind.h"

#include <algorithm>
#include <array>
#include <fstream>

#include "canonpose/base/names.h"

namespace canonpose {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kVideo = "a video";
constexpr std::string_view kImage = "an image";
constexpr std::string_view kHdf5 = "an HDF5 file";
constexpr std::string_view kNumPy = "a NumPy file";
constexpr std::string_view kZip = "a zip archive";
constexpr std::string_view kCompressed = "a compressed archive";
constexpr std::string_view kPdf = "a PDF document";

/// Bytes at a place near the beginning of a file, and what they stand for.
struct Signature {
  std::size_t offset;
  std::string_view bytes;
  std::string_view kind;
};

constexpr std::array<Signature, 23> kSignatures{{{4, "ftyp"sv, kVideo},  // MP4, MOV, M4V, 3GP
                                                 {4, "moov"sv, kVideo},
                                                 {4, "mdat"sv, kVideo},
                                                 {8, "AVI "sv, kVideo},
                                                 {0, "\x1A\x45\xDF\xA3"sv, kVideo},  // Matroska, WebM
                                                 {0, "FLV\x01"sv, kVideo},
                                                 {0, "OggS"sv, kVideo},
                                                 {0, "\x30\x26\xB2\x75"sv, kVideo},  // WMV
                                                 {0, "\x00\x00\x01\xBA"sv, kVideo},  // MPEG
                                                 {0, "\x00\x00\x01\xB3"sv, kVideo},
                                                 {0, "\x89PNG"sv, kImage},
                                                 {0, "\xFF\xD8\xFF"sv, kImage},  // JPEG
                                                 {0, "GIF8"sv, kImage},
                                                 {0, "II*\0"sv, kImage},  // TIFF
                                                 {0, "MM\0*"sv, kImage},
                                                 {8, "WEBP"sv, kImage},
                                                 {0, "\x89HDF"sv, kHdf5},
                                                 {0, "\x93NUMPY"sv, kNumPy},
                                                 {0, "PK\x03\x04"sv, kZip},
                                                 {0, "\x1F\x8B"sv, kCompressed},  // gzip
                                                 {0, "7z\xBC\xAF"sv, kCompressed},
                                                 {0, "Rar!"sv, kCompressed},
                                                 {0, "%PDF"sv, kPdf}}};

constexpr std::array<std::string_view, 16> kVideoExtensions{".mp4",  ".mov",  ".m4v", ".avi", ".mkv", ".webm",
                                                            ".mpg",  ".mpeg", ".wmv", ".flv", ".3gp", ".mts",
                                                            ".m2ts", ".ts",   ".ogv", ".mxf"};

}  // namespace

std::string KindOfBytes(std::string_view first_bytes) {
  for (const Signature& signature : kSignatures) {
    if (first_bytes.size() < signature.offset + signature.bytes.size()) continue;
    if (first_bytes.substr(signature.offset, signature.bytes.size()) == signature.bytes)
      return std::string(signature.kind);
  }
  return "";
}

std::string KindOfFile(const std::filesystem::path& path) {
  std::array<char, 16> bytes{};
  std::ifstream stream(path, std::ios::binary);
  stream.read(bytes.data(), bytes.size());
  std::string kind = KindOfBytes(std::string_view(bytes.data(), static_cast<std::size_t>(stream.gcount())));
  const std::string extension = LowerCase(path.extension().string());
  if (kind.empty() && stream.gcount() > 0 &&
      std::find(kVideoExtensions.begin(), kVideoExtensions.end(), extension) != kVideoExtensions.end()) {
    kind = kVideo;
  }
  return kind;
}

std::string AdviceForKind(std::string_view kind) {
  if (kind == kVideo || kind == kImage) {
    return "run a 2D keypoint detector on it first, such as canonpose detect, and give the files that it writes "
           "(openpose, alphapose, mmpose, coco, ...)";
  }
  if (kind == kZip || kind == kCompressed) return "unpack it first";
  if (kind == kHdf5) return "HDF5 files of detectors are read as deeplabcut or sleap";
  if (kind == kNumPy) return "NumPy files of detectors are read as freemocap";
  if (kind.empty()) return "";
  return "give the files that a 2D keypoint detector writes (openpose, alphapose, mmpose, coco, ...)";
}

}  // namespace canonpose
