#include "canonpose/view/skeleton_strip.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/skeleton/mapping.h"
#include "canonpose/view/display_frame.h"
#include "canonpose/view/joint_sides.h"

namespace canonpose {
namespace {

constexpr const char* kMiddleColour = "#5A6069";
constexpr double kPxPerMetre = 130.0;
constexpr double kLimbWidth = 0.052;  ///< metres, as all lengths of a DisplayFrame
constexpr double kHeadRadius = 0.085;
constexpr double kMargin = 0.16;
constexpr double kLabelPx = 13.0;

/// Axes of the paper in displayed coordinates.
struct View {
  Eigen::Vector3d right;
  Eigen::Vector3d towards;  ///< the viewer
};

struct Point {
  double x = 0.0;
  double height = 0.0;
  double nearness = 0.0;
};

struct Limb {
  Point from;
  Point to;
  char side = 'm';
};

/// One frame of one result, about the middle of its people.
struct Figure {
  std::vector<Limb> limbs;
  std::vector<Point> heads;
};

struct Row {
  const Scene& scene;
  DisplayFrame display;
  std::string name;
};

Eigen::Vector3d Shown(const Row& row, const PoseSequence& person, int frame, int joint) {
  return row.display.Show(person.PoseAt(frame).row(joint).transpose().cast<double>());
}

/// Where the first person looks in the first frame: at right angles to the line between hips, or shoulders.
Eigen::Vector3d Facing(const Row& row, int frame) {
  const PoseSequence& person = row.scene.people.front();
  for (const char* part : {"hip", "shoulder"}) {
    const std::optional<int> left = FindPart(person.skeleton(), std::string("l") + part);
    const std::optional<int> right = FindPart(person.skeleton(), std::string("r") + part);
    if (!left || !right) continue;
    const Eigen::Vector3d to_left = Shown(row, person, frame, *left) - Shown(row, person, frame, *right);
    const Eigen::Vector3d facing = to_left.cross(Eigen::Vector3d::UnitZ());
    if (facing.norm() > 1e-3) return facing.normalized();
  }
  return Eigen::Vector3d::UnitX();
}

View MakeView(const Eigen::Vector3d& facing, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180.0;
  const Eigen::Vector3d towards = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix() * facing;
  return {Eigen::Vector3d::UnitZ().cross(towards), towards};
}

/// The middle of all people, so that a column is not wider than they are.
Eigen::Vector3d Middle(const Row& row, int frame) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const PoseSequence& person : row.scene.people) {
    for (int j = 0; j < person.joint_count(); ++j) {
      if (!person.IsKnown(frame, j)) continue;
      sum += Shown(row, person, frame, j);
      ++count;
    }
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

/// The joint that a head is drawn around: the end of the chain of the trunk.
std::optional<int> HeadOf(const Skeleton& skeleton) {
  for (const char* part : {"headtop", "nose"}) {
    if (const std::optional<int> joint = FindPart(skeleton, part)) return joint;
  }
  return std::nullopt;
}

Figure MakeFigure(const Row& row, const View& view, int frame) {
  const Eigen::Vector3d middle = Middle(row, frame);
  const auto on_paper = [&](const Eigen::Vector3d& shown) {
    return Point{(shown - middle).dot(view.right), shown.z(), (shown - middle).dot(view.towards)};
  };
  Figure figure;
  for (const PoseSequence& person : row.scene.people) {
    const std::string sides = JointSides(person.skeleton());
    for (int j = 0; j < person.joint_count(); ++j) {
      const int parent = person.skeleton().parents[static_cast<std::size_t>(j)];
      if (parent < 0 || !person.IsKnown(frame, j) || !person.IsKnown(frame, parent)) continue;
      figure.limbs.push_back({on_paper(Shown(row, person, frame, parent)), on_paper(Shown(row, person, frame, j)),
                              sides[static_cast<std::size_t>(j)]});
    }
    const std::optional<int> head = HeadOf(person.skeleton());
    if (head && person.IsKnown(frame, *head)) figure.heads.push_back(on_paper(Shown(row, person, frame, *head)));
  }
  std::ranges::sort(figure.limbs, {}, [](const Limb& limb) { return limb.from.nearness + limb.to.nearness; });
  return figure;
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '<' || c == '>' || c == '&') {
      escaped += c == '<' ? "&lt;" : c == '>' ? "&gt;" : "&amp;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

const char* ColourOf(char side) { return side == 'l' ? kLeftColour : side == 'r' ? kRightColour : kMiddleColour; }

std::string Line(const Point& from, const Point& to, const char* colour, double width, const char* cap) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" stroke-width=\"{:.1f}\" "
      "stroke-linecap=\"{}\"/>\n",
      from.x * kPxPerMetre, -from.height * kPxPerMetre, to.x * kPxPerMetre, -to.height * kPxPerMetre, colour,
      width * kPxPerMetre, cap);
}

/// A limb with a white rim, so that one sees which limb is in front; not at its ends, where it meets others.
std::string Draw(const Limb& limb) {
  constexpr double kWithoutRim = 0.2;  // of the limb, at either end
  const auto between = [&](double share) {
    return Point{limb.from.x + share * (limb.to.x - limb.from.x),
                 limb.from.height + share * (limb.to.height - limb.from.height), 0.0};
  };
  return Line(between(kWithoutRim), between(1.0 - kWithoutRim), "#FFFFFF", 1.7 * kLimbWidth, "butt") +
         Line(limb.from, limb.to, ColourOf(limb.side), kLimbWidth, "round");
}

/// A figure with its floor and the text below it; the origin is where its middle meets the floor.
std::string Draw(const Figure& figure, double half_width, const std::string& label) {
  std::string svg =
      fmt::format("<line x1=\"{0:.1f}\" y1=\"0\" x2=\"{1:.1f}\" y2=\"0\" stroke=\"#C5CAD1\" stroke-width=\"1\"/>\n",
                  -half_width * kPxPerMetre, half_width * kPxPerMetre);
  for (const Limb& limb : figure.limbs) svg += Draw(limb);
  for (const Point& head : figure.heads) {
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\" stroke=\"#FFFFFF\" stroke-width=\"1.5\"/>\n",
        head.x * kPxPerMetre, -head.height * kPxPerMetre, kHeadRadius * kPxPerMetre, kMiddleColour);
  }
  return svg +
         fmt::format("<text x=\"0\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", 1.5 * kLabelPx, Escaped(label));
}

