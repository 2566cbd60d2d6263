// Records of the second distribution of random problems.
#pragma once

#include "studies/published/drawn_problem.hpp"

namespace rlslab::studies {

/// What `realisation` returns for a problem that has a kind.
Records everyday_realisation(DrawnProblem const& problem, Seed rows, Seed noise);

}  // namespace rlslab::studies
