#include "canonpose/data/readers/sleap.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/hdf5.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/readers/camera_files.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSleapAdvice =
    "export it in SLEAP with File > Export Analysis HDF5, or sleap-convert --format analysis; a .slp project is "
    "another "
    "file";
/// No image is larger.
constexpr double kLargestPixel = 1e9;

/// An array over the tracks, nodes and frames of a file, whatever their order in it.
struct PointArray {
  std::vector<double> values;
  std::size_t track_step = 0;
  std::size_t axis_step = 0;  ///< from x to y
  std::size_t node_step = 0;
  std::size_t frame_step = 0;

  [[nodiscard]] double At(std::size_t track, std::size_t node, std::size_t frame, std::size_t axis = 0) const {
    return values[track * track_step + node * node_step + frame * frame_step + axis * axis_step];
  }
};

struct SleapFile {
  std::vector<std::string> nodes;
  std::size_t track_count = 0;
  std::size_t frame_count = 0;
  PointArray points;
  std::optional<PointArray> scores;
};

/// How many tracks the file names; nothing where it names none, since one that nobody tracked has an array of one.
std::optional<std::size_t> TrackCount(const h5::Group& root) {
  if (!root.Has("track_names")) return std::nullopt;
  const std::vector<std::size_t> shape = root.Shape("track_names");
  if (shape.empty() || shape[0] == 0) return std::nullopt;
  return shape[0];
}

/// Points in the order that the shape shows. Where both orders fit, it is SLEAP's own unless the file says another.
void ReadPoints(const h5::Group& root, SleapFile& file) {
  h5::Array<double> tracks = root.Read<double>("tracks");
  const std::vector<std::size_t>& shape = tracks.shape;
  const std::size_t nodes = file.nodes.size();
  const std::optional<std::size_t> count = TrackCount(root);
  const bool has_nodes = shape.size() == 4 && shape[2] == nodes;
  const bool is_own = has_nodes && shape[1] == 2 && (!count || shape[0] == *count);
  const bool is_other = has_nodes && shape[3] == 2 && (!count || shape[1] == *count);
  const bool says_other = root.HasAttribute("preset") && root.GetString("preset") == "standard";
  if (is_own && !(is_other && says_other)) {
    file.track_count = shape[0];
    file.frame_count = shape[3];
    file.points = {std::move(tracks.values), 2 * nodes * shape[3], nodes * shape[3], shape[3], 1};
  } else if (is_other) {
    file.frame_count = shape[0];
    file.track_count = shape[1];
    file.points = {std::move(tracks.values), 2 * nodes, 1, 2, shape[1] * nodes * 2};
  } else {
    root.Fail("tracks",
              fmt::format("(tracks, 2, {}, frames), as there are {} node_names{}", nodes, nodes,
                          count ? fmt::format(" and {} track_names", *count) : ""),
              h5::FormatShape(shape), kSleapAdvice);
  }
}

void ReadScores(const h5::Group& root, SleapFile& file) {
  if (!root.Has("point_scores")) return;
  h5::Array<double> scores = root.Read<double>("point_scores");
  const std::size_t nodes = file.nodes.size();
  const std::size_t tracks = file.track_count;
  const std::size_t frames = file.frame_count;
  // In the order of the points.
  if (file.points.frame_step == 1 && scores.shape == std::vector<std::size_t>{tracks, nodes, frames}) {
    file.scores = {std::move(scores.values), nodes * frames, 0, frames, 1};
  } else if (scores.shape == std::vector<std::size_t>{frames, tracks, nodes}) {
    file.scores = {std::move(scores.values), nodes, 0, 1, tracks * nodes};
  } else {
    root.Fail("point_scores", h5::FormatShape({tracks, nodes, frames}), h5::FormatShape(scores.shape), kSleapAdvice);
  }
}

/// Pairs of nodes; SLEAP stores them as (2, edges) or (edges, 2).
std::vector<std::array<int, 2>> ReadBones(const h5::Group& root, std::size_t nodes) {
  if (!root.Has("edge_inds")) return {};
  const h5::Array<std::int64_t> edges = root.Read<std::int64_t>("edge_inds");
  if (edges.values.empty()) return {};
  const bool is_rows = edges.shape.size() == 2 && edges.shape[1] == 2;
  if (!is_rows && (edges.shape.size() != 2 || edges.shape[0] != 2)) {
    root.Fail("edge_inds", "(edges, 2)", h5::FormatShape(edges.shape), kSleapAdvice);
  }
  const std::size_t count = edges.values.size() / 2;
  std::vector<std::array<int, 2>> bones;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t from = edges.values[is_rows ? 2 * i : i];
    const std::int64_t to = edges.values[is_rows ? 2 * i + 1 : count + i];
    for (const std::int64_t node : {from, to}) {
      if (node >= 0 && node < static_cast<std::int64_t>(nodes)) continue;
      root.Fail("edge_inds", fmt::format("numbers of {} nodes", nodes), fmt::format("{}", node), kSleapAdvice);
    }
    if (from != to) bones.push_back({static_cast<int>(from), static_cast<int>(to)});
  }
  return bones;
}

