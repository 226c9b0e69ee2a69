// Smoothing 3D poses and filling their gaps, as movement scientists do and report it. Both are off unless asked for.
#pragma once

#include <string>
#include <vector>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

struct FilterOptions {
  double cutoff_hz = 0.0;            ///< of the low-pass filter; 6 is usual for walking. 0: no filter
  double longest_gap_seconds = 0.0;  ///< gaps up to this are filled, longer ones stay. 0: none is filled

  /// Throws Error(kInvalidArgument) where one of them is negative or not a number.
  void Validate() const;
};

/// What was done, for files: "Butterworth, 4th order, zero phase, 6 Hz; gaps up to 0.2 s filled". Empty where both are
/// off.
std::string Describe(const FilterOptions& options);

/// Fills gaps first and filters then. Throws Error(kInvalidArgument) where LowPass() does.
void Filter(PoseSequence& person, const FilterOptions& options);

/// Fills the gaps of each joint that last no longer than `longest_gap_seconds` and have known positions on both sides.
/// They follow the cubic that fits up to as many frames on either side best, moved so that it meets both ends. Filled
/// joints keep confidence 0 and an unknown standard deviation. Throws Error(kInvalidArgument) where neither frame rate
/// nor time stamps are known.
void FillGaps(PoseSequence& person, double longest_gap_seconds);

/// Filters each joint with the filter below, in each stretch between two gaps by itself. Time stamps that are more than
/// one and a half usual steps apart end a stretch, too. Standard deviations stay what they were. Throws
/// Error(kInvalidArgument) where the frame rate is not known or not more than twice the cutoff.
void LowPass(PoseSequence& person, double cutoff_hz);

/// A Butterworth filter of second order, run forwards and backwards: of fourth order, without delay, and with half the
/// power (-3 dB) at the cutoff, since each pass has a cutoff that is higher by 1 / (2^(1/2) - 1)^(1/4) (Winter,
/// Biomechanics and Motor Control of Human Movement). Before and after, the values go on for 9 frames reflected about
/// their ends; each pass begins in the steady state. This is filtfilt() of SciPy and MATLAB. All values must be known.
std::vector<double> LowPass(const std::vector<double>& values, double cutoff_hz, double fps);

/// Frames per second: `fps`, or of the median step between time stamps; 0 where neither is known.
double FrameRateOf(const PoseSequence& person);

}  // namespace canonpose
