// The bounds of the half-power law (docs/theory.md 129) over rows, and rows to try them on. In Quad: Eigen sums
// doubles in an order, and with fused products, of the instruction set.
#pragma once

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/matrices.hpp>
#include <rlslab/core/random.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace rlslab::studies {

using Quads = Eigen::Matrix<Quad, Eigen::Dynamic, Eigen::Dynamic>;

inline Vector<double> spectrum_of(Quads const& A) {
    return Eigen::SelfAdjointEigenSolver<Quads>(A, Eigen::EigenvaluesOnly).eigenvalues().cast<double>();
}

/// Columns are rows, in numbers of float. basis: "rotated", "units" (a geometric spectrum), "line" (an autoregression),
/// "start" (columns that stand near 1 for half of the rows).
inline Matrix<double> half_power_rows(std::string_view basis, Index d, double kappa, Index count, Seed& seed) {
    Quads turn(d, d);
    for (Quad& x : turn.reshaped()) x = seed.bell();
    turn = Eigen::HouseholderQR<Quads>(turn).householderQ();
    Matrix<double> out(d, count);
    Eigen::VectorXd line = Eigen::VectorXd::Zero(d), row(d);
    for (Index k = 0; k < count; ++k) {
        for (Index i = 0; i < d; ++i) row[i] = seed.bell() * correctly::pow(kappa, -double(i) / double(d - 1));
        if (basis == "rotated") row = (turn * row.cast<Quad>()).cast<double>().eval();
        if (basis == "start")
            for (double& x : row) x = 1 + seed.bell() / (2 * k < count ? kappa : 1);
        if (basis == "line") {
            for (Index i = d - 1; i > 0; --i) line[i] = line[i - 1];
            line[0] = (1 - 2 / kappa) * line[1] + seed.bell() / std::sqrt(kappa);
            row = line;
        }
        for (Index i = 0; i < d; ++i) out(i, k) = float(row[i]);
    }
    return out;
}

/// Over u: sum tau mu^-1/2, sum tau / (mu gamma), and the bounds of four forms.
struct HalfPowerLaw {
    double half = 0, whole = 0, ud = 0, ud_delta = 0, symmetric = 0, joseph = 0;
    Quads root;  // L of P_N^-1 = LL'

    HalfPowerLaw(Matrix<double> const& rows, double lambda, double c2) {
        Index const d = rows.rows();
        std::vector<Quads> M{Quads::Identity(d, d) / Quad(c2)};
        std::vector<double> mu{1}, gamma{1};
        Quads P = Quads::Identity(d, d) * Quad(c2);
        for (Index k = 0; k < rows.cols(); ++k) {
            Vector<Quad> const psi = rows.col(k).cast<Quad>();
            gamma.push_back(double(lambda / (lambda + psi.dot(P * psi))));
            M.push_back(Quad(lambda) * M.back() + psi * psi.transpose());
            P = M.back().llt().solve(Quads::Identity(d, d));
            P = (P + P.transpose()).eval() / Quad(2);
            Vector<Quad> const a = P.diagonal().cwiseSqrt().cwiseInverse();
            mu.push_back(std::max(1e-15, spectrum_of(a.asDiagonal() * P * a.asDiagonal())[0]));
        }
        root = M.back().llt().matrixL();
        Quads const of_P = P.llt().matrixL();
        double const D = double(d), r = lambda == 1 ? 0 : 2, sweep = 2 * std::sqrt(D) * (4 * D + 7);
        for (size_t k = 0; k < M.size(); ++k) {
            double const tau = std::min(1.0, correctly::pow(lambda, double(M.size() - 1 - k)) *
                                                 spectrum_of(of_P.transpose() * M[k] * of_P)[d - 1]);
            half += tau / std::sqrt(mu[k]);
            ud += (sweep + D + 7 + r) * tau / std::sqrt(mu[k] * gamma[k]);
            ud_delta += (sweep + 4 * D + 16) * tau / std::sqrt(mu[k] * gamma[k]);
            if (k == 0) continue;
            double const full = tau / (mu[k] * gamma[k]), gone = 1 - gamma[k],
                         reach = 1 + gone * std::sqrt(D / mu[k - 1]);
            whole += full;
            symmetric += D * full * (4 + 2 * r + (4 * D + 1) * gone);
            joseph += D * full * ((2 * D + 5 + r) * reach * reach + 2 * gamma[k] * gone);
        }
    }

    /// How far P is from P_N in the metric of P_N.
    double eta(Matrix<double> const& Phat) const {
        Quads const P = (Phat.cast<Quad>() + Phat.transpose().cast<Quad>()) / Quad(2);
        return spectrum_of(root.transpose() * P * root - Quads::Identity(P.rows(), P.cols())).cwiseAbs().maxCoeff();
    }
};

}  // namespace rlslab::studies
