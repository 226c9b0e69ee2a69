#include "canonpose/motion/readers/acclaim.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/motion/readers/acclaim_skeleton.h"
#include "canonpose/motion/readers/text_lines.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr double kFramesPerSecond = 120.0;
constexpr const char* kCutOff = "the file was cut off or damaged; export or copy it again";

/// The skeleton of a clip: the one with the longest name that the clip's name begins with, or the only one.
fs::path FindSkeletonFile(const fs::path& amc) {
  const fs::path folder = amc.has_parent_path() ? amc.parent_path() : fs::path(".");
  std::vector<fs::path> all;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (LowerCase(entry.path().extension().string()) == ".asf") all.push_back(entry.path());
  }
  const std::string clip = LowerCase(amc.stem().string());
  fs::path best;
  for (const fs::path& asf : all) {
    const std::string name = LowerCase(asf.stem().string());
    const bool is_longer = best.empty() || name.size() > best.stem().string().size();
    // "10" is not the beginning of "102_01".
    const bool begins = clip.starts_with(name) && (clip.size() == name.size() ||
                                                   std::isalnum(static_cast<unsigned char>(clip[name.size()])) == 0);
    if (begins && is_longer) best = asf;
  }
  if (!best.empty()) return best;
  if (all.size() == 1) return all.front();
  ThrowBadInput({amc.string(), "", "its skeleton, an .asf file in the same folder",
                 all.empty() ? "none" : fmt::format("{} of other names", all.size()),
                 fmt::format("put the .asf file of the subject beside it, with a name that {} begins with",
                             amc.stem().string())});
}

class AmcReader {
 public:
  AmcReader(const fs::path& amc, const AcclaimSkeleton& skeleton)
      : skeleton_(skeleton), lines_(amc, '#'), is_in_degrees_(skeleton.is_in_degrees) {
    for (const AcclaimBone& bone : skeleton.bones) {
      first_value_.push_back(values_.size());
      values_.resize(values_.size() + bone.channels.size());
      bone_of_[bone.name] = static_cast<int>(first_value_.size()) - 1;
    }
    frame_of_bone_.assign(skeleton.bones.size(), -1);
    motion_.joints = skeleton.joints;
    motion_.fps = kFramesPerSecond;
  }

  ArticulatedMotion Read() {
    while (lines_.Next()) {
      const std::string_view word = lines_.words().front();
      if (word.front() == ':') {
        ReadKeyword();
      } else if (lines_.words().size() == 1 && word.find_first_not_of("0123456789") == std::string_view::npos) {
        StartFrame();
      } else {
        ReadBone();
      }
    }
    if (frame_ < 0)
      lines_.Fail("the number of a frame and its bones", "this is not an Acclaim motion (.amc), or it is empty");
    FinishFrame();
    return std::move(motion_);
  }

 private:
  void ReadKeyword() {
    const std::string keyword = LowerCase(lines_.words().front());
    if (frame_ >= 0) lines_.Fail("the bones of a frame", kCutOff);
    if (keyword == ":degrees") is_in_degrees_ = true;
    if (keyword == ":radians") is_in_degrees_ = false;
  }

  void StartFrame() {
    const long long number = WholeNumber(lines_.words().front());
    if (number < 0) lines_.Fail("the number of a frame", kCutOff);
    if (frame_ >= 0) {
      FinishFrame();
      if (number != number_ + 1)
        lines_.Fail(fmt::format("frame {}", number_ + 1), "frames are missing", fmt::format("frame {}", number));
    }
    number_ = number;
    ++frame_;
  }

  void ReadBone() {
    if (frame_ < 0) lines_.Fail("the number of a frame", "this is not an Acclaim motion (.amc)");
    name_.assign(lines_.words().front());
    const auto found = bone_of_.find(name_);
    if (found == bone_of_.end()) {
      lines_.Fail(fmt::format("a bone of {}", skeleton_.file), "the clip belongs to another skeleton", Quoted(name_));
    }
    const auto bone = static_cast<std::size_t>(found->second);
    if (frame_of_bone_[bone] == frame_) {
      lines_.Fail(fmt::format("each bone once in frame {}", number_), kCutOff, fmt::format("{} again", name_));
    }
    frame_of_bone_[bone] = frame_;
    const std::size_t count = skeleton_.bones[bone].channels.size();
    if (lines_.words().size() == count + 1) {  // avoids making the message for every line
      for (std::size_t i = 0; i < count; ++i) values_[first_value_[bone] + i] = lines_.Number(i + 1);
    } else {
      lines_.Numbers(1, count, fmt::format("{} in frame {}", name_, number_), values_.data() + first_value_[bone]);
    }
  }

  void FinishFrame() {
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
      if (skeleton_.bones[b].channels.empty() || frame_of_bone_[b] == frame_) continue;
      lines_.Fail(fmt::format("bone {} in frame {}", skeleton_.bones[b].name, number_), kCutOff,
                  lines_.words().empty() ? "" : fmt::format("the next frame"));
    }
    Eigen::Vector3d root = Eigen::Vector3d::Zero();
    for (std::size_t b = 0; b < skeleton_.bones.size(); ++b) {
      const AcclaimBone& bone = skeleton_.bones[b];
      Eigen::Vector3d angles = Eigen::Vector3d::Zero();
      for (std::size_t c = 0; c < bone.channels.size(); ++c) {
        const Channel& channel = bone.channels[c];
        const double value = values_[first_value_[b] + c];
        if (channel.is_rotation) {
          angles[channel.axis] = is_in_degrees_ ? value * kRadPerDeg : value;
        } else {
          root[channel.axis] = value * skeleton_.unit_mm;
        }
      }
      Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
      for (const int axis : bone.order) turn = RotationAbout(axis, angles[axis]) * turn;
      motion_.parent_from_joint.push_back(ZUpFromYUp((bone.axis * turn * bone.axis.conjugate()).normalized()));
    }
    motion_.parent_from_joint.resize(
        motion_.parent_from_joint.size() + skeleton_.joints.size() - skeleton_.bones.size(),
        Eigen::Quaterniond::Identity());
    motion_.root_position_mm.push_back(ZUpFromYUp(skeleton_.root_position_mm + root));
  }

  const AcclaimSkeleton& skeleton_;
  TextLines lines_;
  bool is_in_degrees_;
  ArticulatedMotion motion_;
  std::unordered_map<std::string, int> bone_of_;
  std::vector<std::size_t> first_value_;  // of each bone in values_
  std::vector<double> values_;            // of the frame that is being read
  std::vector<int> frame_of_bone_;        // the last frame that had the bone
  std::string name_;
  int frame_ = -1;
  long long number_ = 0;  // the file's own number of the frame
};

}  // namespace

ArticulatedMotion ReadAcclaim(const fs::path& amc) {
  std::error_code error;
  if (!fs::is_regular_file(amc, error)) ThrowBadInput({amc.string(), "", "a motion file", "none", "check the path"});
  const fs::path asf = FindSkeletonFile(amc);
  ArticulatedMotion motion = AmcReader(amc, ReadAcclaimSkeleton(asf)).Read();
  motion.name = amc.stem().string();
  motion.subject = asf.stem().string();
  return motion;
}

}  // namespace canonpose
