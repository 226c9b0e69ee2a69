#include "canonpose/motion/readers/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/names.h"
#include "canonpose/motion/channels.h"
#include "canonpose/motion/landmark_mapping.h"
#include "canonpose/motion/readers/text_lines.h"
#include "canonpose/motion/up_axis.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDamaged = "the file is damaged; export or copy it again";
/// Joints other than the root may deviate from their offset by this fraction of the stature, which is an exporter's
/// noise.
constexpr double kLargestStretch = 0.001;
constexpr double kLowestStatureMm = 1200.0;
constexpr double kHighestStatureMm = 2300.0;

/// One joint of the hierarchy, with its offset as in the file: y up and in the file's unit.
struct BvhJoint {
  std::string name;
  int parent = -1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::vector<Channel> channels;
  std::size_t first_value = 0;  // of its channels in a row
  bool is_end_site = false;
  bool has_offset = false;
  bool has_channels = false;
};

/// An End Site with a zero offset is not a joint: it only closes a leaf, as those of WriteBvh() do.
bool IsEmptyEndSite(const BvhJoint& joint) { return joint.is_end_site && joint.offset.isZero(0.0); }

struct BvhFile {
  std::vector<BvhJoint> joints;
  std::size_t row = 0;  // values per frame
  std::size_t frames = 0;
  double fps = 0.0;
  std::vector<double> values;  // (frames, row)
};

class BvhParser {
 public:
  explicit BvhParser(const fs::path& path) : lines_(path) {}

  BvhFile Read() {
    if (!lines_.Next() || !SameName(lines_.words().front(), "HIERARCHY"))
      lines_.Fail("HIERARCHY", "this is not a BVH file");
    while (Advance("MOTION")) {
      if (SameName(Word(), "MOTION")) break;
      ReadHierarchyWord();
    }
    if (!open_.empty()) {
      lines_.Fail(fmt::format("the closing brace of {}", Top().name), "the file is damaged: its braces do not balance");
    }
    if (file_.joints.empty()) lines_.Fail("ROOT", kDamaged);
    if (file_.row == 0) lines_.Fail("a hierarchy with channels", "nothing in this file moves", "none");
    ReadMotion();
    return std::move(file_);
  }

 private:
  [[nodiscard]] std::string_view Word() const { return lines_.words()[word_]; }
  BvhJoint& Top() { return file_.joints[static_cast<std::size_t>(open_.back())]; }

  /// Moves to the next word, on this line or a later one.
  bool Advance(const char* expected) {
    if (++word_ < lines_.words().size()) return true;
    word_ = 0;
    if (!lines_.Next()) lines_.Fail(expected, "the file was cut off; export or copy it again");
    return true;
  }

  void ReadHierarchyWord() {
    if (SameName(Word(), "ROOT")) {
      if (!file_.joints.empty()) lines_.Fail("one ROOT", "write each body to its own file", "a second one");
      OpenJoint(false);
    } else if (open_.empty()) {
      lines_.Fail("ROOT or MOTION", "the file is damaged: its braces do not balance", Quoted(Word()));
    } else if (SameName(Word(), "JOINT")) {
      OpenJoint(false);
    } else if (SameName(Word(), "End")) {
      OpenJoint(true);
    } else if (SameName(Word(), "OFFSET")) {
      if (Top().has_offset) lines_.Fail(fmt::format("one OFFSET of {}", Top().name), kDamaged, "a second one");
      lines_.Numbers(word_ + 1, 3, "OFFSET", Top().offset.data());
      Top().has_offset = true;
      word_ = lines_.words().size();
    } else if (SameName(Word(), "CHANNELS")) {
      ReadChannels();
    } else if (Word() == "}") {
      CloseJoint();
    } else {
      lines_.Fail("OFFSET, CHANNELS, JOINT, End Site or a brace", kDamaged, Quoted(Word()));
    }
  }

