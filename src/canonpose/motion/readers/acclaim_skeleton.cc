#include "canonpose/motion/readers/acclaim_skeleton.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/motion/readers/text_lines.h"

namespace canonpose {
namespace {

constexpr double kInchMm = 25.4;
constexpr const char* kExportAgain = "the file is damaged; export or copy it again";

/// "rx" or "TZ" as a channel.
Channel ParseChannel(const TextLines& lines, std::string_view word) {
  const std::string lower = LowerCase(word);
  const bool is_channel =
      lower.size() == 2 && (lower[0] == 'r' || lower[0] == 't') && lower[1] >= 'x' && lower[1] <= 'z';
  if (!is_channel) lines.Fail("a degree of freedom: tx, ty, tz, rx, ry or rz", "", Quoted(word));
  return {lower[0] == 'r', lower[1] - 'x'};
}

/// Parses the words after the first as channels, each at most once.
std::vector<Channel> ParseChannels(const TextLines& lines) {
  std::vector<Channel> channels;
  std::set<std::pair<bool, int>> seen;
  for (std::size_t i = 1; i < lines.words().size(); ++i) {
    channels.push_back(ParseChannel(lines, lines.words()[i]));
    if (!seen.emplace(channels.back().is_rotation, channels.back().axis).second) {
      lines.Fail("each degree of freedom once", kExportAgain, Quoted(lines.words()[i]));
    }
  }
  return channels;
}

class AsfParser {
 public:
  explicit AsfParser(const std::filesystem::path& path) : lines_(path, '#') { skeleton_.file = path.string(); }

  AcclaimSkeleton Read() {
    AcclaimBone root;
    root.name = "root";
    bones_.push_back(root);
    while (lines_.Next()) {
      if (lines_.words().front().front() == ':') {
        if (is_in_block_) lines_.Fail(fmt::format("the end of bone {}", bone_.name), kExportAgain);
        section_ = LowerCase(lines_.words().front());
        sections_.insert(section_);
      } else if (section_.empty()) {
        lines_.Fail("a section such as :version", "this is not an Acclaim skeleton (.asf)");
      } else if (section_ == ":units") {
        ReadUnits();
      } else if (section_ == ":root") {
        ReadRoot();
      } else if (section_ == ":bonedata") {
        ReadBone();
      } else if (section_ == ":hierarchy") {
        ReadHierarchy();
      }
    }
    Finish();
    return std::move(skeleton_);
  }

 private:
  /// The angles of an axis line or of :root are in the file's units, which may only be given later.
  struct Turn {
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();
    int order[3] = {0, 1, 2};
  };

  void ReadUnits() {
    const std::string key = LowerCase(lines_.words().front());
    if (key == "length") {
      double length = 0.0;
      lines_.Numbers(1, 1, "length", &length);
      if (length <= 0.0) lines_.Fail("a length above 0", kExportAgain);
      skeleton_.unit_mm = kInchMm / length;
    } else if (key == "angle") {
      const std::string unit = lines_.words().size() == 2 ? LowerCase(lines_.words()[1]) : "";
      if (unit != "deg" && unit != "rad") lines_.Fail("angle deg or angle rad", kExportAgain);
      skeleton_.is_in_degrees = unit == "deg";
    }
  }

  void ParseOrder(std::string_view word, int (&order)[3]) {
    const std::string lower = LowerCase(word);
    std::string sorted = lower;
    std::sort(sorted.begin(), sorted.end());
    if (sorted != "xyz") lines_.Fail("an order of axes such as XYZ", kExportAgain, Quoted(word));
    for (std::size_t i = 0; i < 3; ++i) order[i] = lower[i] - 'x';
  }

  void ReadRoot() {
    const std::string key = LowerCase(lines_.words().front());
    if (key == "order") {
      bones_[0].channels = ParseChannels(lines_);
    } else if (key == "axis") {
      if (lines_.words().size() != 2) lines_.Fail("axis XYZ", kExportAgain);
      ParseOrder(lines_.words()[1], turns_["root"].order);
    } else if (key == "position") {
      lines_.Numbers(1, 3, "position", skeleton_.root_position_mm.data());
    } else if (key == "orientation") {
      lines_.Numbers(1, 3, "orientation", turns_["root"].angles.data());
    }
  }

