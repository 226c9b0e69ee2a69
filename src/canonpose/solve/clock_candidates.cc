#include "canonpose/solve/clock_candidates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "canonpose/solve/motion_signature.h"

namespace canonpose {
namespace {

/// Of each pair of views.
constexpr int kPeaks = 8;
/// Answers that are kept while views are added one by one.
constexpr std::size_t kBeam = 48;
/// Lags that differ by less are one.
constexpr double kSameLagSeconds = 0.15;
/// Frame rates that cameras have; 29.97 is near enough to 30 here.
constexpr double kUsualRates[] = {24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 100.0, 120.0};
constexpr double kLargestRatio = 5.0;

/// The ratios of usual frame rates, 1 first.
std::vector<double> UsualRatios() {
  std::set<long> seen;  // in millionths
  std::vector<double> ratios;
  const auto add = [&](double ratio) {
    if (ratio <= kLargestRatio && ratio >= 1.0 / kLargestRatio && seen.insert(std::lround(1e6 * ratio)).second) {
      ratios.push_back(ratio);
    }
  };
  add(1.0);
  for (const double a : kUsualRates) {
    for (const double b : kUsualRates) add(a / b);
  }
  return ratios;
}

/// Views placed in time so far.
struct Placement {
  std::vector<double> lags;  ///< (V) of the view's samples behind the root's
  std::vector<bool> placed;  ///< (V)
  double score = 0.0;
};

class Search {
 public:
  Search(const CaptureObservations& capture, int clip, const ClockSearch& search);
  [[nodiscard]] std::vector<ClockCandidate> Run();

 private:
  /// Of the view with the lower number against the other.
  [[nodiscard]] const SimilarityCurve& CurveOf(int v, int w);
  /// How alike the views are where w's samples lag behind v's.
  [[nodiscard]] double Likeness(int v, int w, double lag) { return CurveOf(v, w).At(v < w ? lag : -lag); }
  /// The highest value of that; 0 where the views have nothing in common.
  [[nodiscard]] double Height(int v, int w);
  void ChooseRoot();
  void ChooseRates();
  [[nodiscard]] int NextView(const std::vector<bool>& placed);
  /// Lags at which a view may be, given those that are placed.
  [[nodiscard]] std::vector<double> LagsOf(int view, const Placement& placement);
  [[nodiscard]] double ScoreOf(int view, double lag, const Placement& placement);
  void KeepBest(std::size_t count, std::vector<Placement>& placements) const;
  [[nodiscard]] ClockCandidate Answer(const Placement& placement);
  [[nodiscard]] Placement AsRecorded();
  [[nodiscard]] double KnownLag(int view) const;
  [[nodiscard]] bool IsKnown(int view) const {
    return static_cast<std::size_t>(view) < search_.known_offsets.size() &&
           std::isfinite(search_.known_offsets[static_cast<std::size_t>(view)]);
  }