  /// "JOINT name {": names may contain blanks, and the brace may be on the next line.
  void OpenJoint(bool is_end_site) {
    BvhJoint joint;
    joint.parent = open_.empty() ? -1 : open_.back();
    joint.is_end_site = is_end_site;
    if (joint.parent >= 0 && Top().is_end_site) lines_.Fail("nothing below an End Site", kDamaged, Quoted(Word()));
    std::string name;
    while (word_ + 1 < lines_.words().size() && lines_.words()[word_ + 1] != "{") {
      ++word_;
      name += (name.empty() ? "" : " ") + std::string(Word());
    }
    joint.name = is_end_site ? Top().name + "_end" : name;
    if (joint.name.empty()) lines_.Fail("a joint with a name", kDamaged, "none");
    if (!is_end_site) TakeName(joint.name);
    Advance("{");
    if (Word() != "{") lines_.Fail(fmt::format("the opening brace of {}", joint.name), kDamaged, Quoted(Word()));
    open_.push_back(static_cast<int>(file_.joints.size()));
    file_.joints.push_back(std::move(joint));
  }

  void TakeName(const std::string& name) {
    if (names_.insert(name).second) return;
    lines_.Fail("each joint once", "give the joints different names", fmt::format("{} again", Quoted(name)));
  }

  void CloseJoint() {
    if (!Top().has_offset) lines_.Fail(fmt::format("the OFFSET of {}", Top().name), kDamaged, "none");
    if (!Top().is_end_site && !Top().has_channels) {
      lines_.Fail(fmt::format("the CHANNELS of {}", Top().name), kDamaged, "none");
    }
    if (Top().is_end_site && !IsEmptyEndSite(Top())) TakeName(Top().name);
    open_.pop_back();
  }

  void ReadChannels() {
    BvhJoint& joint = Top();
    if (joint.is_end_site) lines_.Fail("no CHANNELS in an End Site", kDamaged);
    if (joint.has_channels) lines_.Fail("one line of CHANNELS", kDamaged, "a second one");
    const std::size_t named = lines_.words().size() - word_ - 1;
    const long long count = named > 0 ? WholeNumber(lines_.words()[word_ + 1]) : -1;
    if (count < 0 || count > 6) lines_.Fail("a count of channels from 0 to 6", kDamaged);
    if (static_cast<std::size_t>(count) != named - 1) {
      lines_.Fail(fmt::format("{} channels of {}", count, joint.name), kDamaged, fmt::format("{} names", named - 1));
    }
    std::set<std::pair<bool, int>> seen;
    for (++word_; word_ + 1 < lines_.words().size();) {
      ++word_;
      const std::string name = LowerCase(Word());
      const Channel channel = {name.ends_with("rotation"), name.empty() ? 0 : name[0] - 'x'};
      if (name != fmt::format("{}{}", static_cast<char>('x' + channel.axis),
                              channel.is_rotation ? "rotation" : "position") ||
          channel.axis < 0 || channel.axis > 2) {
        lines_.Fail("a channel: Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation", kDamaged,
                    Quoted(Word()));
      }
      if (!seen.emplace(channel.is_rotation, channel.axis).second) {
        lines_.Fail("each channel once", kDamaged, fmt::format("{} again", Quoted(Word())));
      }
      joint.channels.push_back(channel);
    }
    joint.has_channels = true;
    joint.first_value = file_.row;
    file_.row += joint.channels.size();
  }

