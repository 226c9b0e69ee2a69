// The common form of all detectors' files: the frames of each camera in order, and the people seen in each frame.
#pragma once

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

struct DetectedCamera {
  std::string name;
  std::string path;                   ///< as the user gave it
  int keypoint_count = 0;             ///< K; 0 if nobody is seen in any frame
  std::vector<DetectedFrame> frames;  ///< ascending, unique numbers
  /// Where frames are named by the time, their numbers are multiples of this; 0 where they count frames.
  double seconds_per_number = 0.0;
  bool has_tracks = false;             ///< whoever wrote the files followed people: equal track ids are one person
  std::set<std::string> unused_parts;  ///< what the files also contain but is not read: "face", "hands", "feet"
};

/// Where one camera's detections are.
struct CameraInput {
  std::string name;
  std::filesystem::path path;
};

/// Makes a person from x, y, c triples. A keypoint with a confidence of 0 or less is missing, and so is one at exactly
/// (0, 0), which is how detectors write it, or with a value that is NaN. Whole-body sets are reduced to the body:
/// Halpe-136 to 26 keypoints, COCO-WholeBody-133 to 17. Null if no keypoint is seen.
std::optional<DetectedPerson> PersonFromTriples(const std::vector<double>& triples);

/// Collects the frames of one camera and checks that they are consistent.
class CameraBuilder {
 public:
  explicit CameraBuilder(const CameraInput& input);

  [[nodiscard]] const std::string& camera_name() const { return camera_.name; }
  [[nodiscard]] bool has_frames() const { return !frames_.empty() || !named_frames_.empty(); }

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
/// ("alphapose-results", "sep-json"), it is the name of the folder above.
std::string CameraNameOf(const std::filesystem::path& path);

}  // namespace canonpose
