#include "canonpose/solve/start_agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "canonpose/geometry/alignment.h"
#include "canonpose/solve/rotation_averaging.h"

namespace canonpose {
namespace {

/// Frames are sampled that often, but at least so many altogether.
constexpr double kSlotsPerSecond = 5.0;
constexpr int kMinSlots = 120;
/// A pair needs so many of them; and where one of its tracklets has fewer, most of those.
constexpr int kMinCommonSlots = 6;
/// Poses that differ by this squared distance do not agree. Poses of one person in two views differ by 0.03 to 0.3, as
/// good as the start is, those of two people under a wrong rotation by up to 2.
constexpr double kMisfitLimit = 0.4;
/// Rotations that differ by less are one.
constexpr double kSameRotationRad = 0.26;
constexpr std::size_t kTriedPairs = 40;
constexpr std::size_t kKeptRotations = 5;
constexpr std::size_t kBeam = 12;
/// Another tracklet must fit worse by this factor and this much.
constexpr double kClearlyWorse = 1.5;
constexpr double kWorseBy = 0.03;

double WeightOf(double misfit) { return std::max(0.0, 1.0 - misfit / kMisfitLimit); }

bool IsSame(const RotationProposal& a, const RotationProposal& b) {
  for (std::size_t v = 0; v < a.camera_from_world.size(); ++v) {
    const bool has = a.camera_from_world[v].allFinite();
    if (has != b.camera_from_world[v].allFinite()) return false;
    if (has && RotationAngle(a.camera_from_world[v], b.camera_from_world[v]) > kSameRotationRad) return false;
  }
  return true;
}

/// Makes the first camera that has a rotation the world.
void Rebase(RotationProposal& proposal) {
  const auto first = std::ranges::find_if(proposal.camera_from_world, [](const auto& r) { return r.allFinite(); });
  if (first == proposal.camera_from_world.end()) return;
  const Eigen::Matrix3d world = first->transpose();
  for (Eigen::Matrix3d& rotation : proposal.camera_from_world) rotation = (rotation * world).eval();
}

}  // namespace

StartAgreement::StartAgreement(const PeopleObservations& people)
    : people_(people),
      view_count_(people.lanes.view_count),
      pairs_(static_cast<std::size_t>(view_count_) * static_cast<std::size_t>(view_count_)) {
  const Lanes& lanes = people.lanes;
  const double step =
      std::max(1.0, std::min(lanes.fps / kSlotsPerSecond, static_cast<double>(lanes.frame_count) / kMinSlots));
  const int slots = static_cast<int>(std::ceil(lanes.frame_count / step));
  for (int slot = 0; slot < slots; ++slot) frames_.push_back(static_cast<int>(slot * step));
  for (std::size_t i = 0; i < lanes.tracklets.size(); ++i) {
    for (std::size_t k = 0; k < lanes.tracklets.size(); ++k) {
      if (lanes.tracklets[i].view < lanes.tracklets[k].view) AddPair(static_cast<int>(i), static_cast<int>(k));
    }
  }
}

void StartAgreement::AddPair(int tracklet, int other) {
  const Tracklet& from = people_.lanes.tracklets[static_cast<std::size_t>(tracklet)];
  const Tracklet& to = people_.lanes.tracklets[static_cast<std::size_t>(other)];
  const int first = std::max(from.first, to.first);
  const int last = std::min(from.last, to.last);
  TrackletPair pair;
  pair.from = tracklet;
  pair.to = other;
  const auto begin = std::ranges::lower_bound(frames_, first);
  for (auto frame = begin; frame != frames_.end() && *frame <= last; ++frame) {
    const int n = people_.FrameOf(from, *frame);
    const int m = people_.FrameOf(to, *frame);
    if (!people_.capture.HasStart(n, from.view) || !people_.capture.HasStart(m, to.view)) continue;
    pair.moment += people_.capture.StartOf(m, to.view).transpose() * people_.capture.StartOf(n, from.view);
    pair.slots.push_back(static_cast<int>(frame - frames_.begin()));
  }
  if (static_cast<int>(pair.slots.size()) < kMinCommonSlots) return;
  std::vector<TrackletPair>& pairs = pairs_[static_cast<std::size_t>(from.view * view_count_ + to.view)];
  index_of_[{tracklet, other}] = pairs.size();
  pairs.push_back(std::move(pair));
}

double StartAgreement::Support(int from, int to, const Eigen::Matrix3d& rotation, Eigen::Matrix3d* improved) const {
  const std::vector<TrackletPair>& pairs = PairsOf(from, to);
  std::vector<double> weights;
  for (const TrackletPair& pair : pairs) weights.push_back(WeightOf(pair.Misfit(rotation)));
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
  const std::size_t slots = frames_.size();
  std::vector<char> is_taken(people_.lanes.tracklets.size() * slots, 0);
  const auto taken = [&](int tracklet, int slot) -> char& {
    return is_taken[static_cast<std::size_t>(tracklet) * slots + static_cast<std::size_t>(slot)];
  };
  double support = 0.0;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const std::size_t i : order) {
    if (weights[i] <= 0.0) break;
    const TrackletPair& pair = pairs[i];
    int free = 0;
    for (const int slot : pair.slots) {
      if (taken(pair.from, slot) != 0 || taken(pair.to, slot) != 0) continue;
      taken(pair.from, slot) = taken(pair.to, slot) = 1;
      ++free;
    }
    support += weights[i] * free;
    sum += weights[i] * free / static_cast<double>(pair.slots.size()) * pair.moment;
  }
  if (improved != nullptr) *improved = support > 0.0 ? NearestRotation(sum) : rotation;
  return support;
}

