#include "canonpose/data/readers/flat_list.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/data/codecs/file_kind.h"
#include "canonpose/data/readers/formats.h"
#include "canonpose/data/readers/frame_numbers.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// What COCO-WholeBody keeps beside the body's keypoints.
constexpr std::array<std::pair<const char*, const char*>, 3> kOtherCocoParts{
    {{"face_kpts", "face"}, {"lefthand_kpts", "hands"}, {"righthand_kpts", "hands"}}};
constexpr const char* kCocoFeet = "foot_kpts";
constexpr std::size_t kCocoBodyValues = 3 * 17;
constexpr std::size_t kCocoFootValues = 3 * 6;

/// Appends the feet that COCO-WholeBody keeps beside the body's 17 keypoints, as missing where a person has none, so
/// that all people have the layout coco-23.
void AppendFeet(const JsonValue& entry, std::vector<double>& triples) {
  if (!entry.Contains(kCocoFeet) || triples.size() != kCocoBodyValues) return;
  const JsonValue value = entry[kCocoFeet];
  std::vector<double> feet(kCocoFootValues, 0.0);
  if (!value.IsNull()) feet = value.NumbersOrNaN();
  if (feet.size() != kCocoFootValues) {
    value.Fail(fmt::format("{} values (x, y, confidence of six keypoints)", kCocoFootValues), "export it again",
               fmt::format("{} values", feet.size()));
  }
  triples.insert(triples.end(), feet.begin(), feet.end());
}

/// A track id: a number, or, as some trackers write it, a number in an array.
std::optional<std::int64_t> TrackId(const JsonValue& entry) {
  for (const char* key : {"idx", "track_id"}) {
    std::optional<JsonValue> value = entry.Find(key);
    while (value && value->json().is_array() && value->ArraySize() > 0) value = value->At(0);
    if (value && value->json().is_number()) {
      const double id = value->Number();
      if (id >= 0) return static_cast<std::int64_t>(id);
    }
  }
  return std::nullopt;
}

bool IsCalibration(const fs::path& file) {
  if (FirstCharacter(file) != '{') return false;
  const std::optional<JsonValue> cameras = JsonValue::Load(file).Find("cameras");
  return cameras && cameras->json().is_object();
}

/// The files of a folder by what is in them.
struct FolderContent {
  bool has_frames = false;           ///< the folder is one camera
  std::vector<fs::path> detections;  ///< each may be a camera
  std::vector<fs::path> unknown;     ///< neither detections nor calibrations
};

/// How many files are examined to find out whether they are frames; there may be thousands.
constexpr std::size_t kFilesToTry = 10;

FolderContent ContentOf(const fs::path& folder, IsFrameFile is_frame_file) {
  const std::vector<fs::path> files = JsonFilesIn(folder);
  FolderContent content;
  for (std::size_t i = 0; i < std::min(files.size(), kFilesToTry); ++i) {
    content.has_frames = content.has_frames || is_frame_file(files[i]);
    if (content.has_frames) return content;
  }
  for (const fs::path& file : files) {
    if (IsCalibration(file)) continue;
    const JsonValue root = JsonValue::Load(file);
    const bool is_empty = (root.json().is_array() || root.json().is_object()) && root.json().empty();
    (is_empty || !GuessFormat(root).empty() ? content.detections : content.unknown).push_back(file);
  }
  return content;
}

/// The cameras that are files of a folder, or the folder itself. Files that are not detections are reported where there
/// are detections, and otherwise added to `unknown`.
std::vector<CameraInput> CamerasInFolder(const fs::path& folder, IsFrameFile is_frame_file,
                                         std::vector<fs::path>& unknown) {
  const FolderContent content = ContentOf(folder, is_frame_file);
  if (content.has_frames) return {{CameraNameOf(folder), folder}};
  std::vector<CameraInput> cameras;
  cameras.reserve(content.detections.size());
  for (const fs::path& file : content.detections) cameras.push_back({CameraNameOf(file), file});
  unknown.insert(unknown.end(), content.unknown.begin(), content.unknown.end());
  return cameras;
}

