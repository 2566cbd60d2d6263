// Sums are loops in order: Eigen's reductions depend on the instruction set, and data must not.
#include <rlslab/studies/scenarios.hpp>

#include <rlslab/studies/spectra.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/variants/kalman.hpp>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace rlslab::studies {

namespace {

using Quantity = Stored<double>::Quantity;
using Form = Stored<double>::Form;

/// Those that take rows one by one and of which this holds, in the order of the list. Without the delta forms, which
/// the study `delta_forms` compares with their originals: the verdicts of the other studies are of these.
std::vector<Cell> forms(bool (*holds)(VariantForm const&)) {
    std::vector<Cell> out;
    for (VariantForm const& f : variant_forms())
        if (f.single_rows && holds(f) && f.variant != Kalman<double>::name && !f.variant.ends_with("_delta"))
            out.emplace_back(std::string(f.variant));
    return out;
}

}  // namespace

std::vector<Cell> covariance_forms() {
    return forms([](VariantForm const& f) { return f.quantity == Quantity::covariance && f.form == Form::plain; });
}
std::vector<Cell> factor_forms() {
    return forms([](VariantForm const& f) { return f.form == Form::factor; });
}
std::vector<Cell> triangular_forms() {
    return forms([](VariantForm const& f) { return f.form == Form::factor && f.triangle; });
}
std::vector<Cell> corrected_forms() {
    std::vector<Cell> const factors =
        forms([](VariantForm const& f) { return f.quantity == Quantity::covariance && f.form == Form::factor; });
    return joined(without(covariance_forms(), {"conventional"}), without(factors, {"extended_qr"}));  // it adds eta v
}
std::vector<Cell> row_forms() {
    return joined(joined(covariance_forms(), factor_forms()), forms([](VariantForm const& f) {
                      return f.quantity == Quantity::information && f.form == Form::plain;
                  }));
}

std::vector<Cell> gain_forms() {
    std::vector<Cell> const factors =
        forms([](VariantForm const& f) { return f.form == Form::factor && find_entry(f.variant)->gain_perturbable; });
    return joined(joined(covariance_forms(), {std::string(Kalman<double>::name)}), factors);
}

std::vector<Cell> joined(std::vector<Cell> a, std::vector<Cell> const& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::vector<Cell> without(std::vector<Cell> a, std::vector<Cell> const& b) {
    std::erase_if(a, [&](Cell const& x) { return std::ranges::count(b, x) > 0; });
    return a;
}
std::vector<std::string> words(std::vector<Cell> const& cells) {
    std::vector<std::string> out;
    for (Cell const& cell : cells) out.push_back(std::get<std::string>(cell));
    return out;
}

std::vector<Cell> powers(double base, double first, double last, double step) {
    std::vector<Cell> out;
    int const n = int(std::floor(std::abs(last - first) / std::abs(step) + 0.5));
    for (int i = 0; i <= n; ++i)
        out.emplace_back(correctly::pow(base, first + i * (last < first ? -std::abs(step) : std::abs(step))));
    return out;
}

std::vector<Cell> counted(int n) {
    std::vector<Cell> out;
    for (int i = 1; i <= n; ++i) out.emplace_back(double(i));
    return out;
}

Records white(Index size, Index rows, Seed seed, double noise) {
    Matrix<double> psi(size, rows);
    for (Index k = 0; k < rows; ++k)
        for (Index i = 0; i < size; ++i) psi(i, k) = seed.bell();
    return answered(std::move(psi), seed, noise);
}

Records delay_line(Index size, Index rows, double pole, Seed seed, double noise) {
    double const drive = std::sqrt(1 - pole * pole);
    double x = seed.bell();  // of the stationary variance at once
    std::vector<double> line(size_t(size + rows));
    for (double& tap : line) tap = x = pole * x + drive * seed.bell();
    Matrix<double> psi(size, rows);
    for (Index k = 0; k < rows; ++k)
        for (Index i = 0; i < size; ++i) psi(i, k) = line[size_t(size + k - i)];
    return answered(std::move(psi), seed, noise);
}

Records graded(Index size, Index rows, double kappa, Seed seed, double noise) {
    return with_singular_values(singular_values("geometric", size, kappa), rows, seed, noise);
}

Errors errors(AnyFilter const& filter, CertifiedSolution const& exact) {
    return {error_of(exact.theta_digits(filter.theta())), error_of(exact.covariance_digits(filter.stored()))};
}
double error_of(double digits) { return digits == digits ? correctly::pow(10, -digits) : INFINITY; }

void process_rows(AnyFilter& filter, Records const& records, Index first, Index last) {
    filter.update_block(records, first, last);
}

Matrix<Reference> covariance_of(Stored<Reference> const& stored) {
    return covariance_of(stored, [](Matrix<Reference> const& X) {
        return X.householderQr().solve(Matrix<Reference>::Identity(X.rows(), X.cols())).eval();
    });
}

InDouble::InDouble(Problem<double> const& problem)
    : lambda(problem.forgetting), P(problem.prior->variance * Matrix<double>::Identity(problem.size, problem.size)),
      M(Matrix<double>::Identity(problem.size, problem.size) / problem.prior->variance),
      theta(Vector<double>::Zero(problem.size)), f(theta) {}
void InDouble::take(Records const& records, Index k) {
    Index const d = theta.size();
    double s = lambda, e = records.y[k];
    for (Index i = 0; i < d; ++i) {
        f[i] = 0;
        for (Index j = 0; j < d; ++j) f[i] += P(i, j) * records.psi(j, k);
        s += records.psi(i, k) * f[i];
        e -= records.psi(i, k) * theta[i];
    }
    for (Index i = 0; i < d; ++i) {
        theta[i] += f[i] / s * e;
        for (Index j = 0; j <= i; ++j) {
            P(i, j) = P(j, i) = (P(i, j) - f[i] * f[j] / s) / lambda;
            M(i, j) = M(j, i) = lambda * M(i, j) + records.psi(i, k) * records.psi(j, k);
        }
    }
}
double largest_eigenvalue(Matrix<double> const& A, int steps) {
    Index const d = A.rows();
    std::vector<double> x(size_t(d), 1.0), y(x);
    x[0] = 1.25;  // not orthogonal to the eigenvector by symmetry
    double value = 0;
    for (int n = 0; n < steps; ++n) {
        double squares = 0, along = 0;
        for (Index i = 0; i < d; ++i) {
            y[size_t(i)] = 0;
            for (Index j = 0; j < d; ++j) y[size_t(i)] += A(i, j) * x[size_t(j)];
            squares += x[size_t(i)] * x[size_t(i)];
            along += x[size_t(i)] * y[size_t(i)];
        }
        value = along / squares;
        double const length = std::sqrt(squares) * value;
        for (Index i = 0; i < d; ++i) x[size_t(i)] = y[size_t(i)] / length;
    }
    return value;
}

double frobenius(Matrix<Reference> const& A) {
    Reference sum = 0;
    for (Reference const& x : A.reshaped()) sum += x * x;
    return static_cast<double>(sqrt(sum));
}

// --- spectra.hpp -----------------------------------------------------------------------------------------------------

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
    Records out{.psi = std::move(psi), .y = Vector<double>(rows)};
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