  /// The number of a line such as "Frame Time: 0.1"; there may be no blank after the colon.
  double ReadHeaderLine(const char* key) {
    const std::string expected = fmt::format("{}: and a number", key);
    if (!lines_.Next()) lines_.Fail(expected, "the file was cut off; export or copy it again");
    std::string line;
    for (const std::string_view word : lines_.words()) line += (line.empty() ? "" : " ") + std::string(word);
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || !SameName(line.substr(0, colon), key)) lines_.Fail(expected, kDamaged);
    const std::size_t begin = line.find_first_not_of(' ', colon + 1);
    if (begin == std::string::npos) lines_.Fail(expected, kDamaged);
    return lines_.ParseNumber(std::string_view(line).substr(begin));
  }

  void ReadMotion() {
    const double frames = ReadHeaderLine("Frames");
    if (frames < 1.0 || frames != std::floor(frames)) lines_.Fail("a whole number of frames, at least 1", kDamaged);
    const double seconds = ReadHeaderLine("Frame Time");
    if (!(seconds >= 1e-6 && seconds <= 10.0)) lines_.Fail("a frame time above 0 and up to 10 seconds", kDamaged);
    // Exporters write few digits: 0.0333333 is 30 frames per second, 0.008333 is 120.
    file_.fps = 1.0 / seconds;
    if (std::abs(std::round(file_.fps) - file_.fps) < 2e-4 * file_.fps) file_.fps = std::round(file_.fps);
    // A value takes at least two bytes, which limits how many the file can contain whatever count it claims.
    const double max_frames = static_cast<double>(lines_.bytes_left() + 1) / 2.0 / static_cast<double>(file_.row);
    file_.values.reserve(static_cast<std::size_t>(std::min(frames, max_frames)) * file_.row);
    while (lines_.Next()) {
      if (static_cast<double>(file_.frames) == frames) {
        lines_.Fail(fmt::format("{} rows, the number after Frames:", frames), kDamaged, "more rows");
      }
      ++file_.frames;
      const std::size_t begin = file_.values.size();
      file_.values.resize(begin + file_.row);
      if (lines_.words().size() == file_.row) {
        for (std::size_t i = 0; i < file_.row; ++i) file_.values[begin + i] = lines_.Number(i);
      } else {
        lines_.Numbers(0, file_.row, fmt::format("frame {}, one for each channel", file_.frames), &file_.values[begin]);
      }
    }
    if (static_cast<double>(file_.frames) != frames) {
      lines_.Fail(fmt::format("{} rows, the number after Frames:", frames),
                  "the file was cut off; export or copy it again", fmt::format("{} rows", file_.frames));
    }
  }

  TextLines lines_;
  std::size_t word_ = 0;  // of the line, while the hierarchy is read
  BvhFile file_;
  std::vector<int> open_;  // joints whose brace is open
  std::set<std::string> names_;
};

struct Unit {
  const char* name;
  double mm;
};

/// The unit with which the body is as tall as a person.
double GuessUnit(const std::string& file, const std::vector<MotionJoint>& joints) {
  static constexpr std::array<Unit, 6> kUnits = {{{"millimetres", 1.0},
                                                  {"centimetres", 10.0},
                                                  {"decimetres", 100.0},
                                                  {"inches", 25.4},
                                                  {"CMU's units", 25.4 / 0.45},
                                                  {"metres", 1000.0}}};
  double stature = StatureByLegs(joints);
  if (stature <= 0.0) {
    // Without known names: people's arm span is about their stature, so the largest extent of the rest pose will do.
    ArticulatedMotion rest;
    rest.joints = joints;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& position : RestPose(rest)) box.extend(position);
    stature = box.sizes().maxCoeff();
  }
  const Unit* best = nullptr;
  double smallest = std::numeric_limits<double>::infinity();
  for (const Unit& unit : kUnits) {
    // The ranges of decimetres and CMU's units overlap; the more usual stature is more likely.
    const double distance = std::abs(std::log(stature * unit.mm / 1700.0));
    const bool is_plausible = stature * unit.mm >= kLowestStatureMm && stature * unit.mm <= kHighestStatureMm;
    if (is_plausible && distance < smallest) {
      best = &unit;
      smallest = distance;
    }
  }
  if (best == nullptr) {
    ThrowBadInput({file, "HIERARCHY", "a body between 1.2 and 2.3 m tall in mm, cm, dm, inches, CMU's units or m",
                   fmt::format("one {:.4g} units tall", stature), "give the length of its unit"});
  }
  LogInfo("{}: assuming lengths in {}, with which the body is {:.2f} m tall", file, best->name,
          stature * best->mm / 1000.0);
  return best->mm;
}