double OrMissing(double value) { return std::abs(value) <= kLargestPixel ? value : NAN; }

/// The animal of a track in a frame, where it is seen.
std::optional<DetectedPerson> AnimalOf(const SleapFile& file, std::size_t track, std::size_t frame) {
  std::vector<double> triples;
  for (std::size_t node = 0; node < file.nodes.size(); ++node) {
    double score = file.scores ? OrMissing(file.scores->At(track, node, frame)) : 1.0;
    // Points that a person placed or corrected have no score, or 0.
    if (!(score > 0.0)) score = 1.0;
    triples.insert(triples.end(), {OrMissing(file.points.At(track, node, frame, 0)),
                                   OrMissing(file.points.At(track, node, frame, 1)), score});
  }
  return PersonFromNamedTriples(triples);
}

/// "cam1" for "cam1.analysis.h5" and "labels.v001.000_cam1.analysis.h5".
std::string SleapVideo(const fs::path& file) {
  std::string name = CameraNameOf(file);
  for (const std::string_view suffix : {".analysis", ".predictions", ".tracking"}) {
    if (name.size() > suffix.size() && name.ends_with(suffix)) name.resize(name.size() - suffix.size());
  }
  if (name.starts_with("labels.") && name.find('_') + 1 < name.size()) name = name.substr(name.find('_') + 1);
  return name;
}

}  // namespace

bool IsSleapFile(const fs::path& file) {
  if (!h5::File::IsHdf5(file)) return false;
  try {
    const h5::File opened = h5::File::OpenForReading(file);
    return opened.root().Has("tracks") && opened.root().Has("node_names");
  } catch (const Error&) {
    return false;
  }
}

std::vector<CameraInput> FindSleapCameras(const fs::path& path) {
  return FindCameraFiles(path,
                         {{".h5", ".hdf5"}, "an analysis h5 file of SLEAP for each camera", IsSleapFile, SleapVideo});
}

DetectedCamera ReadSleap(const CameraInput& input) {
  const std::string path = input.path.string();
  if (!h5::File::IsHdf5(input.path)) {
    const std::string kind = KindOfFile(input.path);
    ThrowBadInput({path, "", "SLEAP's analysis HDF5 file", kind.empty() ? "another file" : kind, kSleapAdvice});
  }
  const h5::File opened = h5::File::OpenForReading(input.path);
  const h5::Group& root = opened.root();
  for (const char* const name : {"tracks", "node_names"}) {
    if (root.Has(name)) continue;
    ThrowBadInput({path, "", "SLEAP's tracks and node_names",
                   fmt::format("{}", fmt::join(root.Children(), ", ")).substr(0, 120), kSleapAdvice});
  }
  SleapFile file;
  file.nodes = root.ReadTexts("node_names");
  if (file.nodes.empty()) root.Fail("node_names", "the names of nodes", "none", kSleapAdvice);
  CameraBuilder builder(input);
  builder.SetLayout({"sleap", file.nodes, {}}, path, "node_names");  // which checks them before they are used
  builder.SetLayout({"sleap", file.nodes, ReadBones(root, file.nodes.size())}, path, "node_names");
  ReadPoints(root, file);
  if (file.track_count == 0)
    root.Fail("tracks", "at least one track", h5::FormatShape(root.Shape("tracks")), kSleapAdvice);
  if (file.track_count > 1) builder.NoteTracks();
  ReadScores(root, file);
  for (std::size_t t = 0; t < file.frame_count; ++t) {
    const std::string place = fmt::format("tracks, frame {}", t);
    DetectedFrame& frame = builder.Frame(static_cast<std::int64_t>(t), place, path, place);
    for (std::size_t track = 0; track < file.track_count; ++track) {
      std::optional<DetectedPerson> animal = AnimalOf(file, track, t);
      if (!animal) continue;
      if (file.track_count > 1) animal->track_id = static_cast<std::int64_t>(track);
      builder.Add(frame, std::move(*animal), path, place);
    }
  }
  return builder.Finish(false);
}

}  // namespace canonpose