  void ReadBone() {
    const std::string key = LowerCase(lines_.words().front());
    if (key == "begin") {
      if (is_in_block_) lines_.Fail("the end of the previous bone", kExportAgain);
      is_in_block_ = true;
      bone_ = AcclaimBone();
      turn_ = Turn();
      direction_ = Eigen::Vector3d::Zero();
      length_ = -1.0;
      return;
    }
    // The values of limits may be on separate lines.
    if (key.front() == '(') return;
    if (!is_in_block_) lines_.Fail("begin", kExportAgain);
    if (key == "name") {
      if (lines_.words().size() != 2) lines_.Fail("name and the bone's name", kExportAgain);
      bone_.name = std::string(lines_.words()[1]);
    } else if (key == "direction") {
      lines_.Numbers(1, 3, "direction", direction_.data());
    } else if (key == "length") {
      lines_.Numbers(1, 1, "length", &length_);
      if (length_ < 0.0) lines_.Fail("a length of 0 or more", kExportAgain);
    } else if (key == "axis") {
      if (lines_.words().size() == 5) ParseOrder(lines_.words()[4], turn_.order);
      const std::size_t values = lines_.words().size() == 5 ? 3 : lines_.words().size() - 1;
      if (values != 3) lines_.Fail("three angles and their order, such as axis 0 0 20 XYZ", kExportAgain);
      for (std::size_t i = 0; i < 3; ++i) turn_.angles[static_cast<Eigen::Index>(i)] = lines_.Number(i + 1);
    } else if (key == "dof") {
      bone_.channels = ParseChannels(lines_);
      for (const Channel& channel : bone_.channels) {
        if (!channel.is_rotation) lines_.Fail("rotations rx, ry or rz", "only the root of a body can move by itself");
      }
    } else if (key == "end") {
      FinishBone();
    }
  }

  void FinishBone() {
    is_in_block_ = false;
    if (bone_.name.empty()) lines_.Fail("a bone with a name", kExportAgain, "one without");
    if (bone_.name == "root" || turns_.count(bone_.name) > 0) {
      lines_.Fail("each bone once", kExportAgain, fmt::format("{} again", Quoted(bone_.name)));
    }
    if (length_ < 0.0) lines_.Fail(fmt::format("the length of {}", bone_.name), kExportAgain, "none");
    const double norm = direction_.norm();
    if (norm < 1e-6 && length_ > 0.0) lines_.Fail(fmt::format("the direction of {}", bone_.name), kExportAgain, "none");
    if (norm > 0.0) bone_.end_mm = direction_ * (length_ / norm);
    turns_[bone_.name] = turn_;
    bones_.push_back(bone_);
  }

  [[nodiscard]] int FindBone(std::string_view name) const {
    const auto bone = std::find_if(bones_.begin(), bones_.end(), [&](const AcclaimBone& b) { return b.name == name; });
    if (bone == bones_.end()) lines_.Fail("a bone of :bonedata", kExportAgain, Quoted(name));
    return static_cast<int>(bone - bones_.begin());
  }

  void ReadHierarchy() {
    const std::string key = LowerCase(lines_.words().front());
    if (key == "begin" || key == "end") {
      hierarchy_ended_ = key == "end";
      return;
    }
    const int parent = FindBone(lines_.words().front());
    for (std::size_t i = 1; i < lines_.words().size(); ++i) {
      const int child = FindBone(lines_.words()[i]);
      AcclaimBone& bone = bones_[static_cast<std::size_t>(child)];
      if (child == 0) lines_.Fail("a bone below the root", "the hierarchy contains a cycle", "'root'");
      if (bone.parent >= 0) {
        lines_.Fail(fmt::format("one parent of {}", bone.name), "the hierarchy names it twice",
                    fmt::format("{} and {}", bones_[static_cast<std::size_t>(bone.parent)].name,
                                bones_[static_cast<std::size_t>(parent)].name));
      }
      bone.parent = parent;
      children_[parent].push_back(child);
    }
  }

  [[noreturn]] void Fail(const std::string& expected, const std::string& found, const std::string& advice) const {
    ThrowBadInput({skeleton_.file, "", expected, found, advice});
  }

