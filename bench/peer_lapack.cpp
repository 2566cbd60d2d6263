// As OpenBLAS has it, on one thread: peer/lapack_dgels/ROWSxSIZE, LAPACK's least squares driver;
// peer/normal_equations_openblas/ROWSxSIZE, by dsyrk.
#include "bench/rows.hpp"

#include <Eigen/Cholesky>

// Fortran's, with the types of OpenBLAS' default build; lapacke.h would be one package more for this line.
extern "C" void dgels_(char const* trans, int const* m, int const* n, int const* nrhs, double* a, int const* lda,
                       double* b, int const* ldb, double* work, int const* lwork, int* info, std::size_t trans_length);
extern "C" void dsyrk_(char const* uplo, char const* trans, int const* n, int const* k, double const* alpha,
                       double const* a, int const* lda, double const* beta, double* c, int const* ldc,
                       std::size_t uplo_length, std::size_t trans_length);
extern "C" void openblas_set_num_threads(int threads);

namespace rlslab::bench {
namespace {

/// It overwrites A, by columns, and y; the copies are made outside the time, the workspace is the one it asks for.
struct Data {
    Matrix<double> A;
    Vector<double> y;
};

Vector<double> solve(Data& data) {
    int const m = int(data.A.rows()), n = int(data.A.cols()), one = 1;
    int info = 0, lwork = -1;
    double best = 0;
    dgels_("N", &m, &n, &one, data.A.data(), &m, data.y.data(), &m, &best, &lwork, &info, 1);
    lwork = int(best);
    std::vector<double> work(static_cast<size_t>(lwork));
    dgels_("N", &m, &n, &one, data.A.data(), &m, data.y.data(), &m, work.data(), &lwork, &info, 1);
    return data.y.head(n);
}

Vector<double> solve_normal_equations(Records const* records) {
    Matrix<double> M = Matrix<double>::Zero(records->parameters(), records->parameters());
    int const n = int(M.rows()), k = int(records->rows());
    double const one = 1;
    dsyrk_("L", "N", &n, &k, &one, records->psi.data(), &n, &one, M.data(), &n, 1, 1);
    return M.selfadjointView<Eigen::Lower>().llt().solve(records->psi * records->y);
}

Rows const added([] {
    openblas_set_num_threads(1);  // for every row of the program: all of them are for one thread
    add_batch_rows(
        "peer/lapack_dgels",
        [](Records const& records) {
            return Data{records.psi.transpose(), records.y};
        },
        solve);
    add_batch_rows(
        "peer/normal_equations_openblas", [](Records const& records) { return &records; }, solve_normal_equations);
});

}  // namespace
}  // namespace rlslab::bench
