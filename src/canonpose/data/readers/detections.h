// The common form of all detectors' files: the frames of each camera in order, and the people seen in each frame.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// One person in one frame: K keypoints in the detector's layout.
struct DetectedPerson {
  std::vector<float> keypoints;          ///< (K, 2) pixels, origin top left; NaN where missing
  std::vector<float> confidence;         ///< (K) as in the file, so it may exceed 1; 0 where missing
  std::optional<std::int64_t> track_id;  ///< who this is according to the detector
  double score = 0.0;                    ///< of the whole person; 0 where the file has none
};

struct DetectedFrame {
  std::int64_t number = 0;  ///< from the name of the file or image, or the file's own numbering
  std::string image;        ///< name of the image or of the frame's file, for messages
  std::vector<DetectedPerson> people;
};

/// What a file itself says its keypoints are.
struct DetectedLayout {
  std::string name;                       ///< of the format or the layout: "deeplabcut", "mediapipe-33"
  std::vector<std::string> joints;        ///< (K) unique names
  std::vector<std::array<int, 2>> bones;  ///< pairs of joints, towards the root first; some, all or none
};

struct DetectedCamera {
  std::string name;
  std::string path;                   ///< as the user gave it
  int keypoint_count = 0;             ///< K; 0 if nobody is seen in any frame
  std::vector<DetectedFrame> frames;  ///< ascending, unique numbers
  /// Where frames are named by the time, their numbers are multiples of this; 0 where they count frames.
  double seconds_per_number = 0.0;
  /// Empty where the file does not say: then it is recognised by the number of keypoints and by anatomy.
  std::optional<DetectedLayout> layout;
  /// Whether whoever wrote the files followed people, so that equal track ids are one person even where they look like
  /// a mere count.
  bool has_tracks = false;
  std::set<std::string> unused_parts;  ///< what the files also contain but is not read: "face", "hands", "feet"
};

/// Where one camera's detections are.
struct CameraInput {
  std::string name;
  std::filesystem::path path;
  /// Which camera of a path that holds several; empty where it is one.
  std::string part{};
  /// Width and height in pixels, for files that have fractions of the image; 0 where unknown.
  std::array<int, 2> image_size{0, 0};
  /// Of the layout that the user named, for files that do not show how many there are; 0 where unknown.
  int keypoint_count = 0;
};

/// Makes a person from x, y, c triples. A keypoint with a confidence of 0 or less is missing, and so is one at exactly
/// (0, 0), which is how detectors write it, or with a value that is NaN. Whole-body sets are reduced to body and feet:
/// Halpe-136 to the 26 keypoints of halpe-26, COCO-WholeBody-133 to the 23 of coco-23. Null if no keypoint is seen.
std::optional<DetectedPerson> PersonFromTriples(const std::vector<double>& triples);
/// The same for formats that name their keypoints, of which none are left out.
std::optional<DetectedPerson> PersonFromNamedTriples(const std::vector<double>& triples);

/// Collects the frames of one camera and checks that they are consistent.
class CameraBuilder {
 public:
  explicit CameraBuilder(const CameraInput& input);

  [[nodiscard]] const std::string& camera_name() const { return camera_.name; }
  [[nodiscard]] bool has_frames() const { return !frames_.empty() || !named_frames_.empty(); }

  [[nodiscard]] bool has_people() const { return camera_.keypoint_count > 0; }

  /// Creates or finds the frame of a number. Throws Error(kBadInput) where another image has the same number.
  DetectedFrame& Frame(std::int64_t number, const std::string& image, const std::string& file,
                       const std::string& place);
  /// Creates or finds the frame of an image or file by its name. Its number follows in Finish() from the names of all
  /// (NumberFrames()). Throws Error(kBadInput) where there is no number in the name.
  DetectedFrame& Frame(const std::string& image, const std::string& file, const std::string& place);
  /// Throws Error(kBadInput) where a person has a different number of keypoints than those before.
  void Add(DetectedFrame& frame, DetectedPerson person, const std::string& file, const std::string& place);
  /// Notes that a keypoint set is reduced to the body, or that the file has a part which is not read.
  void NoteKeypointCount(std::size_t count);
  /// Notes what the keypoints are. Throws Error(kBadInput) where a name is empty or there twice, or where there are
  /// more than any body has.
  void SetLayout(DetectedLayout layout, const std::string& file, const std::string& place);
  /// Notes that the format keeps individuals apart.
  void NoteTracks() { camera_.has_tracks = true; }
  void NoteUnusedPart(const std::string& part) { camera_.unused_parts.insert(part); }
  /// Notes a file in the camera's folder that has no keypoints; Finish() reports how many there are.
  void LeaveOut(const std::filesystem::path& file);
  /// The camera, with its frames sorted by number. `fill_gaps` is for formats that leave out images without people: it
  /// adds frames without people between the first and the last frame, where the numbering has gaps. Throws
  /// Error(kBadInput) where there is no detection at all, or two images have the same number.
  DetectedCamera Finish(bool fill_gaps);

 private:
  struct NamedFrame {
    DetectedFrame frame;
    std::string file;
    std::string place;
  };
  void NumberNamedFrames();
  void FillGaps();
  void ReportLeftOut() const;

  DetectedCamera camera_;
  std::map<std::int64_t, DetectedFrame> frames_;
  std::map<std::string, NamedFrame> named_frames_;  // by image
  std::vector<std::filesystem::path> left_out_;
  std::string first_place_;  ///< the place of the first person, for messages
};

/// The files of a folder with one of these extensions (".json", in lower case) sorted by name, except hidden ones.
/// Throws Error(kBadInput) where it is not a readable folder.
std::vector<std::filesystem::path> FilesIn(const std::filesystem::path& folder,
                                           const std::vector<std::string_view>& extensions);
/// The JSON files of a folder sorted by name, except hidden ones. Throws Error(kBadInput) where it is not a readable
/// folder.
std::vector<std::filesystem::path> JsonFilesIn(const std::filesystem::path& folder);
/// Its other files, including hidden ones.
std::vector<std::filesystem::path> OtherFilesIn(const std::filesystem::path& folder);
/// Its sub-folders sorted by name, except hidden ones.
std::vector<std::filesystem::path> FoldersIn(const std::filesystem::path& folder);

/// Lines about paths: "config.json", "config.json and 2 more".
std::string FirstAndCount(const std::vector<std::filesystem::path>& paths);

/// The name of a camera, from its file or folder. Where that has a name that detectors give to all their outputs
/// ("alphapose-results", "sep-json", "labels"), it is the name of the folder above.
std::string CameraNameOf(const std::filesystem::path& path);

}  // namespace canonpose