  ClockSearch search_;
  int view_count_;
  std::vector<MotionSignature> recorded_;  ///< (V)
  std::vector<MotionSignature> in_step_;   ///< (V) at the root's rate
  std::vector<double> rates_;              ///< (V) of a view's time against the root's
  std::vector<int> views_;                 ///< that show anything
  std::map<std::pair<int, int>, SimilarityCurve> curves_;
  int root_ = -1;
  double same_ = 1.0;  ///< samples
};

Search::Search(const CaptureObservations& capture, int clip, const ClockSearch& search)
    : search_(search), view_count_(capture.view_count()), rates_(capture.cameras.size(), 1.0) {
  for (int v = 0; v < view_count_; ++v) {
    recorded_.push_back(SignatureOf(capture, clip, v));
    if (recorded_.back().knows_anything()) views_.push_back(v);
  }
  in_step_ = recorded_;
  if (!recorded_.empty()) same_ = std::max(1.0, kSameLagSeconds * recorded_.front().samples_per_second);
}

const SimilarityCurve& Search::CurveOf(int v, int w) {
  const std::pair key(std::min(v, w), std::max(v, w));
  const auto found = curves_.find(key);
  if (found != curves_.end()) return found->second;
  SimilarityCurve curve(in_step_[static_cast<std::size_t>(key.first)], in_step_[static_cast<std::size_t>(key.second)],
                        search_.min_overlap_seconds);
  return curves_.emplace(key, std::move(curve)).first->second;
}

double HeightOf(const SimilarityCurve& curve) {
  const auto peaks = curve.Peaks(1, 1.0);
  return peaks.empty() ? 0.0 : peaks.front().value;
}

double Search::Height(int v, int w) { return HeightOf(CurveOf(v, w)); }

void Search::ChooseRoot() {
  double best = -1.0;
  for (const int v : views_) {
    double sum = 0.0;
    for (const int w : views_) {
      if (w != v) sum += Height(v, w);
    }
    // A view whose time is known is as good as any other, and what is known of the rest counts from it.
    if (IsKnown(v) && search_.known_offsets[static_cast<std::size_t>(v)] == 0.0) sum += 1e3;
    if (sum <= best) continue;
    best = sum;
    root_ = v;
  }
}

void Search::ChooseRates() {
  if (search_.rates_are_equal) return;
  const MotionSignature& root = recorded_[static_cast<std::size_t>(root_)];
  for (const int v : views_) {
    if (v == root_) continue;
    const auto i = static_cast<std::size_t>(v);
    double best = 0.0;
    for (const double ratio : UsualRatios()) {
      MotionSignature stretched = Stretch(recorded_[i], ratio);
      const double height = HeightOf(SimilarityCurve(root, stretched, search_.min_overlap_seconds));
      if (height <= best) continue;
      best = height;
      rates_[i] = ratio;
      in_step_[i] = std::move(stretched);
    }
  }
  curves_.clear();
}

double Search::KnownLag(int view) const {
  const auto i = static_cast<std::size_t>(view);
  const double per_sample = recorded_[i].frames_per_sample;
  const double centre = 0.5 * (per_sample - 1.0);
  const double root = IsKnown(root_) ? search_.known_offsets[static_cast<std::size_t>(root_)] : 0.0;
  return (search_.known_offsets[i] - root - centre * (1.0 - rates_[i])) / per_sample;
}

int Search::NextView(const std::vector<bool>& placed) {
  double best = -1.0;
  int next = -1;
  for (const int v : views_) {
    if (placed[static_cast<std::size_t>(v)]) continue;
    double height = IsKnown(v) ? 1e3 : 0.0;
    for (const int u : views_) {
      if (placed[static_cast<std::size_t>(u)]) height = std::max(height, Height(u, v));
    }
    if (height <= best) continue;
    best = height;
    next = v;
  }
  return next;
}

std::vector<double> Search::LagsOf(int view, const Placement& placement) {
  if (IsKnown(view)) return {KnownLag(view)};
  std::vector<double> lags;
  for (const int u : views_) {
    if (!placement.placed[static_cast<std::size_t>(u)]) continue;
    for (const SimilarityCurve::Peak& peak : CurveOf(u, view).Peaks(kPeaks, same_)) {
      lags.push_back(placement.lags[static_cast<std::size_t>(u)] + (u < view ? peak.lag : -peak.lag));
    }
  }
  return lags;
}

double Search::ScoreOf(int view, double lag, const Placement& placement) {
  double score = 0.0;
  for (const int u : views_) {
    const auto i = static_cast<std::size_t>(u);
    if (placement.placed[i] && u != view) score += Likeness(u, view, lag - placement.lags[i]);
  }
  return score;
}

void Search::KeepBest(std::size_t count, std::vector<Placement>& placements) const {
  std::ranges::stable_sort(placements, std::ranges::greater(), &Placement::score);
  std::vector<Placement> kept;
  for (Placement& placement : placements) {
    if (kept.size() == count) break;
    const bool is_new = std::ranges::all_of(kept, [&](const Placement& other) {
      for (std::size_t v = 0; v < other.lags.size(); ++v) {
        if (std::abs(other.lags[v] - placement.lags[v]) >= same_) return true;
      }
      return false;
    });
    if (is_new) kept.push_back(std::move(placement));
  }
  placements = std::move(kept);
}

ClockCandidate Search::Answer(const Placement& placement) {
  ClockCandidate answer;
  answer.root = root_;
  answer.score = placement.score;
  answer.evidence.assign(static_cast<std::size_t>(view_count_), 0.0);
  answer.times.assign(static_cast<std::size_t>(view_count_), TimeMap());
  for (const int v : views_) {
    const auto i = static_cast<std::size_t>(v);
    const double per_sample = recorded_[i].frames_per_sample;
    const double centre = 0.5 * (per_sample - 1.0);
    answer.times[i].rate = rates_[i];
    answer.times[i].offset = placement.lags[i] * per_sample + centre * (1.0 - rates_[i]);
    double sum = 0.0;
    int pairs = 0;
    for (const int u : views_) {
      if (u == v) continue;
      const double value = Likeness(u, v, placement.lags[i] - placement.lags[static_cast<std::size_t>(u)]);
      sum += value;
      pairs += value != 0.0 ? 1 : 0;
    }
    if (pairs > 0) answer.evidence[i] = sum / std::sqrt(pairs);
  }
  return answer;
}

Placement Search::AsRecorded() {
  Placement placement;
  placement.lags.assign(static_cast<std::size_t>(view_count_), 0.0);
  placement.placed.assign(static_cast<std::size_t>(view_count_), false);
  for (const int v : views_) {
    if (IsKnown(v)) placement.lags[static_cast<std::size_t>(v)] = KnownLag(v);
    placement.score += ScoreOf(v, placement.lags[static_cast<std::size_t>(v)], placement);
    placement.placed[static_cast<std::size_t>(v)] = true;
  }
  return placement;
}

std::vector<ClockCandidate> Search::Run() {
  if (views_.size() < 2) return {};
  ChooseRoot();
  ChooseRates();
  Placement root;
  root.lags.assign(static_cast<std::size_t>(view_count_), 0.0);
  root.placed.assign(static_cast<std::size_t>(view_count_), false);
  root.placed[static_cast<std::size_t>(root_)] = true;
  std::vector<Placement> placements = {root};
  for (std::size_t count = 1; count < views_.size(); ++count) {
    const int next = NextView(placements.front().placed);
    std::vector<Placement> longer;
    for (const Placement& placement : placements) {
      std::vector<double> lags = LagsOf(next, placement);
      if (lags.empty()) lags.push_back(0.0);
      for (const double lag : lags) {
        Placement more = placement;
        more.lags[static_cast<std::size_t>(next)] = lag;
        more.placed[static_cast<std::size_t>(next)] = true;
        more.score += ScoreOf(next, lag, placement);
        longer.push_back(std::move(more));
      }
    }
    placements = std::move(longer);
    KeepBest(kBeam, placements);
  }
  KeepBest(static_cast<std::size_t>(search_.candidates), placements);
  std::vector<ClockCandidate> answers;
  for (const Placement& placement : placements) answers.push_back(Answer(placement));
  if (search_.as_recorded) answers.push_back(Answer(AsRecorded()));
  return answers;
}

}  // namespace

std::vector<ClockCandidate> FindClockCandidates(const CaptureObservations& capture, int clip,
                                                const ClockSearch& search) {
  return Search(capture, clip, search).Run();
}

}  // namespace canonpose