std::vector<Row> MakeRows(const std::vector<ShownResult>& results, const StripOptions& options) {
  if (options.frames.empty()) ThrowInvalidArgument("give the frames to draw, such as `frames`=0,20,40");
  std::vector<Row> rows;
  for (const ShownResult& result : results) {
    if (options.scene < 0 || options.scene >= static_cast<int>(result.scenes.size())) {
      ThrowInvalidArgument("{} has {} scenes, counted from 0, and `scene` is {}", result.name, result.scenes.size(),
                           options.scene);
    }
    const Scene& scene = result.scenes[static_cast<std::size_t>(options.scene)].scene;
    const int frames = scene.people.empty() ? 0 : scene.people.front().frame_count();
    for (const int frame : options.frames) {
      if (frame < 0 || frame >= frames) {
        ThrowInvalidArgument("frame {}: {} has frames 0 to {} of {}", frame, result.name, frames - 1, scene.name);
      }
    }
    rows.push_back(
        {scene,
         rows.empty() ? MakeDisplayFrame(scene) : MakeDisplayFrameLike(rows.front().scene, rows.front().display, scene),
         result.name});
  }
  return rows;
}

}  // namespace

std::string SkeletonStrip(const std::vector<ShownResult>& results, const StripOptions& options) {
  const std::vector<Row> rows = MakeRows(results, options);
  const View view = MakeView(Facing(rows.front(), options.frames.front()), options.view_angle_deg);
  std::vector<std::vector<Figure>> figures;
  double half_width = 0.3;
  double height = 1.0;
  for (const Row& row : rows) {
    figures.emplace_back();
    for (const int frame : options.frames) {
      const Figure& figure = figures.back().emplace_back(MakeFigure(row, view, frame));
      for (const Limb& limb : figure.limbs) {
        for (const Point& point : {limb.from, limb.to}) {
          half_width = std::max(half_width, std::abs(point.x));
          height = std::max(height, point.height);
        }
      }
    }
  }
  half_width += kMargin;
  height += kMargin;
  const double column_px = 2.0 * half_width * kPxPerMetre;
  const double row_px = height * kPxPerMetre + 3.0 * kLabelPx;
  std::string body;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double floor_px = static_cast<double>(r) * row_px + height * kPxPerMetre;
    const PoseSequence& person = rows[r].scene.people.front();
    for (std::size_t f = 0; f < options.frames.size(); ++f) {
      const int frame = options.frames[f];
      const bool has_time = person.fps > 0.0 || !person.time_seconds.empty();
      const std::string label =
          has_time ? fmt::format("{:.2f} s", person.TimeOf(frame)) : fmt::format("frame {}", frame);
      body += fmt::format("<g transform=\"translate({:.1f} {:.1f})\">\n{}</g>\n",
                          (static_cast<double>(f) + 0.5) * column_px, floor_px,
                          Draw(figures[r][f], half_width - 0.5 * kMargin, label));
    }
    if (rows.size() > 1) {
      body += fmt::format("<text x=\"6\" y=\"{:.1f}\" font-weight=\"600\">{}</text>\n",
                          static_cast<double>(r) * row_px + kLabelPx, Escaped(rows[r].name));
    }
  }
  const double width_px = column_px * static_cast<double>(options.frames.size());
  const double height_px = row_px * static_cast<double>(rows.size());
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 {0:.0f} "
      "{1:.0f}\">\n"
      "<title>Skeletons; left limbs blue, right limbs vermilion</title>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n"
      "<g fill=\"#333A44\" font-family=\"Helvetica, Arial, sans-serif\" "
      "font-size=\"{2}\">\n{3}</g>\n</svg>\n",
      width_px, height_px, kLabelPx, body);
}

}  // namespace canonpose
