#include "canonpose/skeleton/connect_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>

#include "canonpose/base/error.h"
#include "canonpose/skeleton/joint_names.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

/// Partners are connected with each other only where they are so many times closer than to the rest.
constexpr double kPartnersApart = 3.0;

struct Edge {
  int a;
  int b;
  double length;
};

class Tree {
 public:
  explicit Tree(std::size_t joints) : part_(joints), neighbours_(joints) { std::iota(part_.begin(), part_.end(), 0); }

  /// Adds an edge unless it closes a circle.
  bool Add(int a, int b) {
    const int part = part_[static_cast<std::size_t>(a)];
    const int other = part_[static_cast<std::size_t>(b)];
    if (part == other) return false;
    std::replace(part_.begin(), part_.end(), other, part);
    neighbours_[static_cast<std::size_t>(a)].push_back(b);
    neighbours_[static_cast<std::size_t>(b)].push_back(a);
    return true;
  }

  /// (J) the parents where `root` is the root, and the number of steps from it to all joints together.
  [[nodiscard]] std::pair<std::vector<int>, int> ParentsFrom(int root) const {
    std::vector<int> parents(part_.size(), -1);
    std::vector<int> steps(part_.size(), 0);
    std::queue<int> open({root});
    while (!open.empty()) {
      const int joint = open.front();
      open.pop();
      for (const int next : neighbours_[static_cast<std::size_t>(joint)]) {
        if (next == parents[static_cast<std::size_t>(joint)]) continue;
        parents[static_cast<std::size_t>(next)] = joint;
        steps[static_cast<std::size_t>(next)] = steps[static_cast<std::size_t>(joint)] + 1;
        open.push(next);
      }
    }
    return {parents, std::accumulate(steps.begin(), steps.end(), 0)};
  }

 private:
  std::vector<int> part_;
  std::vector<std::vector<int>> neighbours_;
};

/// All connections, the shortest first.
std::vector<Edge> Connections(const std::vector<int>& mirror, const std::vector<double>& distances) {
  const auto count = static_cast<int>(mirror.size());
  const auto distance = [&](int a, int b) {
    const double value = distances.empty() ? NAN : distances[static_cast<std::size_t>(a * count + b)];
    return std::isfinite(value) ? value : std::numeric_limits<double>::max() / 8.0;
  };
  std::vector<Edge> edges;
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      const int other_a = mirror[static_cast<std::size_t>(a)];
      const int other_b = mirror[static_cast<std::size_t>(b)];
      const double length = 0.5 * (distance(a, b) + distance(other_a, other_b));
      edges.push_back({a, b, other_a == b ? kPartnersApart * length : length});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return x.length < y.length; });
  return edges;
}

/// The joint that is nowhere the second of a pair, if it is one.
std::optional<int> TopOf(const std::vector<std::array<int, 2>>& bones, std::size_t joints) {
  std::vector<bool> is_second(joints, false);
  for (const auto& bone : bones) is_second[static_cast<std::size_t>(bone[1])] = true;
  if (std::count(is_second.begin(), is_second.end(), false) != 1) return std::nullopt;
  return static_cast<int>(std::find(is_second.begin(), is_second.end(), false) - is_second.begin());
}

int MiddleOf(const Tree& tree, const std::vector<int>& mirror) {
  int middle = 0;
  std::pair<bool, int> best{true, std::numeric_limits<int>::max()};
  for (int j = 0; j < static_cast<int>(mirror.size()); ++j) {
    const std::pair<bool, int> here{mirror[static_cast<std::size_t>(j)] != j, tree.ParentsFrom(j).second};
    if (here >= best) continue;
    best = here;
    middle = j;
  }
  return middle;
}

}  // namespace

Skeleton ConnectJoints(const std::string& name, const std::vector<std::string>& joints,
                       const std::vector<std::array<int, 2>>& bones, const std::vector<double>& distances) {
  CANONPOSE_CHECK(!joints.empty(), "no joints");
  CANONPOSE_CHECK(distances.empty() || distances.size() == joints.size() * joints.size(), "{} distances for {} joints",
                  distances.size(), joints.size());
  Skeleton skeleton;
  skeleton.name = name;
  skeleton.joints = joints;
  skeleton.mirror = SidePartners(joints);
  Tree tree(joints.size());
  std::size_t used = 0;
  for (const auto& [a, b] : bones) used += tree.Add(a, b) ? 1 : 0;
  for (const Edge& edge : Connections(skeleton.mirror, distances)) tree.Add(edge.a, edge.b);
  std::optional<int> root = used + 1 == joints.size() ? TopOf(bones, joints.size()) : std::nullopt;
  if (!root) root = FindPart(skeleton, "pelvis");
  skeleton.root = root ? *root : MiddleOf(tree, skeleton.mirror);
  skeleton.parents = tree.ParentsFrom(skeleton.root).first;
  CANONPOSE_CHECK(skeleton.Problem().empty(), "{}: {}", name, skeleton.Problem());
  return skeleton;
}

}  // namespace canonpose
