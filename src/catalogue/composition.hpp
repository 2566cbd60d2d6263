// A composition and a record: numbers that follow from the data, and what is odd about the two together.
#pragma once

#include <rlslab/catalogue/native/composition.hpp>

namespace rlslab {

/// Whether one of its numbers is not given and follows from the noise.
bool needs_noise_variance(Composition const& composition);
/// The composition with the numbers that follow from the data: fortescue's VARIANCE is the noise's, reset's the
/// prior's, the largest of its P. Throws InputError where one of its numbers is missing and does not follow.
Composition completed(Composition composition, Problem<double> const& problem, double noise_variance);

/// What is odd about it on a record of so many rows and parameters.
std::vector<std::string> warnings_of(Composition const& composition, Index rows, Index parameters);

}  // namespace rlslab
