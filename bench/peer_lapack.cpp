// As OpenBLAS has it, on one thread: peer/lapack_dgels/ROWSxSIZE, LAPACK's least squares driver;
// peer/normal_equations_openblas/ROWSxSIZE, by dsyrk; peer/cholesky_qr2/ROWSxSIZE, QR by two Cholesky factorisations.
#include "bench/rows.hpp"

#include <Eigen/Cholesky>

// Fortran's, with the types of OpenBLAS' default build; lapacke.h would be one package more for this line.
extern "C" void dgels_(char const* trans, int const* m, int const* n, int const* nrhs, double* a, int const* lda,
                       double* b, int const* ldb, double* work, int const* lwork, int* info, std::size_t trans_length);
extern "C" void dsyrk_(char const* uplo, char const* trans, int const* n, int const* k, double const* alpha,
                       double const* a, int const* lda, double const* beta, double* c, int const* ldc,
                       std::size_t uplo_length, std::size_t trans_length);
extern "C" void dtrsm_(char const* side, char const* uplo, char const* trans, char const* diag, int const* m,
                       int const* n, double const* alpha, double const* a, int const* lda, double* b, int const* ldb,
                       std::size_t side_length, std::size_t uplo_length, std::size_t trans_length,
                       std::size_t diag_length);
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

/// C's lower triangle += A A', A of `columns` columns.
void add_squares(Matrix<double>& C, double const* A, Index columns) {
    int const n = int(C.rows()), k = int(columns);
    double const one = 1;
    dsyrk_("L", "N", &n, &k, &one, A, &n, &one, C.data(), &n, 1, 1);
}

Vector<double> solve_normal_equations(Records const* records) {
    Matrix<double> M = Matrix<double>::Zero(records->parameters(), records->parameters());
    add_squares(M, records->psi.data(), records->rows());
    return M.selfadjointView<Eigen::Lower>().llt().solve(records->psi * records->y);
}

/// CholeskyQR2 of [Psi y], by columns as the records lie: L1 L1' = A A', the rows are divided by L1 a block at a time
/// while it is in cache, L2 L2' = Q Q' of what comes, L = L1 L2. Its guard is the condition number at which the second
/// factorisation is no longer proven to mend the first, 8 kappa sqrt(m d u + d (d + 1) u) <= 1, kappa by L1's Frobenius
/// norms; beyond it theta is left NaN, as someone who has to answer would go on with another QR. Source: Yamamoto,
/// Nakatsukasa, Yanagisawa & Fukaya 2015.
Vector<double> solve_cholesky_qr2(Matrix<double> const& A) {
    constexpr Index block = 256;
    Index const d = A.rows(), m = A.cols();
    Matrix<double> first = Matrix<double>::Zero(d, d), second = Matrix<double>::Zero(d, d), Q(d, block);
    add_squares(first, A.data(), m);
    Eigen::LLT<Eigen::Ref<Matrix<double>>> const one(first);
    Matrix<double> const L1 = one.matrixL();
    double const kappa = L1.norm() * L1.triangularView<Eigen::Lower>().solve(Matrix<double>::Identity(d, d)).norm();
    double const u = std::numeric_limits<double>::epsilon() / 2;
    if (one.info() != Eigen::Success || !(8 * kappa * std::sqrt(double(m * d + d * (d + 1)) * u) <= 1))
        return Vector<double>::Constant(d - 1, std::numeric_limits<double>::quiet_NaN());
    int const n = int(d);
    double const unit = 1;
    for (Index k = 0; k < m; k += block) {
        int const taken = int(std::min(block, m - k));
        Q.leftCols(taken) = A.middleCols(k, taken);
        dtrsm_("L", "L", "N", "N", &n, &taken, &unit, L1.data(), &n, Q.data(), &n, 1, 1, 1, 1);
        add_squares(second, Q.data(), taken);
    }
    Eigen::LLT<Eigen::Ref<Matrix<double>>> const two(second);
    Matrix<double> const L = L1 * Matrix<double>(two.matrixL());
    return L.topLeftCorner(d - 1, d - 1)
        .transpose()
        .triangularView<Eigen::Upper>()
        .solve(L.row(d - 1).head(d - 1).transpose());
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
    add_batch_rows(
        "peer/cholesky_qr2",
        [](Records const& records) {
            Matrix<double> A(records.parameters() + 1, records.rows());
            A << records.psi, records.y.transpose();
            return A;
        },
        solve_cholesky_qr2);
});

}  // namespace
}  // namespace rlslab::bench
