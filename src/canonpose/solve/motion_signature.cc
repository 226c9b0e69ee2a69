#include "canonpose/solve/motion_signature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/FFT>

#include "canonpose/base/median.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

/// Finer sampling would cost time and show no more: people hardly move faster than 6 Hz.
constexpr double kSamplesPerSecond = 20.0;
/// What changes faster than the first is noise; what changes more slowly than the second is the lifter's bias, or
/// perspective.
constexpr double kNoiseSeconds = 0.12;
constexpr double kDriftSeconds = 2.0;
/// Values are cut off at this many times their root mean square: a lifter that flips for a frame would outweigh all
/// other motion.
constexpr double kLargest = 4.0;
/// Distances are taken between up to this many joints.
constexpr int kMostJoints = 20;
/// Correlations are cut off here, where Fisher's transform still is finite.
constexpr double kLargestCorrelation = 0.995;

constexpr float kNotKnown = std::numeric_limits<float>::quiet_NaN();

using Spectrum = std::vector<std::complex<float>>;

/// Pairs of joints that are not ends of one bone, whose length never changes.
std::vector<std::array<int, 2>> PairsOf(const Skeleton& skeleton) {
  const std::vector<int> joints = EvenlySpread(ConsecutiveFrames(0, skeleton.joint_count()), kMostJoints);
  std::vector<std::array<int, 2>> pairs;
  for (const int a : joints) {
    for (const int b : joints) {
      const bool is_bone =
          skeleton.parents[static_cast<std::size_t>(a)] == b || skeleton.parents[static_cast<std::size_t>(b)] == a;
      if (a < b && !is_bone) pairs.push_back({a, b});
    }
  }
  return pairs;
}

/// Distances between joints of the start's poses, frame by frame.
Eigen::MatrixXf DistancesOf(const CaptureObservations& capture, const ClipRange& clip, int view) {
  const std::vector<std::array<int, 2>> pairs = PairsOf(capture.skeleton);
  Eigen::MatrixXf distances = Eigen::MatrixXf::Constant(clip.count, static_cast<Eigen::Index>(pairs.size()), kNotKnown);
  for (int t = 0; t < clip.count; ++t) {
    if (!capture.HasStart(clip.first + t, view)) continue;
    const Points3d pose = capture.StartOf(clip.first + t, view);
    for (std::size_t p = 0; p < pairs.size(); ++p) {
      const auto [a, b] = pairs[p];
      distances(t, static_cast<Eigen::Index>(p)) = static_cast<float>((pose.row(a) - pose.row(b)).norm());
    }
  }
  return distances;
}

/// The median over the clip of the keypoints' root mean square distance from their mean; 0 where nothing is seen.
/// Keypoints relative to that mean, or to the root, frame by frame.
Eigen::MatrixXf KeypointsOf(const CaptureObservations& capture, const ClipRange& clip, int view) {
  const int joints = capture.joint_count();
  Eigen::MatrixXf keypoints = Eigen::MatrixXf::Constant(clip.count, 2 * static_cast<Eigen::Index>(joints), kNotKnown);
  std::vector<double> sizes;
  for (int t = 0; t < clip.count; ++t) {
    const int n = clip.first + t;
    if (!capture.Sees(n, view, capture.skeleton.root)) continue;
    const Eigen::Vector2d root = capture.At(n, view, capture.skeleton.root);
    double squares = 0.0;
    int seen = 0;
    for (int j = 0; j < joints; ++j) {
      if (!capture.Sees(n, view, j)) continue;
      const Eigen::Vector2d relative = capture.At(n, view, j) - root;
      keypoints(t, j) = static_cast<float>(relative.x());
      keypoints(t, joints + j) = static_cast<float>(relative.y());
      squares += relative.squaredNorm();
      ++seen;
    }
    sizes.push_back(std::sqrt(squares / seen));
  }
  const double size = Median(std::move(sizes));
  if (size > 0.0) keypoints /= static_cast<float>(size);
  return keypoints;
}

