// When each frame of a video was taken, from time stamps that cannot all be believed.
#pragma once

namespace canonpose {

/// Turns a container's time stamps into times that begin with 0 and always grow. Containers leave stamps out, mostly of
/// the last frames, repeat them, and damaged ones jump; such a frame is taken to follow the one before after the usual
/// interval.
class TimeStamps {
 public:
  /// `fps` is the rate that the container states; 0 or not finite where it states none.
  explicit TimeStamps(double fps);

  /// The time in seconds of the next frame, whose stamp is `stamp_seconds`; NaN for a frame without one.
  double Next(double stamp_seconds);

  /// Frames whose stamp was not believed.
  [[nodiscard]] long corrected() const { return corrected_; }

 private:
  [[nodiscard]] bool IsBelievable(double time) const;

  double interval_;     ///< between frames, in seconds
  double first_ = 0.0;  ///< the first frame's stamp
  double last_ = 0.0;   ///< the last frame's time
  long frames_ = 0;
  long corrected_ = 0;
};

}  // namespace canonpose
