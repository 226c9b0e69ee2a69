// The forms a network can have, as model files and training options name them. No LibTorch in this header.
#pragma once

#include <array>

#include "canonpose/base/enum_names.h"

namespace canonpose {

/// The networks that lift poses.
enum class LifterKind { kCanonical, kMartinez };

template <>
inline constexpr std::array kEnumNames<LifterKind>{
    EnumName{LifterKind::kCanonical, "canonical", "the method's: a canonical pose and a rotation"},
    EnumName{LifterKind::kMartinez, "martinez", "a supervised baseline, whose output is the pose in the camera alone"}};

/// What a model file holds: a lifter (model/lifter.h, model/martinez_lifter.h) or a morphing network (model/morph.h).
enum class NetworkKind { kCanonical, kMartinez, kMorph };

template <>
inline constexpr std::array kEnumNames<NetworkKind>{EnumName{NetworkKind::kCanonical, "canonical"},
                                                    EnumName{NetworkKind::kMartinez, "martinez"},
                                                    EnumName{NetworkKind::kMorph, "morph"}};

constexpr NetworkKind NetworkOf(LifterKind kind) {
  return kind == LifterKind::kMartinez ? NetworkKind::kMartinez : NetworkKind::kCanonical;
}

/// The output of the rotation branch.
enum class RotationForm {
  kAxisAngle,  ///< three numbers: a rotation vector, see Rodrigues()
  kSix,        ///< six: two columns of a matrix before they are made orthonormal, see RotationFromSix()
};

template <>
inline constexpr std::array kEnumNames<RotationForm>{
    EnumName{RotationForm::kAxisAngle, "axis_angle", "a rotation vector, as published"},
    EnumName{RotationForm::kSix, "6d", "two columns of the rotation matrix, a continuous form"}};

/// What a network sees of the confidences of its input.
enum class ConfidenceInput {
  kAll,  ///< every joint's confidence, as published
  /// Which joints are missing: -1, the others 0; and the coordinates of a pose at a mean square of 1. Confidences near
  /// 1 beside coordinates near 0.2 are a large constant to learn around, which costs accuracy (docs/results.md).
  kMissing,
  kNone,  ///< nothing: 2D coordinates alone
};

template <>
inline constexpr std::array kEnumNames<ConfidenceInput>{
    EnumName{ConfidenceInput::kAll, "on", "every joint's confidence, as published"},
    EnumName{ConfidenceInput::kMissing, "missing", "only which joints are missing, with the pose scaled up"},
    EnumName{ConfidenceInput::kNone, "off", "nothing, 2D coordinates alone"}};

/// Whether the camera is rotated to look straight at the person before the pose is normalised (model/pose_input.h).
enum class RayForm { kOff, kRoot };

template <>
inline constexpr std::array kEnumNames<RayForm>{
    EnumName{RayForm::kOff, "off", "the pose as it lies in the image"},
    EnumName{RayForm::kRoot, "root", "the root's viewing ray is rotated onto the optical axis"}};

/// Where the intrinsics for that rotation come from.
enum class FocalSource { kGuess, kKnown };

template <>
inline constexpr std::array kEnumNames<FocalSource>{
    EnumName{FocalSource::kGuess, "guess", "guessed from the image size"},
    EnumName{FocalSource::kKnown, "known", "solved or calibrated ones, where there are any"}};

/// How a view's 2D pose becomes the network's input (model/pose_input.h).
struct InputForm {
  RayForm ray = RayForm::kOff;
  FocalSource focal = FocalSource::kGuess;
  ConfidenceInput confidences = ConfidenceInput::kAll;
};

}  // namespace canonpose
