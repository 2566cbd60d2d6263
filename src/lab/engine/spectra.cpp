// Sums are loops in order: Eigen's reductions depend on the instruction set, and data must not.
#include <rlslab/studies/spectra.hpp>

#include <rlslab/arithmetic/elementary.hpp>

#include <cmath>

namespace rlslab::studies {

Matrix<double> orthonormal(Index size, Index n, Seed& seed) {
    Matrix<double> Q(size, n);
    auto const dot = [&](Index a, Index b) {
        double sum = 0;
        for (Index i = 0; i < size; ++i) sum += Q(i, a) * Q(i, b);
        return sum;
    };
    for (Index j = 0; j < n; ++j) {
        for (Index i = 0; i < size; ++i) Q(i, j) = seed.bell();
        for (int twice = 0; twice < 2; ++twice)
            for (Index k = 0; k < j; ++k) {
                double const c = dot(k, j);
                for (Index i = 0; i < size; ++i) Q(i, j) -= c * Q(i, k);
            }
        double const length = std::sqrt(dot(j, j));
        for (Index i = 0; i < size; ++i) Q(i, j) /= length;
    }
    return Q;
}

std::vector<double> singular_values(std::string_view shape, Index size, double kappa) {
    std::vector<double> out;
    for (Index j = 0; j < size; ++j) {
        if (shape == "one small") out.push_back(j + 1 < size ? 1 : 1 / kappa);
        else if (shape == "one large") out.push_back(j == 0 ? 1 : 1 / kappa);
        else out.push_back(size > 1 ? correctly::pow(kappa, -double(j) / double(size - 1)) : 1);
    }
    return out;
}

Records answered(Matrix<double> psi, Seed seed, double noise) {
    Vector<double> const ones = Vector<double>::Ones(psi.rows());
    return answered(std::move(psi), ones, seed, noise);
}

Records answered(Matrix<double> psi, Vector<double> const& theta, Seed seed, double noise) {
    Index const rows = psi.cols();
    Records out{.psi = std::move(psi), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        double sum = 0;
        for (Index i = 0; i < out.psi.rows(); ++i) sum += theta[i] * out.psi(i, k);
        out.y[k] = sum + noise * seed.bell();
    }
    return out;
}

SingularRows rows_of_singular_values(std::vector<double> const& sigma, Index rows, Seed& seed, bool rotated) {
    Index const size = Index(sigma.size());
    Matrix<double> const U = orthonormal(rows, size, seed);
    SingularRows out{Matrix<double>::Zero(size, rows), Matrix<double>::Identity(size, size)};
    if (rotated) out.V = orthonormal(size, size, seed);
    for (Index j = 0; j < size; ++j)
        for (Index k = 0; k < rows; ++k)
            for (Index i = 0; i < size; ++i) out.psi(i, k) += U(k, j) * sigma[size_t(j)] * out.V(i, j);
    return out;
}

Records with_singular_values(std::vector<double> const& sigma, Index rows, Seed seed, double noise) {
    Matrix<double> psi = rows_of_singular_values(sigma, rows, seed, true).psi;
    return answered(std::move(psi), seed, noise);
}

}  // namespace rlslab::studies
