// Makes, copies, moves and destroys every type that owns memory and passes between an app and the compiled core. The
// app may be compiled for another instruction set than the core: what Eigen then allocates on one side, it could not
// free on the other.
#include <rlslab/model/difference.hpp>
#include <rlslab/model/excitation.hpp>
#include <rlslab/model/fit.hpp>
#include <rlslab/model/regression.hpp>
#include <rlslab/input/row_file.hpp>
#include <rlslab/reference/certified.hpp>
#include <rlslab/reference/definiteness.hpp>

#include <Eigen/LU>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace {

using namespace rlslab;

void expect(bool holds, char const* what) {
    if (holds) return;
    std::fprintf(stderr, "%s\n", what);
    std::exit(1);
}

/// A copy, an assignment over numbers of another size, and a move; what is left is destroyed here.
template <class T>
T passed_on(T value) {
    T copy = value;
    T assigned = std::move(copy);
    assigned = value;
    std::swap(assigned, value);
    return assigned;
}

void records_and_fits() {
    for (Index rows : {Index(40), Index(41), Index(64), Index(999)}) {
        Signal const u = white_noise(rows, Seed{1});
        Signal const y = simulate({.a = {-1.5, 0.7}, .b = {{1, 0.5}}}, {u}, Signal(size_t(rows), 0.0));
        Signal gaps = y;
        gaps[20] = std::nan("");
        Records records = passed_on(arx_records(u, y, {.na = 2, .nb = 1}));
        expect(records.rows() == rows - 2, "as many records as rows with a history");
        records = arx_records(u, gaps, {.na = 2, .nb = 1});  // rows are left out: made smaller in the core
        expect(records.skipped == 3, "three rows without a missing value");
        records.psi.conservativeResize(Eigen::NoChange, 30);  // and resized here
        records.y.conservativeResize(30);
        for (FitBy by : {FitBy::normal_equations, FitBy::qr, FitBy::svd}) {
            Fit fitted = passed_on(fit(records, by));
            expect(std::abs(fitted.theta[0] + 1.5) < 1e-9, "the model that made the record");
            fitted = fit(arx_records(u, y, {.na = 3, .nb = 3}), by);
        }
        passed_on(poles(DifferenceEquation::of({.na = 2, .nb = 1}, fit(records).theta)));
        passed_on(correlation_matrix(u, 5));
        expect(passed_on(excitation(u, 4)).order == 4, "noise is exciting");
    }
}

void exact_solutions() {
    Signal const u = white_noise(100, Seed{2});
    Records const records = arx_records(u, simulate({.a = {0.5}, .b = {{1}}}, {u}, u), {.na = 1, .nb = 2});
    Problem<double> problem{.size = 4, .forgetting = 0.99};
    problem.prior->theta = Vector<double>::Ones(4);
    problem.prior->covariance = 4 * Matrix<double>::Identity(4, 4);
    for (CertifiedSolution const& exact : passed_on(certified(passed_on(problem), records, {50, 98}))) {
        Vector<Reference> theta = passed_on(exact.theta());
        Matrix<Reference> P = passed_on(exact.covariance());
        expect(exact.theta_digits(theta) > 30 && passed_on(exact.theta_strings()).size() == 4, "its own solution");
        Stored<Reference> stored =
            passed_on(Stored<Reference>{Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain, P});
        expect(exact.covariance_digits(stored) > 30 && definiteness(stored) == Health::sound, "its own covariance");
        theta.conservativeResize(9);
    }
}

/// The app's own Eigen code beside it. Of a function that both sides compile, the linker keeps one.
void eigens_own() {
    for (int n : {3, 8, 50}) {
        Eigen::MatrixXd A = Eigen::MatrixXd::Random(n, n);
        expect(passed_on(A).partialPivLu().matrixLU().rows() == n, "a factorisation of its size");
        A.resize(n + 1, n);
        expect((A.setOnes() * Eigen::MatrixXd::Ones(n, n))(0, 0) == n, "a product");
        expect(roots(std::vector<double>(size_t(n), 0.5)).size() == size_t(n), "as many roots as the degree");
    }
}

}  // namespace

int main() {
    eigens_own();
    records_and_fits();
    exact_solutions();
    eigens_own();
    std::puts("every owner was destroyed");
}
