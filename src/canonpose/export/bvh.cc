#include "canonpose/export/bvh.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/motion/channels.h"

namespace canonpose {
namespace {

constexpr double kCmPerMm = 0.1;
constexpr double kDegPerRad = DegFromRad(1.0);

/// Angles of R = Rz(angles[0]) * Rx(angles[1]) * Ry(angles[2]), rad.
using Angles = std::array<double, 3>;

double NearestTurn(double angle, double to) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return angle + kTurn * std::round((to - angle) / kTurn);
}

/// Each angle is computed from the rotation that remains after the previous one, so that their product is the rotation
/// even where x is near a right angle and z and y rotate about the same axis; there z keeps its previous value.
Angles AnglesOf(const Eigen::Matrix3d& rotation, const Angles& before) {
  const double cosine = std::hypot(rotation(0, 1), rotation(1, 1));
  const double z = cosine < 1e-7 ? before[0] : std::atan2(-rotation(0, 1), rotation(1, 1));
  const Eigen::Matrix3d rest = RotationAbout(2, -z).toRotationMatrix() * rotation;  // Rx * Ry
  const double x = std::atan2(rest(2, 1), rest(1, 1));
  const double y = std::atan2(rest(0, 2), rest(0, 0));
  // The same rotation also has other angles.
  const std::array<Angles, 2> ways = {{{z, x, y}, {z + std::numbers::pi, std::numbers::pi - x, y + std::numbers::pi}}};
  Angles nearest{};
  double smallest = -1.0;
  for (const Angles& way : ways) {
    Angles angles{};
    double distance = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      angles[i] = NearestTurn(way[i], before[i]);
      distance += std::abs(angles[i] - before[i]);
    }
    if (smallest >= 0.0 && distance >= smallest) continue;
    nearest = angles;
    smallest = distance;
  }
  return nearest;
}

class BvhWriter {
 public:
  explicit BvhWriter(const ArticulatedMotion& motion) : motion_(motion), children_(motion.joints.size()) {
    CANONPOSE_CHECK(!motion.joints.empty() && motion.joints.front().parent < 0 && motion.fps > 0.0, "{} joints, {} fps",
                    motion.joints.size(), motion.fps);
    for (std::size_t j = 1; j < motion.joints.size(); ++j) {
      const int parent = motion.joints[j].parent;
      CANONPOSE_CHECK(parent >= 0 && parent < static_cast<int>(j), "joint {} has parent {}", j, parent);
      children_[static_cast<std::size_t>(parent)].push_back(j);
    }
  }

  std::string Write() {
    text_ = "HIERARCHY\n";
    AddJoints();
    fmt::format_to(std::back_inserter(text_), "MOTION\nFrames: {}\nFrame Time: {:.10f}\n", motion_.frame_count(),
                   1.0 / motion_.fps);
    std::vector<Angles> angles(order_.size(), Angles{});
    for (int t = 0; t < motion_.frame_count(); ++t) AddFrame(static_cast<std::size_t>(t), angles);
    return std::move(text_);
  }

 private:
  [[nodiscard]] bool IsEndSite(std::size_t joint) const {
    const MotionJoint& end = motion_.joints[joint];
    if (end.parent < 0 || !children_[joint].empty() || end.offset_mm.isZero(0.0)) return false;
    const auto parent = static_cast<std::size_t>(end.parent);
    return children_[parent].size() == 1 && end.name == motion_.joints[parent].name + "_end";
  }

  void AddLine(int depth, const std::string& line) {
    text_.append(static_cast<std::size_t>(depth) * 2, ' ');
    text_ += line + '\n';
  }

  void AddOffset(int depth, const Eigen::Vector3d& offset_mm) {
    const Eigen::Vector3d cm = YUpFromZUp(offset_mm) * kCmPerMm;
    AddLine(depth, fmt::format("OFFSET {:.6f} {:.6f} {:.6f}", cm.x(), cm.y(), cm.z()));
  }

  void AddEndSite(int depth, const Eigen::Vector3d& offset_mm) {
    AddLine(depth, "End Site");
    AddLine(depth, "{");
    AddOffset(depth + 1, offset_mm);
    AddLine(depth, "}");
  }

