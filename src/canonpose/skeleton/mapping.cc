#include "canonpose/skeleton/mapping.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/skeleton/joint_names.h"

namespace canonpose {
namespace {

/// A part of the body and its names, the least ambiguous first, without side, case and punctuation.
struct Part {
  std::string_view name;
  bool sided;
  std::vector<std::string_view> aliases;
};

const std::vector<Part>& Parts() {
  static const std::vector<Part> parts = {
      {"hip", true, {"hip", "upleg", "upperleg"}},
      {"knee", true, {"knee", "kne", "leg", "lowerleg"}},
      {"ankle", true, {"ankle", "ank", "foot"}},
      // Mixamo's and MotionBuilder's "LeftShoulder" is the collar bone. It ends where "LeftArm" begins: in the
      // shoulder.
      {"shoulder", true, {"arm", "upperarm", "shoulder", "sho"}},
      {"elbow", true, {"elbow", "elb", "forearm", "lowerarm"}},
      {"wrist", true, {"wrist", "wri", "hand"}},
      {"eye", true, {"eye"}},
      {"ear", true, {"ear"}},
      {"bigtoe", true, {"bigtoe"}},
      {"smalltoe", true, {"smalltoe"}},
      {"heel", true, {"heel"}},
      {"pelvis", false, {"midhip", "pelvis", "hip", "root", "hips"}},
      {"spine", false, {"spine"}},
      {"thorax", false, {"thorax"}},
      {"nose", false, {"nose", "necknose"}},
      {"headtop", false, {"headtop", "headtopend", "tophead", "head"}},
  };
  return parts;
}

/// Lower case without punctuation, "left" and "right" shortened to "l" and "r" and in front: "lknee" for "knee_left",
/// "Left Knee" and "knee.L".
std::string PlainName(std::string_view joint) {
  std::string plain;
  for (const char c : joint) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const std::string_view side : {"left", "right"}) {
    if (plain.size() <= side.size()) continue;
    if (plain.starts_with(side)) return plain.substr(0, 1) + plain.substr(side.size());
    if (plain.ends_with(side)) return std::string(side.substr(0, 1)) + plain.substr(0, plain.size() - side.size());
  }
  const bool is_letter_apart = joint.size() > 2 && std::isalnum(static_cast<unsigned char>(joint.back())) != 0 &&
                               std::isalnum(static_cast<unsigned char>(joint[joint.size() - 2])) == 0;
  if (is_letter_apart && (plain.back() == 'l' || plain.back() == 'r'))
    return plain.substr(plain.size() - 1) + plain.substr(0, plain.size() - 1);
  return plain;
}

/// "lshoulder", "pelvis", ...; empty where the name is not in the table of parts.
std::string PartOf(std::string_view joint) {
  const std::string plain = PlainName(joint);
  // A target's neck is at shoulder height and is made like the thorax, not from a detector's neck, which is higher.
  if (plain == "neck") return "thorax";
  for (const Part& part : Parts()) {
    for (const std::string_view alias : part.aliases) {
      if (!part.sided && plain == alias) return std::string(part.name);
      if (part.sided && plain.size() == alias.size() + 1 && plain.ends_with(alias) &&
          (plain.front() == 'l' || plain.front() == 'r')) {
        return plain.front() + std::string(part.name);
      }
    }
  }
  return "";
}

/// The index of a name, ignoring case.
std::optional<int> FindName(const std::vector<std::string>& names, std::string_view name) {
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (SameName(names[j], name)) return static_cast<int>(j);
  }
  return std::nullopt;
}

/// Finds parts of the body in a layout, and derives those it lacks by the field's convention.
class PartFinder {
 public:
  explicit PartFinder(const Skeleton& layout) : names_(WithoutPrefix(layout.joints)) {}

  /// The joints whose mean is the part; empty where the layout lacks them.
  [[nodiscard]] std::vector<int> Make(const std::string& part) const {
    // Pelvis, spine and thorax are derived from hips and shoulders, so that they are the same for every detector.
    if (const std::optional<int> own = Own(part)) return {*own};
    if (part == "pelvis") return MeanOf({"lhip", "rhip"});
    if (part == "thorax") return MeanOf({"lshoulder", "rshoulder"});
    if (part == "spine") return MeanOf({"lhip", "rhip", "lshoulder", "rshoulder"});
    if (part == "headtop") {
      const std::vector<int> eyes = MeanOf({"leye", "reye"});
      return eyes.empty() ? MeanOf({"lear", "rear"}) : eyes;
    }
    // MPI-INF-3DHP has the centre of the head and its top; the centre is used as the nose.
    if (part == "nose") {
      const std::optional<int> head = FindName(names_, "head");
      if (head && Own("headtop") != head) return {*head};
    }
    return {};
  }

