// The sparse variants where they matter: rows with a few numbers in a band, as many parameters as no dense form could
// hold.
#include "tests/common/laws.hpp"

#include <rlslab/variants/cholesky_sparse.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/qr_sparse.hpp>
#include <rlslab/variants/ud.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace rlslab {
namespace {

/// Rows of four numbers within nine neighbouring parameters, y = the sum over i of psi_i (1 + i % 7) + noise.
struct Banded {
    SparseRows psi;
    Vector<double> y;
    Banded(Index size, Index rows, Seed seed) : psi(size, rows), y(rows) {
        psi.reserve(Eigen::VectorXi::Constant(rows, 4));
        for (Index k = 0; k < rows; ++k) {
            Index const at = Index(seed.next() % std::uint64_t(size - 8));
            y[k] = seed.bell() / 8;
            for (Index i : {at, at + 3, at + 4, at + 8}) {
                psi.insert(i, k) = seed.bell();
                y[k] += psi.coeff(i, k) * double(1 + i % 7);
            }
        }
        psi.makeCompressed();
    }
};

double distance(Vector<double> const& a, Vector<double> const& b) {
    return (a - b).norm() / b.norm() / epsilon<double>();
}

/// In epsilons: five times what these well-conditioned rows leave between any two forms.
constexpr double budget = 400;

/// Every form solves the same problem, whether it is given the zeros or not.
TEST(Sparse, AgreesWithTheDenseFormsOnABand) {
    constexpr Index size = 60, rows = 512;
    Banded const data(size, rows, Seed{61});
    for (double lambda : {1.0, 0.999}) {
        Problem<double> const p{.size = size, .forgetting = lambda};
        CholeskySparse sparse_rows(p), dense_rows(p);
        QrSparse sparse_blocks(p), dense_blocks(p), one_by_one(p);
        Ud<double> ud(p);
        Qr<double> qr(p);
        for (Index k = 0; k < rows; ++k) {
            SparseRow const psi = column(data.psi, k);
            Vector<double> const dense = psi;
            Step<double> const step = sparse_rows.update(psi, data.y[k]),
                               as_dense = dense_rows.update(dense, data.y[k]);
            EXPECT_EQ(step.innovation, as_dense.innovation);
            EXPECT_EQ(step.gamma, as_dense.gamma);
            Step<double> const ud_step = ud.update(dense, data.y[k]);
            if (k >= 60) {  // before, the prior's 2^14 is in everything
                EXPECT_NEAR(step.gamma, ud_step.gamma, 1e-9);
                EXPECT_EQ(name_of(step.health), "sound");
            }
            qr.update(dense, data.y[k]);
            one_by_one.update(psi, data.y[k]);
        }
        sparse_blocks.update_block(data.psi, data.y);
        dense_blocks.update_block(Eigen::MatrixXd(data.psi), data.y);
        EXPECT_EQ(sparse_rows.theta(), dense_rows.theta()) << "what is not zero is all that is used";
        EXPECT_EQ(sparse_blocks.theta(), dense_blocks.theta());
        EXPECT_LE(distance(sparse_blocks.theta(), qr.theta()), budget) << lambda;
        EXPECT_LE(distance(one_by_one.theta(), qr.theta()), budget) << lambda;
        EXPECT_LE(distance(ud.theta(), qr.theta()), budget) << lambda;
        EXPECT_LE(distance(sparse_rows.theta(), qr.theta()), budget) << lambda;
        EXPECT_LE(distance(sparse_rows.gain(), qr.gain()), budget) << lambda;
        EXPECT_LE(distance(sparse_blocks.gain(), qr.gain()), budget) << lambda;
        Matrix<double> const X = qr.information();
        EXPECT_LE((sparse_rows.information() - X).norm(), budget * epsilon<double>() * X.norm());
        EXPECT_LE((sparse_blocks.information() - X).norm(), budget * epsilon<double>() * X.norm());
    }
}

/// Pages of this process that are in memory, in MB.
double resident() {
    double pages = 0, ignored = 0;
    std::ifstream("/proc/self/statm") >> ignored >> pages;
    return pages * double(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// A dense triangle of 20 000 parameters is 3.2 GB.
TEST(Sparse, TwentyThousandParametersFitInMemoryAndTime) {
    constexpr Index size = 20000, rows = 40000;
    [[maybe_unused]] double const before = resident();
    Banded const data(size, rows, Seed{62});
    Problem<double> const p{.size = size, .prior = Prior<double>{.variance = 1e6}};

    QrSparse qr(p);
    qr.update_block(data.psi, data.y);
    CholeskySparse cholesky(p);
    QrSparse some(p);
    for (Index k = 0; k < 500; ++k) EXPECT_EQ(name_of(cholesky.update(column(data.psi, k), data.y[k]).health), "sound");
    some.update_block(SparseRows(data.psi.leftCols(500)), data.y.head(500));

#ifndef RLSLAB_SANITIZED  // which keeps what is freed
    EXPECT_LE(resident() - before, 200) << "MB";
#endif
    EXPECT_LE(distance(cholesky.theta(), some.theta()), 1e8);  // 500 rows: the prior's 1e6, squared by one of them
    Vector<double> truth(size);
    for (Index i = 0; i < size; ++i) truth[i] = double(1 + i % 7);
    EXPECT_LE((qr.theta() - truth).norm() / truth.norm(), 0.1);  // two rows a parameter, noise of 1/8
    EXPECT_EQ(qr.gain().size(), size);
    EXPECT_EQ(cholesky.gain().size(), size);
}

/// SuiteSparseQR leaves out what is zero, the pivot too: then nothing is solved for, by whatever entry stands last in
/// the column.
TEST(QrSparse, APivotThatUnderflowedIsNotSound) {
    QrSparse f({.size = 2, .forgetting = 0x1p-1000});
    for (int k = 0; k < 8; ++k) {
        Step<double> const step =
            k < 4 ? f.update(Vector<double>{{1.0, 0.0}}, 1.0) : f.update(Vector<double>{{1.0, 1.0}}, 1.0);
        EXPECT_EQ(step.health == Health::sound, k < 2) << k << ' ' << name_of(step.health);
        EXPECT_EQ(f.theta().allFinite() && f.gain().allFinite(), k < 2) << k;
    }
}

}  // namespace
}  // namespace rlslab