std::vector<StartAgreement::RelativeRotation> StartAgreement::ProposePair(int from, int to) const {
  const std::vector<TrackletPair>& pairs = PairsOf(from, to);
  std::vector<std::pair<double, Eigen::Matrix3d>> candidates;
  for (const TrackletPair& pair : pairs) {
    const Eigen::Matrix3d rotation = NearestRotation(pair.moment);
    candidates.emplace_back(WeightOf(pair.Misfit(rotation)) * static_cast<double>(pair.slots.size()), rotation);
  }
  std::ranges::stable_sort(candidates, [](const auto& a, const auto& b) { return a.first > b.first; });
  if (candidates.size() > kTriedPairs) candidates.resize(kTriedPairs);
  std::vector<RelativeRotation> found;
  for (const auto& [weight, rotation] : candidates) {
    if (weight <= 0.0) continue;
    RelativeRotation relative{from, to, rotation, 0.0};
    for (int round = 0; round < 2; ++round) (void)Support(from, to, relative.rotation, &relative.rotation);
    relative.support = Support(from, to, relative.rotation);
    found.push_back(relative);
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.support > b.support; });
  std::vector<RelativeRotation> kept;
  for (const RelativeRotation& relative : found) {
    const bool is_new = std::ranges::all_of(kept, [&](const RelativeRotation& other) {
      return RotationAngle(relative.rotation, other.rotation) > kSameRotationRad;
    });
    if (is_new && kept.size() < kKeptRotations) kept.push_back(relative);
  }
  return kept;
}

/// Of one view with all others that have a rotation.
double StartAgreement::SupportOf(const RotationProposal& proposal, int view) const {
  double support = 0.0;
  const Eigen::Matrix3d& own = proposal.camera_from_world[static_cast<std::size_t>(view)];
  for (int v = 0; v < view_count_; ++v) {
    const Eigen::Matrix3d& other = proposal.camera_from_world[static_cast<std::size_t>(v)];
    if (v == view || !other.allFinite()) continue;
    support += v < view ? Support(v, view, own * other.transpose()) : Support(view, v, other * own.transpose());
  }
  return support;
}

std::vector<RotationProposal> StartAgreement::Propose(int count) const {
  std::vector<RelativeRotation> relatives;
  for (int from = 0; from < view_count_; ++from) {
    for (int to = from + 1; to < view_count_; ++to) {
      const std::vector<RelativeRotation> found = ProposePair(from, to);
      relatives.insert(relatives.end(), found.begin(), found.end());
    }
  }
  if (relatives.empty()) return {};
  std::ranges::stable_sort(relatives, [](const auto& a, const auto& b) { return a.support > b.support; });
  RotationProposal none;
  none.camera_from_world.assign(static_cast<std::size_t>(view_count_), Eigen::Matrix3d::Constant(std::nan("")));
  none.camera_from_world[static_cast<std::size_t>(relatives.front().from)].setIdentity();
  std::vector<RotationProposal> beam{none};
  std::vector<RotationProposal> complete;
  for (int placed = 1; placed < view_count_; ++placed) {
    std::vector<RotationProposal> longer;
    for (const RotationProposal& proposal : beam) {
      for (const RelativeRotation& relative : relatives) {
        const Eigen::Matrix3d& from = proposal.camera_from_world[static_cast<std::size_t>(relative.from)];
        const Eigen::Matrix3d& to = proposal.camera_from_world[static_cast<std::size_t>(relative.to)];
        if (from.allFinite() == to.allFinite()) continue;
        const int view = from.allFinite() ? relative.to : relative.from;
        RotationProposal next = proposal;
        next.camera_from_world[static_cast<std::size_t>(view)] =
            from.allFinite() ? (relative.rotation * from).eval() : (relative.rotation.transpose() * to).eval();
        next.support += SupportOf(next, view);
        const bool is_new = std::ranges::none_of(longer, [&](const RotationProposal& other) {
          return IsSame(other, next) && other.support >= next.support;
        });
        if (is_new) longer.push_back(std::move(next));
      }
    }
    if (longer.empty()) break;
    std::ranges::stable_sort(longer, [](const auto& a, const auto& b) { return a.support > b.support; });
    beam.clear();
    for (RotationProposal& proposal : longer) {
      const bool is_new =
          std::ranges::none_of(beam, [&](const RotationProposal& other) { return IsSame(other, proposal); });
      if (is_new && beam.size() < kBeam) beam.push_back(std::move(proposal));
    }
  }
  for (RotationProposal& proposal : beam) {
    Rebase(proposal);
    if (static_cast<int>(complete.size()) < count) complete.push_back(std::move(proposal));
  }
  return complete;
}

