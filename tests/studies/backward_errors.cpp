// Backward errors of theta and P: against the eigenvalue and the trace formula, against changes of the data, and broken
// on purpose.
#include <rlslab/studies/backward_errors.hpp>

#include <rlslab/studies/scenarios.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <gtest/gtest.h>

namespace rlslab {
using namespace studies;
namespace {

using Numbers = Matrix<Reference>;
using Plain = Eigen::Matrix<Reference, Dynamic, Dynamic>;
constexpr Index size = 3, rows = 9;
constexpr double variance = 64;

Records data_of(std::uint64_t seed) { return graded(size, rows, 50, Seed{seed}, 0.1); }
Problem<double> problem() { return {.size = size, .prior = Prior<double>{.variance = variance}}; }

/// A and b, the prior's rows last; each column of A divided by its length.
struct Rows {
    Numbers A = Numbers::Zero(rows + size, size);
    Vector<Reference> b = Vector<Reference>::Zero(rows + size), lengths{size};
    explicit Rows(Records const& data, bool with_prior = true) {
        for (Index k = 0; k < rows; ++k) {
            for (Index i = 0; i < size; ++i) A(k, i) = data.psi(i, k);
            b[k] = data.y[k];
        }
        for (Index i = 0; i < size && with_prior; ++i) A(rows + i, i) = 1 / sqrt(Reference(variance));
        for (Index i = 0; i < size; ++i) {
            lengths[i] = sqrt(Reference(A.col(i).squaredNorm()));
            A.col(i) /= lengths[i];
        }
    }
    Vector<Reference> solution() const { return Numbers(A.transpose() * A).inverse() * (A.transpose() * b); }
};

/// sqrt(phi^2 + min(0, lambda_min(A A' - tau r r')))/|A|_F of the scaled x.
double by_eigenvalues(Rows const& given, Vector<Reference> const& x) {
    Vector<Reference> const r = given.b - given.A * x;
    Reference const tau = Reference(1) / x.squaredNorm();
    Plain const G = given.A * given.A.transpose() - tau * (r * r.transpose());
    Reference const least = Eigen::SelfAdjointEigenSolver<Plain>(G, Eigen::EigenvaluesOnly).eigenvalues()[0];
    return static_cast<double>(
        Reference(sqrt(Reference(tau * r.squaredNorm() + (least < 0 ? least : Reference(0)))) / given.A.norm()));
}
Numbers noise(Index n, Index d, Seed& seed, double scale) {
    Numbers out(n, d);
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < n; ++i) out(i, j) = scale * seed.bell();
    return out;
}
Stored<Reference> as_covariance(Numbers P) {
    return {Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain, std::move(P)};
}
/// P of scaled columns in the data's units.
Numbers in_units(Numbers P, Vector<Reference> const& lengths) {
    for (Index j = 0; j < size; ++j)
        for (Index i = 0; i < size; ++i) P(i, j) /= lengths[i] * lengths[j];
    return P;
}
Numbers inverse(Numbers const& X) { return X.inverse(); }

// From near the exact theta to where it explains nothing.
TEST(BackwardErrors, OfThetaEqualTheEigenvalueFormula) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Records const data = data_of(seed);
        Rows const given(data);
        GivenProblem const exact(problem(), data);
        Seed errors{seed + 100};
        for (double const scale : {1e-12, 1e-6, 1e-2, 1.0, 30.0}) {
            Vector<Reference> const theta = exact.theta() + noise(size, 1, errors, scale);
            double const expected = by_eigenvalues(given, theta.cwiseProduct(given.lengths));
            EXPECT_NEAR(exact.theta_backward_error(theta) / expected, 1, 1e-8)
                << "seed " << seed << ", scale " << scale;
        }
    }
}

// The least change is no greater than any that has the same answer, and for a change of theta's or P's own kind not far
// below it.
TEST(BackwardErrors, NoChangeThatExplainsTheAnswerIsSmaller) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        Records const data = data_of(seed);
        GivenProblem const exact(problem(), data);
        Rows const given(data);
        Seed errors{seed + 200};
        for (double const scale : {1e-15, 1e-6, 1e-2, 0.3}) {
            Rows changed = given;
            Numbers const dA = noise(rows + size, size, errors, scale);
            changed.A += dA;
            double const change = static_cast<double>(Reference(dA.norm() / given.A.norm()));
            double const of_theta = exact.theta_backward_error(changed.solution().cwiseQuotient(given.lengths));
            double const of_P = exact.covariance_backward_error(
                as_covariance(in_units(inverse(changed.A.transpose() * changed.A), given.lengths)));
            EXPECT_LE(of_theta, change * (1 + 1e-12));
            EXPECT_LE(of_P, change * (1 + 1e-12));
            EXPECT_GT(of_P, change / 10) << "seed " << seed << ", scale " << scale;
        }
    }
}

