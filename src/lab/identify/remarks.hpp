// Warnings and hints about an identified model.
#pragma once

#include "src/lab/identify/identify.hpp"

namespace rlslab::identify {

/// The number of leading terms of an input whose confidence intervals all contain 0; 0 if those of all its terms do.
int idle_lead(std::vector<Term> const& terms, std::vector<Parameter> const& parameters, int input);

/// Remarks about the structure, the residuals and the held-out part of a model that is otherwise complete.
std::vector<Remark> remarks_on(Identified const& model);

}  // namespace rlslab::identify