/// Means of the known values of `count` successive rows.
Eigen::MatrixXf Decimate(const Eigen::MatrixXf& values, int count) {
  Eigen::MatrixXf means = Eigen::MatrixXf::Constant(values.rows() / count, values.cols(), kNotKnown);
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    for (Eigen::Index i = 0; i < means.rows(); ++i) {
      float sum = 0.0F;
      int known = 0;
      for (Eigen::Index k = i * count; k < (i + 1) * count; ++k) {
        if (!std::isfinite(values(k, c))) continue;
        sum += values(k, c);
        ++known;
      }
      if (known > 0) means(i, c) = sum / static_cast<float>(known);
    }
  }
  return means;
}

/// Running sums, so that those over a range are differences.
class RangeSums {
 public:
  explicit RangeSums(const Eigen::VectorXd& values) : sums_(static_cast<std::size_t>(values.size()) + 1, 0.0) {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      sums_[static_cast<std::size_t>(i) + 1] = sums_[static_cast<std::size_t>(i)] + values[i];
    }
  }
  /// Of first .. end - 1.
  [[nodiscard]] double Of(int first, int end) const {
    return sums_[static_cast<std::size_t>(end)] - sums_[static_cast<std::size_t>(first)];
  }

 private:
  std::vector<double> sums_;
};

/// The means of known values within `reach` samples of each, in time proportional to their number; NaN where there are
/// none.
Eigen::VectorXf MovingMean(const Eigen::Ref<const Eigen::VectorXf>& values, int reach) {
  const auto count = static_cast<int>(values.size());
  const auto is_known = values.array().isFinite();
  const RangeSums sums(is_known.select(values.array(), 0.0F).cast<double>().matrix());
  const RangeSums known(is_known.cast<double>().matrix());
  Eigen::VectorXf means(count);
  for (int i = 0; i < count; ++i) {
    const int from = std::max(0, i - reach);
    const int to = std::min(count, i + reach + 1);
    const double in_reach = known.Of(from, to);
    means[i] = in_reach > 0.0 ? static_cast<float>(sums.Of(from, to) / in_reach) : kNotKnown;
  }
  return means;
}

/// Keeps in every column what is neither noise nor drift, and replaces what is not known by 0.
void KeepMotion(double samples_per_second, Eigen::MatrixXf& values) {
  const int noise = static_cast<int>(std::lround(0.5 * kNoiseSeconds * samples_per_second));
  const int drift = static_cast<int>(std::lround(0.5 * kDriftSeconds * samples_per_second));
  double squares = 0.0;
  Eigen::Index known = 0;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const Eigen::VectorXf slow = MovingMean(values.col(c), drift);
    const Eigen::VectorXf smooth = MovingMean(values.col(c), noise);
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      float& value = values(i, c);
      if (!std::isfinite(value)) {
        value = 0.0F;
        continue;
      }
      value = smooth[i] - slow[i];
      squares += static_cast<double>(value) * value;
      ++known;
    }
  }
  if (known == 0) return;
  const auto largest = static_cast<float>(kLargest * std::sqrt(squares / static_cast<double>(known)));
  values = values.cwiseMax(-largest).cwiseMin(largest);
}

/// Spectra and inner products of two signatures at all lags.
class Correlator {
 public:
  Correlator(int a_count, int b_count) : size_(1) {
    while (size_ < a_count + b_count) size_ *= 2;
    fft_.SetFlag(Eigen::FFT<float>::HalfSpectrum);
  }
  [[nodiscard]] Spectrum Of(const Eigen::Ref<const Eigen::VectorXf>& values) {
    std::vector<float> padded(static_cast<std::size_t>(size_), 0.0F);
    std::copy_n(values.data(), values.size(), padded.begin());
    Spectrum spectrum;
    fft_.fwd(spectrum, padded);
    return spectrum;
  }
  /// Adds the spectrum of sum over i of a(i + lag) b(i).
  static void AddProduct(const Spectrum& a, const Spectrum& b, Spectrum& sum) {
    sum.resize(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) sum[k] += a[k] * std::conj(b[k]);
  }
  /// By lag, negative ones at the end.
  [[nodiscard]] std::vector<float> ByLag(const Spectrum& products) {
    std::vector<float> values;
    fft_.inv(values, products, size_);
    return values;
  }
  [[nodiscard]] std::size_t Place(int lag) const { return static_cast<std::size_t>(lag < 0 ? lag + size_ : lag); }

