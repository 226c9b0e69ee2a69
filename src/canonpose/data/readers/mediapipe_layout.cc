#include "canonpose/data/readers/mediapipe_layout.h"

#include <array>
#include <cctype>

#include "canonpose/base/error.h"
#include "canonpose/skeleton/joint_names.h"

namespace canonpose {
namespace {

struct Landmark {
  const char* name;      ///< ours
  const char* original;  ///< MediaPipe's, without case and punctuation
  const char* parent;
};

constexpr std::array<Landmark, kMediapipePoints> kLandmarks{{{"Nose", "nose", ""},
                                                             {"LEyeInner", "lefteyeinner", "Nose"},
                                                             {"LEye", "lefteye", "LEyeInner"},
                                                             {"LEyeOuter", "lefteyeouter", "LEye"},
                                                             {"REyeInner", "righteyeinner", "Nose"},
                                                             {"REye", "righteye", "REyeInner"},
                                                             {"REyeOuter", "righteyeouter", "REye"},
                                                             {"LEar", "leftear", "LEyeOuter"},
                                                             {"REar", "rightear", "REyeOuter"},
                                                             {"LMouth", "mouthleft", "Nose"},
                                                             {"RMouth", "mouthright", "Nose"},
                                                             {"LShoulder", "leftshoulder", "Nose"},
                                                             {"RShoulder", "rightshoulder", "Nose"},
                                                             {"LElbow", "leftelbow", "LShoulder"},
                                                             {"RElbow", "rightelbow", "RShoulder"},
                                                             {"LWrist", "leftwrist", "LElbow"},
                                                             {"RWrist", "rightwrist", "RElbow"},
                                                             {"LPinky", "leftpinky", "LWrist"},
                                                             {"RPinky", "rightpinky", "RWrist"},
                                                             {"LIndex", "leftindex", "LWrist"},
                                                             {"RIndex", "rightindex", "RWrist"},
                                                             {"LThumb", "leftthumb", "LWrist"},
                                                             {"RThumb", "rightthumb", "RWrist"},
                                                             {"LHip", "lefthip", "LShoulder"},
                                                             {"RHip", "righthip", "RShoulder"},
                                                             {"LKnee", "leftknee", "LHip"},
                                                             {"RKnee", "rightknee", "RHip"},
                                                             {"LAnkle", "leftankle", "LKnee"},
                                                             {"RAnkle", "rightankle", "RKnee"},
                                                             {"LHeel", "leftheel", "LAnkle"},
                                                             {"RHeel", "rightheel", "RAnkle"},
                                                             {"LBigToe", "leftfootindex", "LAnkle"},
                                                             {"RBigToe", "rightfootindex", "RAnkle"}}};

Skeleton MakeLayout() {
  Skeleton layout;
  layout.name = "mediapipe-33";
  for (const Landmark& landmark : kLandmarks) layout.joints.emplace_back(landmark.name);
  for (const Landmark& landmark : kLandmarks) layout.parents.push_back(layout.Find(landmark.parent).value_or(-1));
  layout.root = layout.Find("Nose").value();
  layout.mirror = SidePartners(layout.joints);
  CANONPOSE_CHECK(layout.Problem().empty(), "{}", layout.Problem());
  return layout;
}

std::string Plain(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) plain += static_cast<char>(std::tolower(letter));
  }
  return plain;
}

}  // namespace

const Skeleton& MediapipeLayout() {
  static const Skeleton layout = MakeLayout();
  return layout;
}

DetectedLayout DetectedMediapipeLayout() { return {MediapipeLayout().name, MediapipeLayout().joints, {}}; }

std::optional<int> FindLandmark(std::string_view name) {
  const std::string plain = Plain(name);
  for (std::size_t k = 0; k < kLandmarks.size(); ++k) {
    if (plain == kLandmarks[k].original || plain == Plain(kLandmarks[k].name)) return static_cast<int>(k);
  }
  return std::nullopt;
}

}  // namespace canonpose
