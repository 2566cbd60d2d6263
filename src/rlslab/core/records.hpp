// Regressors and outputs, always in binary64: the form in which data are passed everywhere.
#pragma once

#include <rlslab/core/problem.hpp>

#include <string>
#include <vector>

namespace rlslab {

/// N rows of y_k = psi_k' theta + noise.
struct Records {
    Matrix<double> psi;  ///< d x N: column k is psi_k, contiguous
    Vector<double> y;    ///< N
    /// d: of the parameters from arx_records() ("a1", "b0"), else of the regressors ("-y[k-1]", "1").
    std::vector<std::string> names = {};
    Index skipped = 0;      ///< rows left out because a value they need was missing
    Index presample = 0;    ///< rows at the start without the history a regressor needs; not among skipped
    std::string file = {};  ///< named in messages; "": none is
    Index parameters() const { return psi.rows(); }
    Index rows() const { return psi.cols(); }
    Regressor<double> sample(Index k) const { return {psi.col(k).data(), psi.rows()}; }
};

}  // namespace rlslab
