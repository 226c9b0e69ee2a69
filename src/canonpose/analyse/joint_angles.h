// Joint angles from segments: the three rotations of one segment against another, and how they go on over time.
//
// Joint coordinate systems of Grood and Suntay (1983): the rotation from the proximal to the distal segment is
// Rz(flexion) * Rx(adduction) * Ry(rotation), in the axes of segments.h. This is also the order of OpenSim's
// coordinates.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/analyse/analysis.h"
#include "canonpose/analyse/segments.h"

namespace canonpose {

/// Radians; NaN where unknown. Flexion and adduction need only the second segment's y.
struct JointRotation {
  double flexion = 0.0;    ///< about the first segment's z
  double adduction = 0.0;  ///< about the axis at right angles to both others; from -pi/2 to pi/2
  double rotation = 0.0;   ///< about the second segment's y
};

/// The rotation of the right side's `child` against `parent`; of the left side's with `is_left`, so that the angles of
/// mirrored poses are the same.
JointRotation RotationBetween(const Eigen::Matrix3d& parent, const Eigen::Matrix3d& child, bool is_left = false);

/// The same rotation in the other way: (flexion + pi, pi - adduction, rotation + pi), for limbs abducted beyond a right
/// angle.
JointRotation OtherWay(const JointRotation& rotation);

/// The arm's rotations over time (T), each in the way that goes on from the one before and that a shoulder can: it does
/// not turn the arm about itself by more than 150 degrees. `elbow_rad`: how far the elbow is bent; where it is bent by
/// less than 30 degrees it may appear bent the wrong way and decides nothing.
void FollowArm(std::vector<JointRotation>& arm, const std::vector<double>& elbow_rad);

/// Makes flexion and rotation unknown where adduction is within kSmallestAngleDeg of +-90 degrees: there only their sum
/// or difference can be told.
void HideWherePolesCoincide(std::vector<JointRotation>& rotations);

/// Adds multiples of 360 degrees so that no value is more than 180 from the last known one.
void Unwrap(std::vector<double>& degrees);

/// All angles of a person, docs/analysis.md; those of pelvis and trunk against the floor only if `up_is_known`.
std::vector<TimeSeries> JointAngles(const PoseSequence& person, const BodyJoints& joints, bool up_is_known);

}  // namespace canonpose