double StartAgreement::Misfit(int tracklet, int other, const RotationProposal& proposal) const {
  const std::vector<Tracklet>& tracklets = people_.lanes.tracklets;
  if (tracklets[static_cast<std::size_t>(tracklet)].view > tracklets[static_cast<std::size_t>(other)].view) {
    std::swap(tracklet, other);
  }
  const auto index = index_of_.find({tracklet, other});
  if (index == index_of_.end()) return std::numeric_limits<double>::infinity();
  const int from = tracklets[static_cast<std::size_t>(tracklet)].view;
  const int to = tracklets[static_cast<std::size_t>(other)].view;
  const Eigen::Matrix3d relative = proposal.camera_from_world[static_cast<std::size_t>(to)] *
                                   proposal.camera_from_world[static_cast<std::size_t>(from)].transpose();
  if (!relative.allFinite()) return std::numeric_limits<double>::infinity();
  return PairsOf(from, to)[index->second].Misfit(relative);
}

namespace {

bool ShareFrames(const Tracklet& a, const Tracklet& b) { return a.first <= b.last && b.first <= a.last; }

/// Tracklets that are joined one pair after the other, as long as no view shows one person twice at a time.
class TrackletGroups {
 public:
  explicit TrackletGroups(const std::vector<Tracklet>& tracklets) : tracklets_(tracklets), group_(tracklets.size()) {
    std::iota(group_.begin(), group_.end(), 0);
    for (std::size_t i = 0; i < tracklets.size(); ++i) members_.push_back({i});
  }

  void Join(int tracklet, int other) {
    const std::size_t a = group_[static_cast<std::size_t>(tracklet)];
    const std::size_t b = group_[static_cast<std::size_t>(other)];
    if (a == b || Conflict(a, b)) return;
    for (const std::size_t member : members_[b]) group_[member] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
  }
  /// Some are empty.
  [[nodiscard]] const std::vector<std::vector<std::size_t>>& members() const { return members_; }

 private:
  [[nodiscard]] bool Conflict(std::size_t group, std::size_t other) const {
    return std::ranges::any_of(members_[group], [&](std::size_t i) {
      return std::ranges::any_of(members_[other], [&](std::size_t k) {
        return tracklets_[i].view == tracklets_[k].view && ShareFrames(tracklets_[i], tracklets_[k]);
      });
    });
  }

  const std::vector<Tracklet>& tracklets_;
  std::vector<std::size_t> group_;  ///< by tracklet
  std::vector<std::vector<std::size_t>> members_;
};

/// The misfit of `tracklet` with the best of the other tracklets of the view of `partner` that are there at the same
/// time.
double BestAlternative(const std::vector<Tracklet>& tracklets, const StartAgreement& agreement,
                       const RotationProposal& proposal, int tracklet, int partner) {
  double best = std::numeric_limits<double>::infinity();
  const Tracklet& with = tracklets[static_cast<std::size_t>(partner)];
  for (std::size_t k = 0; k < tracklets.size(); ++k) {
    const auto other = static_cast<int>(k);
    if (other == partner || tracklets[k].view != with.view || !ShareFrames(tracklets[k], with)) continue;
    best = std::min(best, agreement.Misfit(tracklet, other, proposal));
  }
  return best;
}

}  // namespace

std::vector<Person> ConfidentPeople(const PeopleObservations& people, const StartAgreement& agreement,
                                    const RotationProposal& proposal) {
  const std::vector<Tracklet>& tracklets = people.lanes.tracklets;
  struct Fit {
    double misfit;
    int from;
    int to;
  };
  std::vector<Fit> fits;
  for (int from = 0; from < people.lanes.view_count; ++from) {
    for (int to = from + 1; to < people.lanes.view_count; ++to) {
      for (const TrackletPair& pair : agreement.PairsOf(from, to)) {
        const double misfit = agreement.Misfit(pair.from, pair.to, proposal);
        if (!(misfit < kMisfitLimit)) continue;
        const double limit = std::max(kClearlyWorse * misfit, misfit + kWorseBy);
        if (BestAlternative(tracklets, agreement, proposal, pair.from, pair.to) < limit) continue;
        if (BestAlternative(tracklets, agreement, proposal, pair.to, pair.from) < limit) continue;
        fits.push_back({misfit, pair.from, pair.to});
      }
    }
  }
  std::ranges::stable_sort(fits, {}, &Fit::misfit);
  TrackletGroups groups(tracklets);
  for (const Fit& fit : fits) groups.Join(fit.from, fit.to);
  std::vector<Person> persons;
  for (const std::vector<std::size_t>& members : groups.members()) {
    Person person(people.lanes);
    for (const std::size_t i : members) {
      for (const int frame : agreement.frames()) {
        if (people.lanes.Owner(tracklets[i].lane, tracklets[i].view, frame) != static_cast<int>(i)) continue;
        person.At(frame, tracklets[i].view) = tracklets[i].lane;
      }
    }
    if (!person.FramesWith(2).empty()) persons.push_back(std::move(person));
  }
  return persons;
}

}  // namespace canonpose