  void Finish() {
    for (const char* section : {":units", ":root", ":bonedata", ":hierarchy"}) {
      if (sections_.count(section) == 0) {
        Fail(fmt::format("a section {}", section), sections_.empty() ? "an empty file" : "none",
             "this is not an Acclaim skeleton (.asf), or it was cut off");
      }
    }
    if (is_in_block_) Fail(fmt::format("the end of bone {}", bone_.name), "the end of the file", "it was cut off");
    if (!hierarchy_ended_) Fail("the end of :hierarchy", "the end of the file", "it was cut off");
    if (skeleton_.unit_mm <= 0.0) Fail("the length in :units", "none", kExportAgain);
    if (bones_[0].channels.empty()) Fail("the order of the values in :root", "none", kExportAgain);
    skeleton_.root_position_mm *= skeleton_.unit_mm;
    AddBone(0, -1);
    if (skeleton_.bones.size() != bones_.size()) {
      const std::set<std::string> reached = Names(skeleton_.bones);
      for (const AcclaimBone& bone : bones_) {
        if (reached.count(bone.name) > 0) continue;
        Fail(fmt::format("a path from the root to {} in :hierarchy", bone.name), "none",
             "the hierarchy lacks a line or contains a cycle");
      }
    }
    AddJoints();
  }

  static std::set<std::string> Names(const std::vector<AcclaimBone>& bones) {
    std::set<std::string> names;
    for (const AcclaimBone& bone : bones) names.insert(bone.name);
    return names;
  }

  /// Adds a bone and everything below it. Each bone has one parent, so this is a tree and the loop ends.
  void AddBone(int from, int parent) {
    std::vector<std::pair<int, int>> stack = {{from, parent}};
    while (!stack.empty()) {
      const auto [index, new_parent] = stack.back();
      stack.pop_back();
      AcclaimBone bone = bones_[static_cast<std::size_t>(index)];
      bone.parent = new_parent;
      bone.end_mm *= skeleton_.unit_mm;
      const Turn& turn = turns_[bone.name];
      for (int i = 0; i < 3; ++i) {
        bone.order[i] = turn.order[i];
        const double angle = turn.angles[i];
        bone.axis = RotationAbout(turn.order[i], skeleton_.is_in_degrees ? angle * kRadPerDeg : angle) * bone.axis;
      }
      const int position = static_cast<int>(skeleton_.bones.size());
      skeleton_.bones.push_back(std::move(bone));
      const std::vector<int>& children = children_[index];
      for (auto child = children.rbegin(); child != children.rend(); ++child) stack.emplace_back(*child, position);
    }
  }

  void AddJoints() {
    std::set<std::string> names = Names(skeleton_.bones);
    std::vector<bool> has_child(skeleton_.bones.size(), false);
    for (const AcclaimBone& bone : skeleton_.bones) {
      const Eigen::Vector3d offset = bone.parent < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                     : skeleton_.bones[static_cast<std::size_t>(bone.parent)].end_mm;
      skeleton_.joints.push_back({bone.name, bone.parent, ZUpFromYUp(offset)});
      if (bone.parent >= 0) has_child[static_cast<std::size_t>(bone.parent)] = true;
    }
    for (std::size_t i = 0; i < has_child.size(); ++i) {
      if (has_child[i] || i == 0) continue;
      const std::string name = skeleton_.bones[i].name + "_end";
      if (!names.insert(name).second) Fail("bones with different names", fmt::format("a bone {}", name), "rename it");
      skeleton_.joints.push_back({name, static_cast<int>(i), ZUpFromYUp(skeleton_.bones[i].end_mm)});
    }
  }

  TextLines lines_;
  AcclaimSkeleton skeleton_;
  std::string section_;
  std::set<std::string> sections_;
  std::vector<AcclaimBone> bones_;  // in the file's order and units
  std::map<std::string, Turn> turns_;
  std::map<int, std::vector<int>> children_;
  bool hierarchy_ended_ = false;
  bool is_in_block_ = false;
  AcclaimBone bone_;
  Turn turn_;
  Eigen::Vector3d direction_ = Eigen::Vector3d::Zero();
  double length_ = -1.0;
};

}  // namespace

AcclaimSkeleton ReadAcclaimSkeleton(const std::filesystem::path& asf) { return AsfParser(asf).Read(); }

}  // namespace canonpose
