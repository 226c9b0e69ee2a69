#include "canonpose/export/keypoint_files.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// JSON with float numbers, whose shortest text reads back as the same bits.
using Json = nlohmann::basic_json<std::map, std::vector, std::string, bool, std::int64_t, std::uint64_t, float>;

/// One pose of a view, flattened as in detectors' files.
struct FlatPose {
  std::vector<float> triples;  ///< x, y, confidence of every joint; 0, 0, 0 where missing
  bool is_seen = false;        ///< whether any joint is seen
  float mean_confidence = 0.0F;
};

FlatPose PoseAt(const CameraView& view, std::size_t joints, std::size_t frame) {
  FlatPose pose;
  int seen = 0;
  for (std::size_t j = frame * joints; j < (frame + 1) * joints; ++j) {
    const bool is_found = view.confidence[j] > 0.0F && std::isfinite(view.keypoints[2 * j]);
    if (is_found) {
      pose.triples.insert(pose.triples.end(), {view.keypoints[2 * j], view.keypoints[2 * j + 1], view.confidence[j]});
      pose.mean_confidence += view.confidence[j];
      ++seen;
    } else {
      pose.triples.insert(pose.triples.end(), 3, 0.0F);
    }
  }
  pose.is_seen = seen > 0;
  if (pose.is_seen) pose.mean_confidence /= static_cast<float>(seen);
  return pose;
}

std::size_t FrameCount(const CameraView& view, int joint_count) {
  CANONPOSE_CHECK(joint_count > 0 && view.keypoints.size() == 2 * view.confidence.size() &&
                      view.confidence.size() % static_cast<std::size_t>(joint_count) == 0,
                  "{} confidences for {} joints", view.confidence.size(), joint_count);
  return view.confidence.size() / static_cast<std::size_t>(joint_count);
}

/// Writes one of many files of a folder that appears as a whole, so the file need not be synced to disk by itself.
void WriteInto(const AtomicFolder& folder, const std::string& name, const std::string& text) {
  const fs::path path = folder.temporary_path() / name;
  std::ofstream stream(path, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) ThrowCannotWrite(path, errno);
}

}  // namespace

void WriteOpenPose(const fs::path& folder, const CameraView& view, int joint_count) {
  const std::size_t frames = FrameCount(view, joint_count);
  AtomicFolder files(folder);
  for (std::size_t t = 0; t < frames; ++t) {
    const FlatPose pose = PoseAt(view, static_cast<std::size_t>(joint_count), t);
    Json frame;
    frame["version"] = 1.3F;
    frame["people"] = Json::array();
    if (pose.is_seen) frame["people"].push_back({{"person_id", {-1}}, {"pose_keypoints_2d", pose.triples}});
    WriteInto(files, fmt::format("{}_{:012}_keypoints.json", view.name, t), frame.dump());
  }
  files.Commit();
}

void WriteAlphaPose(const fs::path& file, const CameraView& view, int joint_count) {
  const std::size_t frames = FrameCount(view, joint_count);
  Json list = Json::array();
  for (std::size_t t = 0; t < frames; ++t) {
    const FlatPose pose = PoseAt(view, static_cast<std::size_t>(joint_count), t);
    if (!pose.is_seen && t != 0 && t + 1 != frames) continue;
    list.push_back({{"image_id", fmt::format("{:06}.jpg", t)},
                    {"category_id", 1},
                    {"keypoints", pose.triples},
                    {"score", static_cast<float>(joint_count) * pose.mean_confidence}});
  }
  MakeDirectory(file.parent_path());
  WriteFileAtomically(file, list.dump());
}

}  // namespace canonpose