 private:
  int size_;
  Eigen::FFT<float> fft_;
};

/// The samples of both signatures that meet at a lag; those of the first are `lag` more.
struct Overlap {
  int first = 0;  ///< of the second signature
  int end = 0;

  Overlap(const MotionSignature& a, const MotionSignature& b, int lag)
      : first(std::max(b.first, a.first - lag)), end(std::min(b.last, a.last - lag) + 1) {}
  [[nodiscard]] int count() const { return std::max(0, end - first); }
};

/// The correlation of the distances between joints at every lag of first_lag, first_lag + 1, ...
std::vector<double> CorrelatePoses(const MotionSignature& a, const MotionSignature& b, int first_lag, int lags) {
  Correlator correlator(a.count(), b.count());
  Spectrum products;
  for (Eigen::Index c = 0; c < a.poses.cols(); ++c) {
    Correlator::AddProduct(correlator.Of(a.poses.col(c)), correlator.Of(b.poses.col(c)), products);
  }
  std::vector<double> correlations(static_cast<std::size_t>(lags), 0.0);
  if (products.empty()) return correlations;
  const std::vector<float> by_lag = correlator.ByLag(products);
  const RangeSums of_a(a.poses.rowwise().squaredNorm().cast<double>());
  const RangeSums of_b(b.poses.rowwise().squaredNorm().cast<double>());
  for (int i = 0; i < lags; ++i) {
    const int lag = first_lag + i;
    const Overlap overlap(a, b, lag);
    if (overlap.count() == 0) continue;
    const double squares = of_a.Of(overlap.first + lag, overlap.end + lag) * of_b.Of(overlap.first, overlap.end);
    if (squares > 0.0) correlations[static_cast<std::size_t>(i)] = by_lag[correlator.Place(lag)] / std::sqrt(squares);
  }
  return correlations;
}

/// Second moments of keypoints about 0, over ranges of samples.
class Moments {
 public:
  explicit Moments(const Eigen::MatrixXf& keypoints)
      : xx_(Products(keypoints, 0, 0)), xy_(Products(keypoints, 0, 1)), yy_(Products(keypoints, 1, 1)) {}
  [[nodiscard]] Eigen::Matrix2d Of(int first, int end) const {
    Eigen::Matrix2d moments;
    moments << xx_.Of(first, end), xy_.Of(first, end), xy_.Of(first, end), yy_.Of(first, end);
    return moments;
  }

 private:
  static Eigen::VectorXd Products(const Eigen::MatrixXf& keypoints, int a, int b) {
    const Eigen::Index joints = keypoints.cols() / 2;
    return keypoints.middleCols(a * joints, joints)
        .cwiseProduct(keypoints.middleCols(b * joints, joints))
        .rowwise()
        .sum()
        .cast<double>();
  }
  RangeSums xx_;
  RangeSums xy_;
  RangeSums yy_;
};

/// The first canonical correlation, given second moments; 0 where one of the views hardly shows any motion.
double FirstCanonicalCorrelation(const Eigen::Matrix2d& aa, const Eigen::Matrix2d& ab, const Eigen::Matrix2d& bb) {
  const auto inverse_root = [](const Eigen::Matrix2d& moments) -> Eigen::Matrix2d {
    const double floor = 1e-4 * moments.trace() + 1e-12;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(moments + floor * Eigen::Matrix2d::Identity())
        .operatorInverseSqrt();
  };
  const Eigen::Matrix2d between = inverse_root(aa) * ab * inverse_root(bb);
  const double squares = between.squaredNorm();
  const double product = std::abs(between.determinant());
  // The larger singular value of a 2 x 2 matrix.
  return std::sqrt(0.5 * (squares + std::sqrt(std::max(0.0, squares * squares - 4.0 * product * product))));
}