TEST(BackwardErrors, OfPEqualTheTraceFormula) {
    Seed seed{7};
    GivenProblem const exact(problem(), data_of(7));
    for (double const scale : {1e-16, 1e-8, 1e-2, 1.0}) {
        Numbers const other = exact.R() + noise(size, size, seed, scale);
        Procrustes const best(exact.R(), other);
        Numbers const product = exact.R() * other.transpose();
        Plain const G = product.transpose() * product;
        auto const squares = Eigen::SelfAdjointEigenSolver<Plain>(G, Eigen::EigenvaluesOnly).eigenvalues();
        Reference traces = exact.R().squaredNorm() + other.squaredNorm();
        for (Index i = 0; i < size; ++i) traces -= 2 * sqrt(squares[i]);
        EXPECT_NEAR(static_cast<double>(Reference(best.distance / sqrt(traces))), 1, 1e-10) << scale;
        EXPECT_LT(Numbers(best.Q.transpose() * best.Q - Numbers::Identity(size, size)).norm(), 1e-70);
        for (int i = 0; i < 100; ++i) {  // no other orthogonal matrix comes nearer
            Numbers const Q = Plain(noise(size, size, seed, 1)).householderQr().householderQ();
            EXPECT_GE(Numbers(exact.R() - Q * other).norm(), best.distance);
        }
    }
}

TEST(BackwardErrors, OfPAreTheFirstOrderFormula) {
    for (std::uint64_t s = 1; s <= 10; ++s) {
        Seed seed{s};
        Records const data = data_of(s);
        GivenProblem const exact(problem(), data);
        Numbers E = noise(size, size, seed, 1e-20);
        E = (E + E.transpose()).eval();
        Eigen::SelfAdjointEigenSolver<Plain> const eigen((Plain(exact.M())));
        Numbers const in_basis = eigen.eigenvectors().transpose() * E * eigen.eigenvectors();
        Reference sum = 0;
        for (Index j = 0; j < size; ++j)
            for (Index i = 0; i < size; ++i)
                sum += in_basis(i, j) * in_basis(i, j) / (eigen.eigenvalues()[i] + eigen.eigenvalues()[j]) / 2;
        Numbers const P = in_units(inverse(exact.M() + E), Rows(data).lengths);
        double const expected = static_cast<double>(Reference(sqrt(Reference(sum / exact.M().trace()))));
        EXPECT_NEAR(exact.covariance_backward_error(as_covariance(P)) / expected, 1, 1e-12);
    }
}

// The exact answer has none; and what counts is P, not the form in which it is stored.
TEST(BackwardErrors, DependOnTheAnswerAlone) {
    GivenProblem const exact(problem(), data_of(3));
    EXPECT_LT(exact.theta_backward_error(exact.theta()), 1e-70);
    EXPECT_LT(exact.covariance_backward_error(as_covariance(exact.covariance())), 1e-70);
    Seed seed{3};
    Numbers const F = noise(size, size, seed, 1);
    Vector<Reference> D(size);
    D << 1, 4, 0.25;
    using S = Stored<Reference>;
    S const factors{S::Quantity::covariance, S::Form::factor, F, D};
    Numbers const P = multiplied_out(factors);
    double const expected = exact.covariance_backward_error(factors);
    EXPECT_NEAR(exact.covariance_backward_error(as_covariance(P)) / expected, 1, 1e-14);
    EXPECT_NEAR(exact.covariance_backward_error({S::Quantity::information, S::Form::plain, inverse(P)}) / expected, 1,
                1e-14);
}