/// Where a joint's positions deviate from its offset by more than `largest`: the frame, and the axis in `axis`. -1
/// where they do not, as in any articulated body.
std::ptrdiff_t FrameOfStretch(const BvhFile& bvh, const BvhJoint& joint, double largest, int& axis) {
  for (std::size_t c = 0; c < joint.channels.size(); ++c) {
    if (joint.channels[c].is_rotation) continue;
    axis = joint.channels[c].axis;
    for (std::size_t t = 0; t < bvh.frames; ++t) {
      if (std::abs(bvh.values[t * bvh.row + joint.first_value + c] - joint.offset[axis]) > largest)
        return static_cast<std::ptrdiff_t>(t);
    }
  }
  return -1;
}

void RefuseStretch(const std::string& file, const BvhFile& bvh, const BvhJoint& joint, double largest) {
  int axis = 0;
  const std::ptrdiff_t frame = FrameOfStretch(bvh, joint, largest, axis);
  if (frame < 0) return;
  double value = 0.0;
  for (std::size_t c = 0; c < joint.channels.size(); ++c) {
    if (!joint.channels[c].is_rotation && joint.channels[c].axis == axis)
      value = bvh.values[static_cast<std::size_t>(frame) * bvh.row + joint.first_value + c];
  }
  ThrowBadInput(
      {file, fmt::format("frame {}", frame + 1),
       fmt::format("{} at its OFFSET, {:.6g} along {}", joint.name, joint.offset[axis], static_cast<char>('x' + axis)),
       fmt::format("{:.6g}", value), "export it with bones of constant length"});
}

/// Which joints make up the body: all, or those below a joint that carries the motion instead of the root.
struct Body {
  int root = 0;
  std::vector<bool> is_above;  ///< the ancestors of `root`, whose motion becomes part of the root's
  std::vector<bool> is_below;  ///< `root` and its descendants
  int left_out = 0;            ///< joints that are neither
};

Body BodyBelow(const BvhFile& bvh, int root) {
  Body body;
  body.root = root;
  body.is_above.assign(bvh.joints.size(), false);
  body.is_below.assign(bvh.joints.size(), false);
  for (int j = bvh.joints[static_cast<std::size_t>(root)].parent; j >= 0;
       j = bvh.joints[static_cast<std::size_t>(j)].parent) {
    body.is_above[static_cast<std::size_t>(j)] = true;
  }
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const int parent = bvh.joints[j].parent;
    body.is_below[j] = static_cast<int>(j) == root || (parent >= 0 && body.is_below[static_cast<std::size_t>(parent)]);
    body.left_out += body.is_below[j] || body.is_above[j] ? 0 : 1;
  }
  return body;
}

/// Exporters put still joints above the hips ("Armature", "Reference"), which then carry the motion: the first joint
/// that moves relative to its parent and has nearly all others below it.
Body FindBody(const BvhFile& bvh, double largest_stretch) {
  constexpr double kNearlyAll = 0.7;
  for (std::size_t j = 1; j < bvh.joints.size(); ++j) {
    int axis = 0;
    if (FrameOfStretch(bvh, bvh.joints[j], largest_stretch, axis) < 0) continue;
    Body body = BodyBelow(bvh, static_cast<int>(j));
    const auto below = std::count(body.is_below.begin(), body.is_below.end(), true);
    if (static_cast<double>(below) >= kNearlyAll * static_cast<double>(below + body.left_out)) return body;
  }
  return BodyBelow(bvh, 0);
}