/// The first canonical correlation of the keypoints at every lag.
std::vector<double> CorrelateKeypoints(const MotionSignature& a, const MotionSignature& b, int first_lag, int lags) {
  Correlator correlator(a.count(), b.count());
  const Eigen::Index joints = a.keypoints.cols() / 2;
  std::array<Spectrum, 4> products;
  for (Eigen::Index j = 0; j < joints; ++j) {
    const std::array<Spectrum, 2> of_a = {correlator.Of(a.keypoints.col(j)),
                                          correlator.Of(a.keypoints.col(joints + j))};
    const std::array<Spectrum, 2> of_b = {correlator.Of(b.keypoints.col(j)),
                                          correlator.Of(b.keypoints.col(joints + j))};
    for (std::size_t k = 0; k < 4; ++k) Correlator::AddProduct(of_a[k / 2], of_b[k % 2], products[k]);
  }
  std::array<std::vector<float>, 4> by_lag;
  for (std::size_t k = 0; k < 4; ++k) by_lag[k] = correlator.ByLag(products[k]);
  const Moments of_a(a.keypoints);
  const Moments of_b(b.keypoints);
  std::vector<double> correlations(static_cast<std::size_t>(lags), 0.0);
  for (int i = 0; i < lags; ++i) {
    const int lag = first_lag + i;
    const Overlap overlap(a, b, lag);
    if (overlap.count() == 0) continue;
    const std::size_t place = correlator.Place(lag);
    Eigen::Matrix2d between;
    between << by_lag[0][place], by_lag[1][place], by_lag[2][place], by_lag[3][place];
    correlations[static_cast<std::size_t>(i)] = FirstCanonicalCorrelation(
        of_a.Of(overlap.first + lag, overlap.end + lag), between, of_b.Of(overlap.first, overlap.end));
  }
  return correlations;
}

/// Correlations in robust standard deviations over the compared lags. Chance correlations shrink with the root of the
/// overlap, so they are multiplied by it.
void Standardise(const std::vector<int>& overlaps, int min_overlap, std::vector<double>& correlations) {
  std::vector<double> compared;
  for (std::size_t i = 0; i < correlations.size(); ++i) {
    const double correlation = std::clamp(correlations[i], -kLargestCorrelation, kLargestCorrelation);
    correlations[i] = overlaps[i] < min_overlap ? std::nan("") : std::atanh(correlation) * std::sqrt(overlaps[i]);
    if (std::isfinite(correlations[i])) compared.push_back(correlations[i]);
  }
  const double median = Median(compared);
  for (double& value : compared) value = std::abs(value - median);
  constexpr double kNormal = 1.4826;  // standard deviations per median deviation of normal values
  const double deviation = kNormal * Median(std::move(compared));
  for (double& value : correlations) value = deviation > 0.0 ? (value - median) / deviation : 0.0 * value;
}

}  // namespace

MotionSignature SignatureOf(const CaptureObservations& capture, int clip, int view) {
  const ClipRange& range = capture.clips[static_cast<std::size_t>(clip)];
  MotionSignature signature;
  const int frames_per_sample = std::max(1, static_cast<int>(range.fps / kSamplesPerSecond));
  signature.frames_per_sample = frames_per_sample;
  signature.samples_per_second = range.fps / frames_per_sample;
  signature.poses = Decimate(DistancesOf(capture, range, view), frames_per_sample);
  signature.keypoints = Decimate(KeypointsOf(capture, range, view), frames_per_sample);
  const auto knows_any = [&](int i) { return signature.keypoints.row(i).array().isFinite().any(); };
  const int count = signature.count();
  while (signature.first < count && !knows_any(signature.first)) ++signature.first;
  signature.last = count - 1;
  while (signature.last >= signature.first && !knows_any(signature.last)) --signature.last;
  KeepMotion(signature.samples_per_second, signature.poses);
  KeepMotion(signature.samples_per_second, signature.keypoints);
  return signature;
}