TEST(BackwardErrors, DoNotDependOnTheUnitsOfTheColumns) {
    Records data = data_of(5);
    Problem<double> const no_prior{.size = size, .prior = std::nullopt};
    GivenProblem const before(no_prior, data);
    Numbers const P = before.covariance() * Reference(1.001);
    Vector<Reference> const theta = before.theta() * Reference(1.001), unit = before.theta();
    double const of_P = before.covariance_backward_error(as_covariance(P)),
                 of_theta = before.theta_backward_error(theta);
    double const scales[] = {0x1p-500, 1, 0x1p300};
    Numbers scaled_P = P;
    Vector<Reference> scaled_theta = theta;
    for (Index i = 0; i < size; ++i) {
        data.psi.row(i) *= scales[i];
        scaled_theta[i] /= scales[i];
        for (Index j = 0; j < size; ++j) scaled_P(i, j) /= Reference(scales[i]) * scales[j];
    }
    GivenProblem const after(no_prior, data);
    EXPECT_DOUBLE_EQ(after.covariance_backward_error(as_covariance(scaled_P)), of_P);
    EXPECT_DOUBLE_EQ(after.theta_backward_error(scaled_theta), of_theta);
}

TEST(BackwardErrors, AreInfiniteForAnAnswerOfNoProblem) {
    GivenProblem const exact(problem(), data_of(1));
    Numbers indefinite = Numbers::Identity(size, size);
    indefinite(1, 1) = -1;
    EXPECT_EQ(exact.covariance_backward_error(as_covariance(indefinite)), INFINITY);
    indefinite(1, 1) = std::nan("");
    EXPECT_EQ(exact.covariance_backward_error(as_covariance(indefinite)), INFINITY);
    EXPECT_EQ(exact.covariance_error(as_covariance(indefinite)), INFINITY);
    EXPECT_EQ(exact.theta_backward_error(Vector<Reference>::Constant(size, Reference(NAN))), INFINITY);
    EXPECT_THROW((void)exact.theta_backward_error(Vector<Reference>::Zero(size + 1)), std::invalid_argument);
    EXPECT_THROW((void)exact.covariance_backward_error(as_covariance(Numbers::Identity(2, 2))), std::invalid_argument);
    EXPECT_THROW(GivenProblem({.size = size + 1}, data_of(1)), std::invalid_argument);
    EXPECT_THROW(GivenProblem({.size = 0}, Records{}), std::invalid_argument);
    Records rank_two = data_of(1);
    rank_two.psi.row(1) = rank_two.psi.row(0);
    EXPECT_THROW(GivenProblem({.size = size, .prior = std::nullopt}, rank_two), std::invalid_argument);
    // theta = 0 is exact once b is orthogonal to all columns.
    Rows const given(data_of(1));
    double const expected =
        static_cast<double>(Reference((given.A.transpose() * given.b).norm() / given.b.norm() / given.A.norm()));
    EXPECT_NEAR(exact.theta_backward_error(Vector<Reference>::Zero(size)) / expected, 1, 1e-12);
}

// What each of the tests above would miss it must not: no prior's rows, one step of the series, no rotation.
TEST(BackwardErrors, CanFail) {
    Records const data = data_of(2);
    GivenProblem const exact(problem(), data), without_prior({.size = size, .prior = std::nullopt}, data);
    Rows const given(data);
    Vector<Reference> const theta = exact.theta() * Reference(0.25);
    double const expected = by_eigenvalues(given, theta.cwiseProduct(given.lengths)),
                 right = exact.theta_backward_error(theta);
    EXPECT_NEAR(right / expected, 1, 1e-8);
    EXPECT_GT(std::abs(without_prior.theta_backward_error(theta) / expected - 1), 1e-4);
    EXPECT_GT(std::abs(by_eigenvalues(Rows(data, false), theta.cwiseProduct(given.lengths)) / right - 1), 1e-4);
    {  // one step is the estimate of Karlson and Walden
        Vector<Reference> const x = theta.cwiseProduct(given.lengths), r = given.b - given.A * x,
                                g = given.A.transpose() * r;
        Numbers const H =
            given.A.transpose() * given.A * x.squaredNorm() + Numbers::Identity(size, size) * r.squaredNorm();
        double const estimate = static_cast<double>(Reference(sqrt(Reference(g.dot(inverse(H) * g))) / given.A.norm()));
        EXPECT_GT(right / estimate, 1.001);
        EXPECT_LT(right / estimate, std::sqrt(2.0));
    }
    Seed seed{2};
    Numbers const Q = Plain(noise(size, size, seed, 1)).householderQr().householderQ();
    EXPECT_LT(Procrustes(exact.R(), Q * exact.R()).distance, 1e-70);
    EXPECT_GT(Numbers(exact.R() - Q * exact.R()).norm(), 0.1);  // the same P, and a distance where none is
}

}  // namespace
}  // namespace rlslab
