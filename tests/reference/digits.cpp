// How many digits of an estimate are right: against errors put there on purpose, through every stored form.
#include <rlslab/reference/certified.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace rlslab {
namespace {

using Quantity = Stored<Reference>::Quantity;
using Form = Stored<Reference>::Form;
constexpr double inf = std::numeric_limits<double>::infinity();

/// Three parameters, integers throughout:  M = Psi Psi' = [[2,1,0],[1,3,1],[0,1,2]],  det M = 8,  theta = (3, -4, 12).
Records integers() {
    Records data{.psi = Eigen::MatrixXd(3, 5), .y = {}, .names = {}};
    data.psi << 1, 1, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 1, 1;
    data.y = data.psi.transpose() * (Vector<double>(3) << 3, -4, 12).finished();
    return data;
}
CertifiedSolution solution(int digits = 30) {
    return certified({.size = 3, .prior = std::nullopt}, integers(), {5}, digits).front();
}

Vector<Reference> theta(double a, double b, double c) {
    Vector<Reference> x(3);
    x << Reference(a), Reference(b), Reference(c);
    return x;
}

/// P = M^-1 = [[5,-2,1],[-2,4,-2],[1,-2,5]] / 8
Matrix<Reference> covariance() {
    Matrix<Reference> P(3, 3);
    P << 5, -2, 1, -2, 4, -2, 1, -2, 5;
    return P / Reference(8);
}
Matrix<Reference> information() {
    Matrix<Reference> M(3, 3);
    M << 2, 1, 0, 1, 3, 1, 0, 1, 2;
    return M;
}

double digits_of(Quantity quantity, Form form, Matrix<Reference> F, Vector<Reference> D = {}, int asked = 30) {
    return solution(asked).covariance_digits({quantity, form, std::move(F), std::move(D)});
}

TEST(ThetaDigits, AreMinusLogOfTheRelativeError) {
    CertifiedSolution const exact = solution();
    EXPECT_EQ(exact.theta_strings(3), (std::vector<std::string>{"3.00e0", "-4.00e0", "1.20e1"}));
    // ||(3, -4, 12)|| = 13
    EXPECT_NEAR(exact.theta_digits(theta(3, -4, 12 + 13e-7)), 7, 1e-8);
    EXPECT_NEAR(exact.theta_digits(theta(3.3, -3.6, 12)), -std::log10(0.5 / 13), 1e-8);
    EXPECT_NEAR(exact.theta_digits(theta(0, 0, 0)), 0, 1e-9);
    EXPECT_NEAR(exact.theta_digits(theta(1.3e101, 0, 0)), -100, 1e-8);
    EXPECT_NEAR(exact.theta_digits_worst(theta(3, -4 + 4e-5, 12 + 12e-7)), 5, 1e-8);
    EXPECT_NEAR(exact.theta_digits_worst(theta(3 + 3e-9, -4, 12)), 9, 1e-7);
}

TEST(ThetaDigits, SeeAsFarAsTheyWereAsked) {
    Vector<Reference> close = theta(3, -4, 12);
    EXPECT_GE(solution().theta_digits(close), 30);
    EXPECT_GE(solution().theta_digits_worst(close), 30);
    close(0) += ldexp(Reference(3), -250);  // -log10(3/13 2^-250)
    double const truth = 250 * std::log10(2.0) - std::log10(3.0 / 13);
    EXPECT_NEAR(solution(90).theta_digits(close), truth, 1e-8);
    EXPECT_NEAR(solution(90).theta_digits_worst(close), 250 * std::log10(2.0), 1e-8);
    EXPECT_LE(solution(40).theta_digits(close), truth) << "proven, so never more than there are";
}

TEST(ThetaDigits, AtTheEdges) {
    CertifiedSolution const exact = solution();
    EXPECT_TRUE(std::isnan(exact.theta_digits(theta(3, inf, 12))));
    EXPECT_TRUE(std::isnan(exact.theta_digits_worst(theta(std::nan(""), -4, 12))));
    EXPECT_THROW(exact.theta_digits(Vector<Reference>::Zero(2)), std::invalid_argument);
    Records none = integers();
    none.y.setZero();
    CertifiedSolution const zero = certified({.size = 3}, none, {5}).front();
    EXPECT_EQ(zero.theta_digits(theta(0, 0, 0)), inf);
    EXPECT_EQ(zero.theta_digits_worst(theta(0, 0, 0)), inf);
    EXPECT_EQ(zero.theta_digits(theta(0, 1e-9, 0)), -inf);
    EXPECT_NEAR(zero.theta_digits_worst(theta(0, 1e-9, 1e-11)), 9, 1e-8) << "an absolute error, where the truth is 0";
    CertifiedSolution const singular = certified({.size = 3, .prior = std::nullopt}, integers(), {2}).front();
    EXPECT_TRUE(std::isnan(singular.theta_digits(theta(0, 0, 0))));
    EXPECT_TRUE(std::isnan(singular.covariance_digits({Quantity::covariance, Form::plain, covariance(), {}})));
}

TEST(CovarianceDigits, OfExactFormsAreAllThereAre) {
    // M = L D L' = U D U' and P likewise, in fractions Reference holds exactly or to 257 bits
    Matrix<Reference> L = Matrix<Reference>::Identity(3, 3);
    L(1, 0) = Reference(1) / 2;
    L(2, 1) = Reference(2) / 5;
    Vector<Reference> D(3);
    D << Reference(2), Reference(5) / 2, Reference(8) / 5;
    constexpr int asked = 90;
    double const rounded = 75;  // 2^-256 and a little: L and D hold fifths
    EXPECT_GE(digits_of(Quantity::covariance, Form::plain, covariance(), {}, asked), asked);
    EXPECT_GE(digits_of(Quantity::information, Form::plain, information(), {}, asked), asked);
    EXPECT_GE(digits_of(Quantity::information, Form::factor, L, D, asked), rounded);
    Matrix<Reference> root = L;
    for (Index j = 0; j < 3; ++j) root.col(j) *= sqrt(D(j));
    EXPECT_GE(digits_of(Quantity::information, Form::factor, root, {}, asked), rounded);
    // P = L^-T D^-1 L^-1:  L^-T is unit upper
    Matrix<Reference> U = Matrix<Reference>::Identity(3, 3);
    U(0, 1) = -Reference(1) / 2;
    U(1, 2) = -Reference(2) / 5;
    U(0, 2) = Reference(1) / 5;
    EXPECT_GE(digits_of(Quantity::covariance, Form::factor, U, D.cwiseInverse(), asked), rounded);
    // any orthogonal mixture of a root's columns is a root too, and no triangle: here (3, 4)/5
    Matrix<Reference> Q = Matrix<Reference>::Identity(3, 3);
    Q(0, 0) = Q(1, 1) = Reference(3) / 5;
    Q(0, 1) = Reference(4) / 5;
    Q(1, 0) = -Q(0, 1);
    EXPECT_GE(digits_of(Quantity::information, Form::factor, Matrix<Reference>(root * Q), {}, asked), rounded);
}

TEST(CovarianceDigits, AreMinusLogOfTheRelativeFrobeniusError) {
    Matrix<Reference> P = covariance();  // ||8 P||_F^2 = 25 + 16 + 25 + 4 * 4 + 2 = 84
    double const norm = std::sqrt(84.0) / 8;
    P(0, 1) += Reference(1e-6);
    EXPECT_NEAR(digits_of(Quantity::covariance, Form::plain, P), 6 + std::log10(norm), 1e-7) << "not symmetrised";
    Matrix<Reference> const swollen = covariance() * Reference(1 + 1e-9),
                            scaled_down = information() * Reference(1 + 1e-9);
    EXPECT_NEAR(digits_of(Quantity::covariance, Form::plain, swollen), 9, 1e-6);
    EXPECT_NEAR(digits_of(Quantity::information, Form::plain, scaled_down), 9, 1e-6);
    EXPECT_NEAR(digits_of(Quantity::covariance, Form::plain, Matrix<Reference>::Zero(3, 3)), 0, 1e-9);
    EXPECT_NEAR(digits_of(Quantity::covariance, Form::factor, Matrix<Reference>::Zero(3, 3)), 0, 1e-9);
    Matrix<Reference> asymmetric = information();  // dP = -P E P, E = 1e-8 e_0 e_2'
    asymmetric(0, 2) += Reference(1e-8);
    double const change = std::sqrt(25 + 4 + 1.0) * std::sqrt(25 + 4 + 1.0) / 64;
    EXPECT_NEAR(digits_of(Quantity::information, Form::plain, asymmetric), 8 - std::log10(change / norm), 1e-6);
    // an indefinite matrix is as far away as it is
    EXPECT_NEAR(digits_of(Quantity::information, Form::plain, Matrix<Reference>(-information())), -std::log10(2.0),
                1e-9);
    EXPECT_NEAR(digits_of(Quantity::information, Form::factor, Matrix<Reference>::Identity(3, 3), theta(1e-100, 1, 1)),
                -100 + std::log10(norm), 1e-6);
}

TEST(CovarianceDigits, AtTheEdges) {
    Matrix<Reference> M = information();
    M.row(2) = M.row(0) + M.row(1);
    EXPECT_TRUE(std::isnan(digits_of(Quantity::information, Form::plain, M))) << "singular";
    EXPECT_TRUE(std::isnan(digits_of(Quantity::information, Form::factor, M)));
    EXPECT_TRUE(std::isnan(digits_of(Quantity::information, Form::factor, information(), theta(1, 0, 1))));
    Matrix<Reference> triangle = Matrix<Reference>::Identity(3, 3);
    triangle(1, 1) = 0;
    EXPECT_TRUE(std::isnan(digits_of(Quantity::information, Form::factor, triangle)));
    M(2, 2) += ldexp(Reference(1), -250);  // nonsingular by very little: P is enormous, not undefined
    EXPECT_LT(digits_of(Quantity::information, Form::plain, M), -70);
    M(0, 0) = inf;
    EXPECT_TRUE(std::isnan(digits_of(Quantity::covariance, Form::plain, M)));
    EXPECT_TRUE(std::isnan(digits_of(Quantity::covariance, Form::factor, covariance(), theta(1, std::nan(""), 1))));
    EXPECT_THROW(digits_of(Quantity::covariance, Form::plain, Matrix<Reference>::Zero(2, 2)), std::invalid_argument);
}

TEST(Midpoints, AreTheSolutionRoundedToReference) {
    CertifiedSolution const exact = solution(90);
    EXPECT_EQ(exact.theta(), theta(3, -4, 12));
    EXPECT_EQ(exact.covariance(), covariance());
}

TEST(Strings, AreCorrectlyRounded) {
    Records data{.psi = Eigen::MatrixXd::Constant(1, 1, 3), .y = Vector<double>::Constant(1, 2), .names = {}};
    Problem<double> const problem{.size = 1, .prior = std::nullopt};
    auto text = [&](int digits) { return certified(problem, data, {1}).front().theta_strings(digits).front(); };
    EXPECT_EQ(text(4), "6.667e-1");
    EXPECT_EQ(text(1), "7e-1");
    EXPECT_EQ(text(30), "6.66666666666666666666666666667e-1");
    EXPECT_THAT(text(1000), testing::MatchesRegex("6[.]6+7e-1")) << "as many as are certain";
    data.y(0) = -0x1p1000;
    EXPECT_EQ(text(6), "-3.57170e300");
}

TEST(Condition, OfKnownMatrices) {
    Records data{.psi = Eigen::MatrixXd(2, 3), .y = Vector<double>::Constant(3, inf), .names = {}};
    data.psi << 3, 0, 0, 0, 1e-5, 0;
    EXPECT_NEAR(condition(data, 1) / 3e5, 1, 1e-11);
    EXPECT_NEAR(condition(data, 0.25) / 1.5e5, 1, 1e-11) << "the older row weighs half of the next";
    data.psi << 1, 1, 0, 1, 1 + 0x1p-40, 0;  // singular values from s1^2 + s2^2 and s1 s2 = 2^-40
    EXPECT_NEAR(condition(data, 1) / (4 * 0x1p40), 1, 1e-11);
    data.psi << 1, 1, 2, 1, 1, 2;
    EXPECT_EQ(condition(data, 1), inf);
    data.psi << 1e200, 0, 0, 0, 1e-200, 0;
    EXPECT_EQ(condition(data, 1), inf) << "beyond double";
    data.psi << 1e150, 0, 0, 0, 1e-150, 0;
    EXPECT_NEAR(condition(data, 1) / 1e300, 1, 1e-11);
    data.psi(0, 0) = inf;
    EXPECT_TRUE(std::isnan(condition(data, 1)));
    EXPECT_EQ(condition({.psi = Eigen::MatrixXd(2, 0), .y = {}, .names = {}}, 1), inf);
}

TEST(Condition, OfAHilbertMatrix) {
    // By Jacobi's method in 40 decimal digits; the 1.4951058642e7 in circulation is that of the rounded fractions.
    // Entries scaled by 27720 are integers.
    Records data{.psi = Eigen::MatrixXd(6, 6), .y = Vector<double>::Zero(6), .names = {}};
    for (Index j = 0; j < 6; ++j)
        for (Index i = 0; i < 6; ++i) data.psi(i, j) = 27720 / double(i + j + 1);
    EXPECT_NEAR(condition(data, 1) / 1.49510586401312168e7, 1, 1e-11);
}

}  // namespace
}  // namespace rlslab
