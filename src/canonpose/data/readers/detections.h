// What every detector file is read into: per camera the frames in order, per frame the people seen in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace canonpose {

/// One person in one frame, K keypoints of whatever layout the detector has.
struct DetectedPerson {
  std::vector<float> keypoints;          ///< (K, 2) pixels, origin top left; NaN where missing
  std::vector<float> confidence;         ///< (K) as the file has it, so it may exceed 1; 0 where missing
  std::optional<std::int64_t> track_id;  ///< the detector's own idea of who this is
  double score = 0.0;                    ///< of the whole person; 0 where the file has none
};

struct DetectedFrame {
  std::int64_t number = 0;  ///< from the file's or image's name, or the file's own numbering
  std::string image;        ///< the image's or the frame file's name, for messages
  std::vector<DetectedPerson> people;
};

struct DetectedCamera {
  std::string name;
  std::string path;                   ///< as the user gave it
  int keypoint_count = 0;             ///< K; 0 where nobody is seen in any frame
  std::vector<DetectedFrame> frames;  ///< ascending, unique numbers
};

/// Where one camera's detections are.
struct CameraInput {
  std::string name;
  std::filesystem::path path;
};

/// Makes a person from x, y, c triples. A keypoint of confidence 0 or less is missing, and one at exactly (0, 0) too:
/// that is how detectors write it. Whole-body sets are cut down to the body: Halpe-136 to 26 keypoints,
/// COCO-WholeBody-133 to 17. Null where not one keypoint is seen.
std::optional<DetectedPerson> PersonFromTriples(const std::vector<double>& triples);

/// Gathers the frames of one camera and checks them against each other.
class CameraBuilder {
 public:
  explicit CameraBuilder(const CameraInput& input);

  /// Starts or finds the frame of a number. Throws Error(kBadInput) where another image has the same number.
  DetectedFrame& Frame(std::int64_t number, const std::string& image, const std::string& file,
                       const std::string& place);
  /// Throws Error(kBadInput) where a person has another number of keypoints than those before.
  void Add(DetectedFrame& frame, DetectedPerson person, const std::string& file, const std::string& place);
  /// The camera, frames by number. Where `fill_gaps`, the formats that leave out images without people, frames between
  /// the first and the last that fit the numbering are added without people. Throws Error(kBadInput) where there is no
  /// detection at all.
  DetectedCamera Finish(bool fill_gaps);

 private:
  DetectedCamera camera_;
  std::map<std::int64_t, DetectedFrame> frames_;
  std::string first_place_;  ///< where the first person stands, for messages
};

/// The last number in a name without its extension, "cam01.0012.json" -> 12. Null where there is none.
std::optional<std::int64_t> LastNumber(std::string_view file_name);
/// The same; throws Error(kBadInput) where there is none.
std::int64_t FrameNumberOf(const std::string& name, const std::string& file, const std::string& place);

/// The JSON files of a folder by name, hidden ones left out. Throws Error(kBadInput) where it is no folder that can be
/// read.
std::vector<std::filesystem::path> JsonFilesIn(const std::filesystem::path& folder);
/// Its sub-folders by name, hidden ones left out.
std::vector<std::filesystem::path> FoldersIn(const std::filesystem::path& folder);

/// The name of a camera from its file or folder; names that detectors give all their outputs ("alphapose-results",
/// "sep-json") give way to the folder above.
std::string CameraNameOf(const std::filesystem::path& path);

}  // namespace canonpose