MotionSignature Stretch(const MotionSignature& signature, double rate) {
  MotionSignature stretched = signature;
  const auto count = static_cast<int>(std::floor((signature.count() - 1) * rate)) + 1;
  stretched.first = static_cast<int>(std::ceil(signature.first * rate));
  stretched.last = std::min(count - 1, static_cast<int>(std::floor(signature.last * rate)));
  stretched.poses.resize(count, signature.poses.cols());
  stretched.keypoints.resize(count, signature.keypoints.cols());
  for (int i = 0; i < count; ++i) {
    const double at = i / rate;
    const int before = std::min(static_cast<int>(at), signature.count() - 1);
    const int after = std::min(before + 1, signature.count() - 1);
    const auto share = static_cast<float>(at - before);
    stretched.poses.row(i) = (1.0F - share) * signature.poses.row(before) + share * signature.poses.row(after);
    stretched.keypoints.row(i) =
        (1.0F - share) * signature.keypoints.row(before) + share * signature.keypoints.row(after);
  }
  return stretched;
}

SimilarityCurve::SimilarityCurve(const MotionSignature& a, const MotionSignature& b, double min_overlap_seconds) {
  if (!a.knows_anything() || !b.knows_anything()) return;
  first_lag_ = a.first - b.last;
  const int lags = a.last - b.first - first_lag_ + 1;
  const int min_overlap = std::max(2, static_cast<int>(std::ceil(min_overlap_seconds * a.samples_per_second)));
  std::vector<int> overlaps;
  for (int i = 0; i < lags; ++i) overlaps.push_back(Overlap(a, b, first_lag_ + i).count());
  std::vector<double> poses = CorrelatePoses(a, b, first_lag_, lags);
  Standardise(overlaps, min_overlap, poses);
  values_ = CorrelateKeypoints(a, b, first_lag_, lags);
  Standardise(overlaps, min_overlap, values_);
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = (values_[i] + poses[i]) / std::sqrt(2.0);
}

double SimilarityCurve::At(double lag) const {
  const double place = lag - first_lag_;
  if (!(place >= 0.0) || place > static_cast<double>(values_.size()) - 1.0) return 0.0;
  const auto before = static_cast<std::size_t>(place);
  const std::size_t after = std::min(before + 1, values_.size() - 1);
  const double share = place - static_cast<double>(before);
  const double value = share > 0.0 ? (1.0 - share) * values_[before] + share * values_[after] : values_[before];
  return std::isfinite(value) ? value : 0.0;
}

std::vector<SimilarityCurve::Peak> SimilarityCurve::Peaks(int count, double apart) const {
  std::vector<Peak> maxima;
  for (std::size_t i = 1; i + 1 < values_.size(); ++i) {
    const double left = values_[i - 1];
    const double here = values_[i];
    const double right = values_[i + 1];
    if (!(here >= left && here > right)) continue;  // not where one is unknown
    const double bend = left - 2.0 * here + right;
    const double shift = bend < 0.0 ? 0.5 * (left - right) / bend : 0.0;
    maxima.push_back({first_lag_ + static_cast<double>(i) + shift, here});
  }
  std::ranges::stable_sort(maxima, std::ranges::greater(), &Peak::value);
  std::vector<Peak> peaks;
  for (const Peak& peak : maxima) {
    if (static_cast<int>(peaks.size()) == count) break;
    const bool is_new =
        std::ranges::all_of(peaks, [&](const Peak& other) { return std::abs(other.lag - peak.lag) >= apart; });
    if (is_new) peaks.push_back(peak);
  }
  return peaks;
}

}  // namespace canonpose