/// Several categories are people and other things, such as animals, which may have as many keypoints.
std::optional<std::int64_t> CategoryToKeep(const JsonValue& list, const std::string& camera) {
  constexpr std::int64_t kPerson = 1;
  std::map<std::int64_t, std::size_t> counts;
  for (std::size_t i = 0; i < list.ArraySize(); ++i) {
    const std::optional<JsonValue> category = list.At(i).Find("category_id");
    if (category && category->json().is_number_integer()) ++counts[category->Integer()];
  }
  if (counts.size() < 2) return std::nullopt;
  std::string others;
  std::size_t left_out = 0;
  for (const auto& [category, count] : counts) {
    if (category == kPerson && counts.contains(kPerson)) continue;
    others += fmt::format("{}{}", others.empty() ? "" : ", ", category);
    left_out += count;
  }
  if (!counts.contains(kPerson)) {
    list.Fail("detections of people, category 1", "keep only the detections of people, with category_id 1",
              fmt::format("categories {}", others));
  }
  LogWarning("{}: {} detections of category {} are left out; only people (category 1) are read", camera, left_out,
             others);
  return kPerson;
}

}  // namespace

std::vector<double> Triples(const JsonValue& value) {
  std::vector<double> triples = value.NumbersOrNaN();
  if (triples.empty() || triples.size() % 3 != 0) {
    value.Fail("a multiple of three values (x, y, confidence)", "export it again",
               fmt::format("{} values", triples.size()));
  }
  return triples;
}

void ReadFlatList(const JsonValue& list, CameraBuilder& builder) {
  const std::size_t count = list.ArraySize();
  const std::optional<std::int64_t> kept_category = CategoryToKeep(list, builder.camera_name());
  for (std::size_t i = 0; i < count; ++i) {
    const JsonValue entry = list.At(i);
    if (!entry.Has("image_id") || !entry.Contains("keypoints")) {
      if (i == 0) FailFormat(list, "a list of objects with image_id and keypoints");
      entry.Fail("an object with image_id and keypoints", "", entry.DescribeStructure());
    }
    const JsonValue image = entry["image_id"];
    DetectedFrame& frame = image.json().is_string() ? builder.Frame(image.String(), image.file(), image.place())
                                                    : builder.Frame(image.Integer(), fmt::format("{}", image.Integer()),
                                                                    image.file(), image.place());
    if (kept_category) {
      const std::optional<JsonValue> category = entry.Find("category_id");
      if (!category || !category->json().is_number() || category->Number() != static_cast<double>(*kept_category))
        continue;
    }
    for (const auto& [key, part] : kOtherCocoParts) {
      if (entry.Has(key)) builder.NoteUnusedPart(part);
    }
    const JsonValue keypoints = entry["keypoints"];
    if (keypoints.IsNull()) continue;
    std::vector<double> triples = Triples(keypoints);
    AppendFeet(entry, triples);
    builder.NoteKeypointCount(triples.size() / 3);
    std::optional<DetectedPerson> person = PersonFromTriples(triples);
    if (!person) continue;
    person->track_id = TrackId(entry);
    if (const std::optional<JsonValue> score = entry.Find("score"); score && score->json().is_number()) {
      person->score = score->Number();
    }
    builder.Add(frame, std::move(*person), keypoints.file(), keypoints.place());
  }
}

