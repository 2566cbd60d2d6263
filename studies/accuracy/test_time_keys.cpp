// Keys, exact answers and stored answers of the layer; loops in order, so that no bit depends on the processor.
#include "studies/accuracy/test_time_layer.hpp"

#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/linalg/product.hpp>
#include <rlslab/linalg/triangles.hpp>
#include <rlslab/studies/spectra.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rlslab::studies {
using detail::product;
namespace {

constexpr double u = 0x1p-53;

double norm(Matrix<double> const& A) {
    double sum = 0;
    for (double const x : A.reshaped()) sum += x * x;
    return std::sqrt(sum);
}

/// L D L' of A + ridge I; pivots that are not positive stay.
struct Factored {
    StateMatrix<double> L;
    StateVector<double> D;
    bool positive;

    Factored(Matrix<double> const& A, double ridge) : L(A.rows()), D(A.rows()) {
        Matrix<double> shifted = A;
        for (Index i = 0; i < A.rows(); ++i) shifted(i, i) += ridge;
        positive = factor_ldl(shifted, L, D);
    }
    Matrix<double> solved(Matrix<double> const& Q) const {
        Matrix<double> X(Q.rows(), Q.cols());
        StateVector<double> x(Q.rows());
        for (Index c = 0; c < Q.cols(); ++c) {
            for (Index i = 0; i < Q.rows(); ++i) x[i] = Q(i, c);
            solve_ldl(L, D, true, x);
            for (Index i = 0; i < Q.rows(); ++i) X(i, c) = x[i];
        }
        return X;
    }
};

bool finite(Stored<double> const& s) {
    return std::isfinite(norm(s.F)) && std::all_of(s.D.begin(), s.D.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

double relative_error(Matrix<double> const& exact, Matrix<double> const& found, Index first, Index n) {
    double off = 0, size = 0;
    for (Index j = first; j < first + n; ++j)
        for (Index i = 0; i < exact.rows(); ++i) {
            double const apart = found(i, j) - exact(i, j);
            off += apart * apart, size += exact(i, j) * exact(i, j);
        }
    double const error = std::sqrt(off / size);
    return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

Layer::Layer(Index d, Index rows, double kappa, double gate_, double (*stored)(double), Seed seed)
    : gate(stored(gate_)), keys(d, rows), H(Matrix<double>::Zero(d, d)), G(Matrix<double>::Zero(channels, d)),
      Q(d, 2 * queries), error_of_H(3 * u * double(rows) * std::min(double(rows), 1 / (1 - gate))) {
    Matrix<double> const V = orthonormal(d, d, seed);
    std::vector<double> const sigma = singular_values("geometric", d, kappa);
    Matrix<double> W(channels, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < channels; ++i) W(i, j) = seed.bell();
    auto const drawn = [&](bool white) {
        Vector<double> k = Vector<double>::Zero(d);
        for (Index j = 0; j < d; ++j) {
            double const along = (white ? 1 : sigma[size_t(j)]) * seed.bell();
            for (Index i = 0; i < d; ++i) k[i] += along * V(i, j);
        }
        double size = 0;
        for (double const x : k) size += x * x;
        for (double& x : k) x = stored(round_to_nearest(x / std::sqrt(size), bfloat16));
        return k;
    };
    for (Index t = 0; t < rows; ++t) {
        Vector<double> const k = drawn(false);
        for (Index i = 0; i < channels; ++i) {
            double v = seed.bell();
            for (Index j = 0; j < d; ++j) v += W(i, j) * k[j];
            for (Index j = 0; j < d; ++j) G(i, j) = gate * G(i, j) + v * k[j];
        }
        for (Index j = 0; j < d; ++j) {
            keys(j, t) = k[j];
            for (Index i = 0; i < d; ++i) H(i, j) = gate * H(i, j) + k[i] * k[j];
        }
    }
    for (Index c = 0; c < Q.cols(); ++c) {
        Vector<double> const q = drawn(c < queries);
        for (Index i = 0; i < d; ++i) Q(i, c) = q[i];
    }
}

double Layer::faded_ridge() const {
    double out = ridge;
    for (Index t = 0; t < keys.cols(); ++t) out *= gate;
    return out;
}
double Layer::norm_of_H() const { return norm(H); }

Answers exact_answers(Layer const& layer, double ridge, double least) {
    Index const d = layer.H.rows();
    Factored const A(layer.H, ridge);
    Answers out{A.solved(layer.Q), A.positive};
    if (least == 0) least = 1 / norm(A.solved(Matrix<double>::Identity(d, d)));
    Matrix<double> const HX = product(layer.H, out.X);
    double const size = norm(layer.H) + ridge;
    for (Index c = 0; c < layer.Q.cols(); ++c) {
        double r = 0, x = 0, q = 0;
        for (Index i = 0; i < d; ++i) {
            double const rest = layer.Q(i, c) - HX(i, c) - ridge * out.X(i, c);
            r += rest * rest, x += out.X(i, c) * out.X(i, c), q += layer.Q(i, c) * layer.Q(i, c);
        }
        x = std::sqrt(x);
        double const rounding = double(d + 4) * u * (size * x + std::sqrt(q));
        out.bound = std::max(out.bound, (std::sqrt(r) + layer.error_of_H * x + rounding) / (least * x));
    }
    return out;
}

Answers answers_of(Stored<double> const& state, double ridge, Matrix<double> const& Q) {
    Index const d = state.F.rows();
    bool const plain = state.form == Stored<double>::Form::plain;
    if (!finite(state)) return {Matrix<double>::Constant(d, Q.cols(), INFINITY), false};
    bool definite = true;
    if (!plain)
        for (Index j = 0; j < d; ++j) definite = definite && (state.D.size() > 0 ? state.D[j] : state.F(j, j)) > 0;
    if (state.quantity == Stored<double>::Quantity::covariance) {
        if (plain) {
            Matrix<double> P = state.F;
            for (Index j = 0; j < d; ++j)
                for (Index i = 0; i <= j; ++i) P(j, i) = (state.F(i, j) + state.F(j, i)) / 2;
            definite = Factored(P, 0).positive;
        }
        Solver<double> const by(state, 0);
        Answers out = by.all(Q, [&](Vector<double> const& q) { return by.times(q, false); });
        out.definite = definite;
        return out;
    }
    Matrix<double> M = state.F;
    if (!plain) {
        for (Index j = 0; j < state.D.size(); ++j)
            for (Index i = 0; i < d; ++i) M(i, j) *= state.D[j];
        M = product(M, Matrix<double>(state.F.transpose()));
    }
    Factored const A(M, ridge);
    return {A.solved(Q), plain ? A.positive : definite};
}

}  // namespace rlslab::studies
