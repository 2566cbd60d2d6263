// peer/gsl_tsqr/ROWSxSIZE: GSL's multilarge TSQR, fed in blocks.
#include "bench/rows.hpp"

#include <gsl/gsl_multilarge.h>

namespace rlslab::bench {
namespace {

constexpr Index block = 1024;

/// Its accumulate overwrites the data, taken by rows as the records lie; the copy is made outside the time.
struct Data {
    Matrix<double> psi;
    Vector<double> y;
};

Vector<double> solve(Data& data) {
    Index const d = data.psi.rows(), rows = data.y.size();
    auto* const w = gsl_multilarge_linear_alloc(gsl_multilarge_linear_tsqr, size_t(d));
    for (Index k = 0; k < rows; k += block) {
        auto const taken = size_t(std::min(block, rows - k));
        auto X = gsl_matrix_view_array(data.psi.col(k).data(), taken, size_t(d));
        auto y = gsl_vector_view_array(data.y.data() + k, taken);
        gsl_multilarge_linear_accumulate(&X.matrix, &y.vector, w);
    }
    Vector<double> theta(d);
    auto c = gsl_vector_view_array(theta.data(), size_t(d));
    double residual_norm, solution_norm;
    gsl_multilarge_linear_solve(0, &c.vector, &residual_norm, &solution_norm, w);
    gsl_multilarge_linear_free(w);
    return theta;
}

Rows const added([] {
    add_batch_rows(
        "peer/gsl_tsqr",
        [](Records const& records) {
            return Data{records.psi, records.y};
        },
        solve);
});

}  // namespace
}  // namespace rlslab::bench
