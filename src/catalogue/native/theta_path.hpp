// Many rows, and theta after each.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>

#include <stdexcept>

namespace rlslab::native {

/// Rows as of Filter::update_many, one after another as Filter::update takes them, with its bits (of qr_block, too).
/// weights: as many, or null: all 1. theta: room for rows x d numbers, by rows, each as Filter::theta gives it after
/// its row; NaN while the rows do not determine it. steps: room for all, or null. Returns the last row's step. Cost: an
/// update and a theta a row; of qr, gentleman and information each theta is a solution, d^2/2 multiplications or more.
template <class X>
Step update_many(Filter& filter, X const* psi, Index rows, Index stride, X const* y, X const* weights, Step* steps,
                 double* theta) {
    Index const d = filter.size();
    if (stride == 0) stride = d;
    if (rows < 0 || stride < d) throw std::invalid_argument("expected rows >= 0 that do not overlap");
    Step last{Options::unset, Options::unset, Options::unset, 0, 0};
    for (Index k = 0; k < rows; ++k) {
        X const* const row = psi + k * stride;
        last = weights ? filter.update(row, y[k], weights[k]) : filter.update(row, y[k]);
        filter.theta(theta + k * d);
        if (steps) steps[k] = last;
    }
    return last;
}

}  // namespace rlslab::native