  /// The joint of the layout that is this part, by the least ambiguous of its names.
  [[nodiscard]] std::optional<int> Own(const std::string& part) const {
    for (const Part& row : Parts()) {
      const std::string name(row.name);
      if (row.sided ? part != "l" + name && part != "r" + name : part != name) continue;
      for (const std::string_view alias : row.aliases) {
        const std::string wanted = (row.sided ? part.substr(0, 1) : "") + std::string(alias);
        for (std::size_t j = 0; j < names_.size(); ++j) {
          if (PlainName(names_[j]) == wanted) return static_cast<int>(j);
        }
      }
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::vector<int> MeanOf(const std::vector<std::string>& parts) const {
    std::vector<int> joints;
    for (const std::string& part : parts) {
      const std::optional<int> joint = Own(part);
      if (!joint) return {};
      joints.push_back(*joint);
    }
    return joints;
  }

  std::vector<std::string> names_;
};

/// Whether both have the same names, in any order.
bool AreSameNames(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  return a.size() == b.size() &&
         std::all_of(a.begin(), a.end(), [&](const std::string& name) { return FindName(b, name).has_value(); });
}

}  // namespace

std::string LayoutMapping::Describe(int target_joint) const {
  const auto t = static_cast<std::size_t>(target_joint);
  std::vector<std::string> names;
  for (const int s : joints[t].sources) names.push_back(source.joints[static_cast<std::size_t>(s)]);
  if (names.empty()) return fmt::format("{} = nothing", target.joints[t]);
  if (names.size() == 1) return names.front();
  return fmt::format("{} = mean({})", target.joints[t], fmt::join(names, ", "));
}

std::vector<std::string> LayoutMapping::DescribeAll() const {
  std::vector<std::string> lines;
  for (int t = 0; t < target.joint_count(); ++t) lines.push_back(Describe(t));
  return lines;
}

std::vector<int> LayoutMapping::derived() const {
  std::vector<int> flags;
  for (const JointSource& joint : joints) flags.push_back(joint.derived() ? 1 : 0);
  return flags;
}

std::optional<int> FindPart(const Skeleton& layout, std::string_view part) {
  return PartFinder(layout).Own(std::string(part));
}

LayoutMapping MapAvailableJoints(const Skeleton& source, const Skeleton& target) {
  LayoutMapping mapping{source, target, {}};
  const PartFinder finder(source);
  const std::vector<std::string> source_names = WithoutPrefix(source.joints);
  const std::vector<std::string> target_names = WithoutPrefix(target.joints);
  const bool same = AreSameNames(source_names, target_names);
  for (const std::string& joint : target_names) {
    JointSource made;
    if (!same) made.sources = finder.Make(PartOf(joint));
    if (made.sources.empty()) {
      if (const std::optional<int> exact = FindName(source_names, joint)) made.sources = {*exact};
    }
    mapping.joints.push_back(std::move(made));
  }
  return mapping;
}

LayoutMapping MapLayout(const Skeleton& source, const Skeleton& target) {
  LayoutMapping mapping = MapAvailableJoints(source, target);
  std::vector<std::string> missing;
  for (std::size_t t = 0; t < mapping.joints.size(); ++t) {
    if (mapping.joints[t].sources.empty()) missing.push_back(target.joints[t]);
  }
  if (!missing.empty()) {
    ThrowBadInput({"", fmt::format("layout {}", source.name.empty() ? "of the input" : source.name),
                   fmt::format("joints for {}", target.name.empty() ? "the skeleton" : target.name),
                   fmt::format("none that give {}", fmt::join(missing, ", ")),
                   fmt::format("check the layout; the known layouts are {}", BuiltinSkeletonNames())});
  }
  return mapping;
}

void ApplyMapping(const LayoutMapping& mapping, const float* keypoints, const float* confidence,
                  float* mapped_keypoints, float* mapped_confidence) {
  for (std::size_t t = 0; t < mapping.joints.size(); ++t) {
    double x = 0.0;
    double y = 0.0;
    float least = std::numeric_limits<float>::infinity();
    bool missing = mapping.joints[t].sources.empty();
    for (const int source : mapping.joints[t].sources) {
      const auto s = static_cast<std::size_t>(source);
      missing |= !std::isfinite(keypoints[2 * s]) || !std::isfinite(keypoints[2 * s + 1]) || !(confidence[s] > 0.0F);
      x += keypoints[2 * s];
      y += keypoints[2 * s + 1];
      least = std::min(least, confidence[s]);
    }
    const auto count = static_cast<double>(mapping.joints[t].sources.size());
    mapped_keypoints[2 * t] = missing ? NAN : static_cast<float>(x / count);
    mapped_keypoints[2 * t + 1] = missing ? NAN : static_cast<float>(y / count);
    mapped_confidence[t] = missing ? 0.0F : least;
  }
}

}  // namespace canonpose