std::vector<CameraInput> FindFileCameras(const fs::path& path, IsFrameFile is_frame_file) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return {{CameraNameOf(path), path}};
  std::vector<fs::path> unknown;
  std::vector<CameraInput> cameras = CamerasInFolder(path, is_frame_file, unknown);
  if (cameras.empty()) {
    for (const fs::path& folder : FoldersIn(path)) {
      std::vector<CameraInput> inside = CamerasInFolder(folder, is_frame_file, unknown);
      // A camera's output folder may contain its frames in a sub-folder (sep-json).
      const std::vector<fs::path> inner = inside.empty() ? FoldersIn(folder) : std::vector<fs::path>();
      if (inner.size() == 1) inside = CamerasInFolder(inner.front(), is_frame_file, unknown);
      if (inside.size() > 1) {
        ThrowBadInput({folder.string(), "", "one camera in each sub-folder", fmt::format("{} files", inside.size()),
                       "name the cameras with `camera` NAME=PATH"});
      }
      if (!inside.empty()) cameras.push_back({CameraNameOf(folder), inside.front().path});
    }
  }
  if (cameras.empty() && !unknown.empty()) {
    FailFormat(JsonValue::Load(unknown.front()), "detections of people");
  }
  if (cameras.empty()) {
    ThrowBadInput(
        {path.string(), "", "a JSON file for each camera", DescribeFolder(path), AdviseFolder(path, "check the path")});
  }
  if (!unknown.empty()) {
    const bool is_one = unknown.size() == 1;
    LogWarning("{} in {} {} left out: {}", is_one ? "a file" : fmt::format("{} files", unknown.size()), path.string(),
               is_one ? "has no keypoints and is" : "have no keypoints and are", FirstAndCount(unknown));
  }
  return cameras;
}

void ReadFrameFiles(const CameraInput& input, CameraBuilder& builder, bool (*read)(const JsonValue&, CameraBuilder&),
                    const std::string& expected) {
  const std::vector<fs::path> files = JsonFilesIn(input.path);
  Progress progress("reading " + input.name, std::ssize(files));
  std::optional<fs::path> first_left_out;
  long done = 0;
  for (const fs::path& file : files) {
    bool has_keypoints = false;
    try {
      has_keypoints = read(JsonValue::Load(file), builder);
    } catch (const Error&) {
      // A frame has a number.
      if (LastNumber(file.filename().string())) throw;
    }
    if (!has_keypoints) {
      builder.LeaveOut(file);
      if (!first_left_out) first_left_out = file;
    }
    progress.Update(++done, "");
  }
  if (first_left_out && !builder.has_frames()) FailFormat(JsonValue::Load(*first_left_out), expected);
  for (const fs::path& file : OtherFilesIn(input.path)) builder.LeaveOut(file);
}

std::string DescribeFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_empty(folder, error) && !error) return "an empty folder";
  for (const std::string_view kind : {"a video", "an image"}) {
    std::vector<fs::path> files = OtherFilesIn(folder);
    std::erase_if(files, [&](const fs::path& file) { return KindOfFile(file) != kind; });
    if (files.empty()) continue;
    return fmt::format("{}{} ({})", files.size() == 1 ? std::string(kind) : fmt::format("{} ", files.size()),
                       files.size() == 1 ? "" : std::string(kind.substr(kind.find(' ') + 1)) + "s",
                       FirstAndCount(files));
  }
  return kNoJsonFile;
}

std::string AdviseFolder(const fs::path& folder, const std::string& advice) {
  for (const fs::path& file : OtherFilesIn(folder)) {
    const std::string kind = KindOfFile(file);
    if (kind == "a video" || kind == "an image") return AdviceForKind(kind);
  }
  // Of formats in JSON the reader itself knows what is missing.
  static constexpr std::array<std::string_view, 4> kInJson{"openpose", "alphapose", "mmpose", "coco"};
  const std::string format = LooksLikeFormat(folder);
  const bool is_other = !format.empty() && std::find(kInJson.begin(), kInJson.end(), format) == kInJson.end();
  return is_other ? fmt::format("this looks like the format {}", format) : advice;
}

void FailFormat(const JsonValue& root, const std::string& expected) {
  const std::string format = GuessFormat(root);
  const std::string advice =
      !format.empty() ? fmt::format("this looks like the format {}", format) : AdviceForContent(root);
  root.Fail(expected, advice, DescribeContent(root));
}

}  // namespace canonpose
