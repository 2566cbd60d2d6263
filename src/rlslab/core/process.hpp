// Many rows into one filter.
#pragma once

#include <rlslab/core/concept.hpp>

#include <algorithm>

namespace rlslab {

/// The columns of psi and the numbers of y, the oldest first, each rounded to F's scalar: in blocks where F TakesBlocks,
/// else one by one, without a report but the last one's where it Accumulates. Returns the last row's step; of blocks
/// there is none: its numbers are NaN, its health is that after the last block. Throws std::invalid_argument, and takes no
/// row, unless psi is d x N and y has N numbers.
template <RecursiveLeastSquares F, class Psi, class Y>
Step<typename F::scalar> process(F& f, Eigen::MatrixBase<Psi> const& psi, Eigen::MatrixBase<Y> const& y) {
    using T = typename F::scalar;
    expects(psi.cols() == y.size(), "as many outputs as regressors");
    Step<T> step{undefined<T>(), undefined<T>(), undefined<T>()};
    if constexpr (TakesBlocks<F>) {
        for (Index k = 0; k < y.size(); k += F::block) {
            Index const rows = std::min<Index>(F::block, y.size() - k);
            step.health = f.update_block(psi.middleCols(k, rows).template cast<T>(), y.segment(k, rows).template cast<T>());
        }
    } else {
        Vector<T> row(psi.rows());
        for (Index k = 0; k < y.size(); ++k) {
            row = psi.col(k).template cast<T>();
            if constexpr (Accumulates<F>)
                if (k + 1 < y.size()) {
                    f.accumulate(row, T(y[k]));
                    continue;
                }
            step = f.update(row, T(y[k]));
        }
    }
    return step;
}

}  // namespace rlslab
