#include "canonpose/data/detection_cleaning.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "canonpose/base/log.h"

namespace canonpose {
namespace {

/// Keypoints of one person found twice are this close in the mean, as a fraction of the person's size.
constexpr double kSameDetection = 0.1;
/// Fewer common keypoints may lie on each other by chance.
constexpr std::size_t kFewestCommon = 3;
/// A detection that shares less than this fraction of its keypoints with another one is of somebody else.
constexpr double kCommonKeypoints = 0.5;
/// How far to look for frames that show how many people there are.
constexpr std::ptrdiff_t kNeighbours = 30;

double MeanConfidence(const DetectedPerson& person) {
  double sum = 0.0;
  for (const float confidence : person.confidence) sum += confidence;
  return sum / static_cast<double>(person.confidence.size());
}

/// The diagonal of the box around a person's keypoints, px.
double SizePx(const DetectedPerson& person) {
  float low_x = std::numeric_limits<float>::infinity();
  float low_y = low_x;
  float high_x = -low_x;
  float high_y = -low_x;
  for (std::size_t k = 0; k < person.confidence.size(); ++k) {
    if (person.confidence[k] <= 0.0F) continue;
    low_x = std::min(low_x, person.keypoints[2 * k]);
    high_x = std::max(high_x, person.keypoints[2 * k]);
    low_y = std::min(low_y, person.keypoints[2 * k + 1]);
    high_y = std::max(high_y, person.keypoints[2 * k + 1]);
  }
  return std::max(1.0, static_cast<double>(std::hypot(high_x - low_x, high_y - low_y)));
}

bool LieOnEachOther(const DetectedPerson& a, const DetectedPerson& b) {
  double distance_px = 0.0;
  std::size_t common = 0;
  std::size_t seen_a = 0;
  std::size_t seen_b = 0;
  for (std::size_t k = 0; k < a.confidence.size(); ++k) {
    const bool in_a = a.confidence[k] > 0.0F;
    const bool in_b = b.confidence[k] > 0.0F;
    seen_a += in_a ? 1 : 0;
    seen_b += in_b ? 1 : 0;
    if (!in_a || !in_b) continue;
    ++common;
    distance_px += std::hypot(a.keypoints[2 * k] - b.keypoints[2 * k], a.keypoints[2 * k + 1] - b.keypoints[2 * k + 1]);
  }
  const std::size_t fewer = std::min(seen_a, seen_b);
  if (common < std::min(kFewestCommon, fewer) || common == 0) return false;
  if (static_cast<double>(common) < kCommonKeypoints * static_cast<double>(fewer)) return false;
  return distance_px / static_cast<double>(common) < kSameDetection * std::max(SizePx(a), SizePx(b));
}

/// The people of a frame that lie on a more confident one.
std::vector<bool> Doubles(const std::vector<DetectedPerson>& people) {
  std::vector<std::size_t> order(people.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return MeanConfidence(people[a]) > MeanConfidence(people[b]); });
  std::vector<bool> is_double(people.size(), false);
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t k = 0; k < i && !is_double[order[i]]; ++k) {
      is_double[order[i]] = !is_double[order[k]] && LieOnEachOther(people[order[k]], people[order[i]]);
    }
  }
  return is_double;
}

/// How many people are usually seen around a frame where nobody is found twice; nothing where no such frame is near.
std::optional<std::size_t> UsualCount(const DetectedCamera& camera, const std::vector<std::size_t>& doubles,
                                      std::ptrdiff_t frame) {
  std::vector<std::size_t> before;
  std::vector<std::size_t> after;
  const auto last = std::ssize(camera.frames) - 1;
  for (std::ptrdiff_t t = std::max<std::ptrdiff_t>(0, frame - kNeighbours); t <= std::min(last, frame + kNeighbours);
       ++t) {
    const auto i = static_cast<std::size_t>(t);
    if (doubles[i] == 0 && !camera.frames[i].people.empty())
      (t < frame ? before : after).push_back(camera.frames[i].people.size());
  }
  const auto median = [](std::vector<std::size_t>& counts) {
    const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
    std::nth_element(counts.begin(), middle, counts.end());
    return *middle;
  };
  if (before.empty() && after.empty()) return std::nullopt;
  if (before.empty()) return median(after);
  if (after.empty()) return median(before);
  // Who passes was there before and is there afterwards.
  return std::min(median(before), median(after));
}

}  // namespace

void DropUselessTrackIds(DetectedCamera& camera) {
  std::set<std::int64_t> ids;
  bool is_twice_in_frame = false;
  bool is_order_from_0 = true;
  bool is_order_from_1 = true;
  std::size_t most_people = 0;
  for (const DetectedFrame& frame : camera.frames) {
    std::set<std::int64_t> in_frame;
    most_people = std::max(most_people, frame.people.size());
    for (std::size_t p = 0; p < frame.people.size(); ++p) {
      const std::optional<std::int64_t> id = frame.people[p].track_id;
      if (!id) continue;
      ids.insert(*id);
      is_twice_in_frame = is_twice_in_frame || !in_frame.insert(*id).second;
      is_order_from_0 = is_order_from_0 && *id == static_cast<std::int64_t>(p);
      is_order_from_1 = is_order_from_1 && *id == static_cast<std::int64_t>(p) + 1;
    }
  }
  const bool is_same_for_all = ids.size() == 1;
  if (camera.has_tracks && !is_twice_in_frame) return;
  if (ids.empty() || (!is_twice_in_frame && !is_same_for_all && !is_order_from_0 && !is_order_from_1)) return;
  for (DetectedFrame& frame : camera.frames) {
    for (DetectedPerson& person : frame.people) person.track_id.reset();
  }
  if (is_twice_in_frame) {
    LogInfo("{}: several people of one frame have the same track id, so track ids are ignored", camera.name);
  } else if (most_people > 1) {
    LogInfo("{}: track ids only number the people of each frame, so they are ignored", camera.name);
  }
}

void MergeDuplicates(DetectedCamera& camera) {
  std::vector<std::vector<bool>> is_double;
  std::vector<std::size_t> doubles;
  for (const DetectedFrame& frame : camera.frames) {
    is_double.push_back(Doubles(frame.people));
    doubles.push_back(static_cast<std::size_t>(std::count(is_double.back().begin(), is_double.back().end(), true)));
  }
  std::size_t frames_with_doubles = 0;
  std::vector<std::vector<bool>> to_remove = is_double;
  for (std::size_t t = 0; t < camera.frames.size(); ++t) {
    if (doubles[t] == 0) continue;
    const std::size_t count = camera.frames[t].people.size();
    const std::optional<std::size_t> usual = UsualCount(camera, doubles, static_cast<std::ptrdiff_t>(t));
    if (usual && count <= *usual) {
      std::fill(to_remove[t].begin(), to_remove[t].end(), false);
      continue;
    }
    ++frames_with_doubles;
  }
  for (std::size_t t = 0; t < camera.frames.size(); ++t) {
    std::vector<DetectedPerson> kept;
    for (std::size_t p = 0; p < camera.frames[t].people.size(); ++p) {
      if (!to_remove[t][p]) kept.push_back(std::move(camera.frames[t].people[p]));
    }
    camera.frames[t].people = std::move(kept);
  }
  if (frames_with_doubles > 0) {
    LogInfo("{}: in {} frames one person was found twice; the more confident detection is kept", camera.name,
            frames_with_doubles);
  }
}

}  // namespace canonpose
