// Places what `solve` found in the real world.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/scene/world.h"

namespace canonpose {

/// Moves the solved cameras of sequences that share them (one capture: indices into the dataset) to the world that
/// FindWorld() finds, scales them and the solved poses with their uncertainties where the scale is known, and sets
/// Sequence::solved_world. Sequences without a solution are left as they are. Throws what FindWorld() throws.
void PlaceSolvedInWorld(std::span<const std::size_t> sequences, const WorldMeasures& measures, Dataset& dataset);

/// The distances between all calibrated cameras of a sequence, if they stand still; none where fewer than two are
/// calibrated.
WorldMeasures DistancesOfCalibration(const Sequence& sequence);

/// Throws Error(kInvalidArgument) where heights are given of people whom the dataset does not show, or one without a
/// name though it shows several; or distances of cameras that it does not have, or whose cameras move.
void RequireMeasuresOf(const Dataset& dataset, const WorldMeasures& measures);

/// The measures without distances of cameras that were not solved in a sequence.
WorldMeasures MeasuresIn(const Sequence& sequence, const WorldMeasures& measures);

}  // namespace canonpose
