#include "canonpose/scene/world_measures.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/scene/stature.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose {
namespace {

/// The number after the last '='; the rest is in `name`.
double ParseMetres(const std::string& text, std::string& name) {
  const std::size_t equals = text.rfind('=');
  if (equals != std::string::npos) name = text.substr(0, equals);
  const std::string number = equals == std::string::npos ? text : text.substr(equals + 1);
  double metres = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), metres);
  return error == std::errc() && end == number.data() + number.size() && !number.empty() ? metres : std::nan("");
}

/// Whether a height is this person's.
bool IsOf(const KnownHeight& height, const PoseSequence& person) {
  return height.person.empty() || height.person == person.name;
}

std::string InMetres(double mm) { return fmt::format("{:g} m", std::round(mm) / 1000.0); }

const SceneCamera& FindCamera(const std::vector<const SceneCamera*>& cameras, const std::string& name) {
  const auto found = std::ranges::find_if(cameras, [&](const SceneCamera* camera) { return camera->name == name; });
  if (found != cameras.end()) return **found;
  std::vector<std::string> names;
  for (const SceneCamera* camera : cameras) names.push_back(camera->name);
  ThrowInvalidArgument("`camera_distance`: expected cameras that were solved ({}), found {}", fmt::join(names, ", "),
                       name);
}

Eigen::Vector3d CentreOf(const SceneCamera& camera) {
  const Camera& one = camera.calibration.front();
  return -one.camera_from_world_rotation.transpose() * one.camera_from_world_translation;
}

}  // namespace

KnownHeight KnownHeight::Parse(const std::string& text) {
  KnownHeight height;
  const double metres = ParseMetres(text, height.person);
  if (!std::isfinite(metres) || (text.find('=') != std::string::npos && height.person.empty())) {
    ThrowInvalidArgument("`height`: expected metres, such as 1.75, or NAME=METRES, found \"{}\"", text);
  }
  RequireHeight(metres);
  height.height_mm = 1000.0 * metres;
  return height;
}

KnownDistance KnownDistance::Parse(const std::string& text) {
  KnownDistance distance;
  std::string names;
  const double metres = ParseMetres(text, names);
  const std::size_t comma = names.find(',');
  if (comma != std::string::npos) {
    distance.camera = names.substr(0, comma);
    distance.other = names.substr(comma + 1);
  }
  if (!(metres > 0.0) || std::isinf(metres) || distance.camera.empty() || distance.other.empty() ||
      distance.camera == distance.other) {
    ThrowInvalidArgument("`camera_distance`: expected A,B=METRES of two cameras, such as cam1,cam2=4.2, found \"{}\"",
                         text);
  }
  distance.distance_mm = 1000.0 * metres;
  return distance;
}

std::optional<MeasuredScale> ScaleByHeights(std::span<const Scene> scenes, const std::vector<KnownHeight>& heights) {
  struct Person {
    std::string name;
    double height_mm;
    double scales = 0.0;  ///< weighted by frames
    double frames = 0.0;
    StatureEstimate stature;
  };
  std::vector<Person> people;
  for (const Scene& scene : scenes) {
    for (const PoseSequence& person : scene.people) {
      const auto height = std::ranges::find_if(heights, [&](const KnownHeight& one) { return IsOf(one, person); });
      if (height == heights.end()) continue;
      const std::optional<StatureEstimate> stature = EstimateStature(person);
      if (!stature) continue;
      auto known = std::ranges::find(people, person.name, &Person::name);
      if (known == people.end())
        known = people.insert(people.end(), Person{person.name, height->height_mm, 0.0, 0.0, *stature});
      known->scales += person.frame_count() * height->height_mm / stature->stature;
      known->frames += person.frame_count();
    }
  }
  if (people.empty()) return std::nullopt;
  double weights = 0.0;
  double sum = 0.0;
  std::vector<std::string> names;
  for (const Person& person : people) {
    const double weight = 1.0 / (person.stature.uncertainty_percent * person.stature.uncertainty_percent);
    sum += weight * person.scales / person.frames;
    weights += weight;
    names.push_back(people.size() == 1 ? InMetres(person.height_mm)
                                       : fmt::format("{} ({})", InMetres(person.height_mm), person.name));
  }
  return MeasuredScale{sum / weights,
                       {fmt::format("the height given, {}, and {}", JoinWithAnd(names), people.front().stature.bones),
                        std::sqrt(1.0 / weights)}};
}

MeasuredScale ScaleByDistances(const std::vector<const SceneCamera*>& cameras, const WorldMeasures& measures) {
  std::vector<double> scales;
  double products = 0.0;
  double squares = 0.0;
  for (const KnownDistance& known : measures.distances) {
    const double distance =
        (CentreOf(FindCamera(cameras, known.camera)) - CentreOf(FindCamera(cameras, known.other))).norm();
    if (!(distance > 0.0)) {
      ThrowInvalidArgument("`camera_distance`: {} and {} are at the same place", known.camera, known.other);
    }
    scales.push_back(known.distance_mm / distance);
    products += distance * known.distance_mm;
    squares += distance * distance;
  }
  MeasuredScale scale{products / squares, {}};
  // Solved distances are off by about as much as focal lengths; several show how much.
  double variance = 0.0;
  for (const double one : scales) variance += std::pow(one / scale.mm_per_unit - 1.0, 2);
  const auto count = static_cast<double>(scales.size());
  constexpr double kUsualPercent = 2.0;
  const double percent = count > 1 ? 100.0 * std::sqrt(variance / (count - 1) / count) : kUsualPercent;
  const KnownDistance& first = measures.distances.front();
  scale.known = {!measures.distances_source.empty() ? measures.distances_source
                 : count > 1                        ? fmt::format("{} distances given between cameras", scales.size())
                             : fmt::format("the distance given between {} and {}, {}", first.camera, first.other,
                                           InMetres(first.distance_mm)),
                 std::max(percent, 0.1)};
  return scale;
}

}  // namespace canonpose
