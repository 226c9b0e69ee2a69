// When each frame of a video was taken, from time stamps that cannot all be believed.
#pragma once

namespace canonpose {

/// Turns a container's time stamps into times that begin with 0 and always grow. Containers leave stamps out, mostly of
/// the last frames, repeat them, and damaged ones jump; such a frame is taken to follow the one before after the usual
/// interval, and before the next one if that can be believed. A pause is believed if the next stamp comes after it.
/// After several stamps that only grow, but from another beginning, time goes on with them.
class TimeStamps {
 public:
  /// `fps` is the rate that the container states; 0 or not finite where it states none.
  explicit TimeStamps(double fps);

  /// The time in seconds of the next frame, whose stamp is `stamp_seconds`; NaN for a frame without one. `following` is
  /// the stamp of the frame after it, NaN at the end.
  double Next(double stamp_seconds, double following);

  /// Frames whose stamp was not believed, without a few at the end: decoders give those of most videos without one.
  [[nodiscard]] long corrected() const;

 private:
  [[nodiscard]] bool IsSoonAfter(double time, double before) const;
  [[nodiscard]] bool IsBelievable(double time, double following) const;
  /// The time of a frame whose stamp is not believed.
  [[nodiscard]] double Guess(double following) const;
  /// Whether the stamps lately only grew, though none was believed.
  bool IsNewBeginning(double stamp_seconds);

  double interval_;      ///< between frames, in seconds
  double origin_ = 0.0;  ///< the stamp at time 0
  double last_ = 0.0;    ///< the last frame's time
  double last_stamp_;    ///< the last frame's stamp
  double step_ = 0.0;    ///< to the last frame whose stamp was believed; longer than `interval_` where that is wrong
  bool has_origin_ = false;
  int growing_ = 0;  ///< stamps in a row that were not believed, each later than the one before
  long frames_ = 0;
  long corrected_ = 0;  ///< frames whose stamp was not believed
  long trailing_ = 0;   ///< of these, those since the last one that was
};

}  // namespace canonpose