/// The joints of the body in the rest pose, z up, in the file's unit; end sites of zero length are left out.
/// `is_left_out` gets which of the file's joints are not among them.
std::vector<MotionJoint> JointsOf(const BvhFile& bvh, const Body& body, std::vector<bool>& is_left_out) {
  std::vector<MotionJoint> joints;
  std::vector<int> new_index(bvh.joints.size(), -1);
  is_left_out.assign(bvh.joints.size(), false);
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const BvhJoint& joint = bvh.joints[j];
    is_left_out[j] = IsEmptyEndSite(joint) || !body.is_below[j];
    if (is_left_out[j]) continue;
    new_index[j] = static_cast<int>(joints.size());
    const bool is_root = static_cast<int>(j) == body.root;
    joints.push_back({joint.name, is_root ? -1 : new_index[static_cast<std::size_t>(joint.parent)],
                      is_root ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : ZUpFromYUp(joint.offset)});
  }
  return joints;
}

void AddFrame(const BvhFile& bvh, const Body& body, const std::vector<bool>& is_left_out, std::size_t frame,
              double unit_mm, ArticulatedMotion& motion) {
  const double* row = &bvh.values[frame * bvh.row];
  Eigen::Quaterniond world_from_parent = Eigen::Quaterniond::Identity();  // of the body's root
  Eigen::Vector3d parent_position = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    if (is_left_out[j] && !body.is_above[j]) continue;
    const BvhJoint& joint = bvh.joints[j];
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d position = joint.offset;
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      const Channel& channel = joint.channels[c];
      const double value = row[joint.first_value + c];
      if (channel.is_rotation) {
        rotation = rotation * RotationAbout(channel.axis, value * kRadPerDeg);
      } else {
        position[channel.axis] = value;
      }
    }
    if (static_cast<int>(j) <= body.root && body.root > 0) {
      parent_position += world_from_parent * position;
      world_from_parent = world_from_parent * rotation;
      if (body.is_above[j]) continue;
      position = parent_position;
      rotation = world_from_parent;
    }
    if (static_cast<int>(j) == body.root) motion.root_position_mm.push_back(ZUpFromYUp(position) * unit_mm);
    motion.parent_from_joint.push_back(ZUpFromYUp(rotation.normalized()));
  }
}

}  // namespace

ArticulatedMotion ReadBvh(const fs::path& path, double unit_mm) {
  const BvhFile bvh = BvhParser(path).Read();
  const std::string file = path.string();
  ArticulatedMotion motion;
  motion.name = path.stem().string();
  motion.subject = fs::absolute(path).parent_path().filename().string();
  motion.fps = bvh.fps;
  std::vector<bool> is_left_out;
  Body body = BodyBelow(bvh, 0);
  motion.joints = JointsOf(bvh, body, is_left_out);
  if (unit_mm <= 0.0) unit_mm = GuessUnit(file, motion.joints);
  const double largest_stretch = kLargestStretch * 1700.0 / unit_mm;
  body = FindBody(bvh, largest_stretch);
  if (body.root > 0) {
    motion.joints = JointsOf(bvh, body, is_left_out);
    LogInfo("{}: {} carries the motion and is taken as the root{}", file, motion.joints.front().name,
            body.left_out > 0 ? fmt::format("; {} joints beside it are left out", body.left_out) : "");
  }
  for (MotionJoint& joint : motion.joints) joint.offset_mm *= unit_mm;
  for (std::size_t j = 1; j < bvh.joints.size(); ++j) {
    if (!is_left_out[j] && static_cast<int>(j) != body.root) RefuseStretch(file, bvh, bvh.joints[j], largest_stretch);
  }
  motion.root_position_mm.reserve(bvh.frames);
  motion.parent_from_joint.reserve(bvh.frames * motion.joints.size());
  for (std::size_t t = 0; t < bvh.frames; ++t) AddFrame(bvh, body, is_left_out, t, unit_mm, motion);
  StandUpright(motion, file);
  return motion;
}

}  // namespace canonpose