  /// Traverses the tree with an explicit stack; each joint is on it once to be opened and once to be closed.
  void AddJoints() {
    struct Step {
      std::size_t joint;
      int depth;
      bool closes;
    };
    std::vector<Step> stack = {{0, 0, false}};
    while (!stack.empty()) {
      const Step step = stack.back();
      stack.pop_back();
      const MotionJoint& joint = motion_.joints[step.joint];
      if (step.closes) {
        AddLine(step.depth, "}");
        continue;
      }
      if (IsEndSite(step.joint)) {
        AddEndSite(step.depth, joint.offset_mm);
        continue;
      }
      order_.push_back(step.joint);
      AddLine(step.depth, fmt::format("{} {}", joint.parent < 0 ? "ROOT" : "JOINT", joint.name));
      AddLine(step.depth, "{");
      AddOffset(step.depth + 1, joint.offset_mm);
      AddLine(step.depth + 1, joint.parent < 0
                                  ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"
                                  : "CHANNELS 3 Zrotation Xrotation Yrotation");
      stack.push_back({step.joint, step.depth, true});
      const std::vector<std::size_t>& children = children_[step.joint];
      if (children.empty()) AddEndSite(step.depth + 1, Eigen::Vector3d::Zero());
      for (auto child = children.rbegin(); child != children.rend(); ++child) {
        stack.push_back({*child, step.depth + 1, false});
      }
    }
  }

  void AddFrame(std::size_t frame, std::vector<Angles>& angles) {
    const auto out = std::back_inserter(text_);
    const Eigen::Vector3d root = YUpFromZUp(motion_.root_position_mm[frame]) * kCmPerMm;
    fmt::format_to(out, "{:.6f} {:.6f} {:.6f}", root.x(), root.y(), root.z());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Eigen::Quaterniond& rotation = motion_.parent_from_joint[frame * motion_.joints.size() + order_[i]];
      angles[i] = AnglesOf(YUpFromZUp(rotation.normalized()).toRotationMatrix(), angles[i]);
      for (const double angle : angles[i]) fmt::format_to(out, " {:.6f}", angle * kDegPerRad);
    }
    text_ += '\n';
  }

  const ArticulatedMotion& motion_;
  std::vector<std::vector<std::size_t>> children_;  // of each joint
  std::vector<std::size_t> order_;                  // joints with channels, in the order of their values
  std::string text_;
};

/// The name with what file systems or shells do not like replaced.
std::string ForFileName(std::string name) {
  for (char& c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_' && c != '.') c = '_';
  }
  return name;
}

void WarnOfUnevenTimes(const std::vector<double>& times) {
  if (times.size() < 3) return;
  const double step = times.back() / static_cast<double>(times.size() - 1);
  double largest = 0.0;
  for (std::size_t t = 0; t < times.size(); ++t)
    largest = std::max(largest, std::abs(times[t] - step * static_cast<double>(t)));
  if (largest < 0.5 * step) return;
  LogWarning("frames are unevenly spaced, which BVH cannot say: they are up to {:.3f} s from where it has them",
             largest);
}

}  // namespace

void WriteBvh(const std::filesystem::path& path, const ArticulatedMotion& motion) {
  WriteFileAtomically(path, BvhWriter(motion).Write());
}

std::vector<std::filesystem::path> WriteSceneBvh(const std::filesystem::path& path, const Scene& scene,
                                                 const MotionExportOptions& options) {
  const SceneMotion motion = MakeSceneMotion(scene, options);
  WarnOfUnevenTimes(motion.times_seconds);
  std::vector<std::filesystem::path> files;
  for (const HierarchyFit& fit : motion.people) {
    std::filesystem::path file = path;
    if (motion.people.size() > 1) {
      file.replace_filename(
          fmt::format("{}-{}{}", path.stem().string(), ForFileName(fit.motion.name), path.extension().string()));
      if (std::ranges::find(files, file) != files.end()) {
        file.replace_filename(
            fmt::format("{}-{}{}", file.stem().string(), files.size() + 1, path.extension().string()));
      }
    }
    WriteBvh(file, fit.motion);
    files.push_back(file);
  }
  return files;
}

}  // namespace canonpose
