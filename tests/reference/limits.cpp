// Where the certified reference stops, and what it decides there: the largest precision, and a solution of exactly
// zero.
#include <rlslab/reference/balls.hpp>
#include <rlslab/reference/certified.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Rows (x, x) -> y: the difference of the two parameters is known from the prior alone.
Records twins(Index rows) {
    Records data{.psi = Eigen::MatrixXd(2, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        data.psi.col(k).setConstant(double(k % 5) - 2);
        data.y[k] = double(k % 3);
    }
    return data;
}

TEST(Certified, AllOf65536BitsAreTried) {
    // The prior is 2^-52000 of the data: between three quarters of 2^16 bits and all of them.
    CertifiedSolution const exact = certified({.size = 2, .forgetting = 0.5}, twins(52000), {52000}).front();
    EXPECT_EQ(exact.status(), Status::certified);
    EXPECT_EQ(exact.bits(), 65536);
    EXPECT_EQ(certified({.size = 2, .forgetting = 0.5}, twins(66000), {66000}).front().status(), Status::unresolved);
}

/// One row that carries theta0 to exactly zero (`off` = 0), and the inverse of P0 is no binary fraction.
struct ToZero {
    Problem<double> problem;
    Records data;
};
ToZero one_parameter(double off) {
    Records data{.psi = Eigen::MatrixXd::Constant(1, 1, 1), .y = Vector<double>::Constant(1, -1 + off), .names = {}};
    return {{.size = 1, .prior = Prior<double>{.variance = 3, .theta = Vector<double>::Constant(1, 3)}}, data};
}
ToZero two_parameters(double lambda, double off) {  // P0^-1 = [2 -1; -1 5] / 9
    Matrix<double> const P0 = (Matrix<double>(2, 2) << 5, 1, 1, 2).finished();
    Vector<double> const s = Eigen::Vector2d(-3, 4), theta = P0 * s;
    Records data{.psi = Eigen::MatrixXd::Identity(2, 2), .y = -s, .names = {}};
    data.y[0] *= lambda;  // two rows: the prior weighs lambda^2, the first row lambda
    data.y[1] *= lambda * lambda;
    data.y[1] += off;
    return {{.size = 2, .forgetting = lambda, .prior = Prior<double>{.theta = theta, .covariance = P0}}, data};
}

TEST(Certified, ZeroIsCertifiedUnderAnInexactPrior) {
    for (ToZero const& to : {one_parameter(0), two_parameters(1, 0), two_parameters(0.5, 0), two_parameters(0.75, 0)}) {
        Index const k = to.data.rows();
        CertifiedSolution const exact = certified(to.problem, to.data, {k}).front();
        ASSERT_EQ(exact.status(), Status::certified) << k << " " << to.problem.forgetting;
        EXPECT_EQ(exact.radius(), 0);
        for (Reference const& x : exact.theta()) EXPECT_EQ(x, 0);
        for (std::string const& text : exact.theta_strings()) EXPECT_EQ(text, "0");
        EXPECT_EQ(exact.theta_digits(Vector<Reference>::Zero(k)), std::numeric_limits<double>::infinity());
        EXPECT_EQ(exact.theta_digits(Vector<Reference>::Ones(k)), -std::numeric_limits<double>::infinity());
        EXPECT_LT(exact.covariance_radius(), 1e-30);
    }
}

TEST(Certified, NearlyZeroIsNotZero) {
    for (double const off : {0x1p-40, -0x1p-50})
        for (ToZero const& to : {one_parameter(off), two_parameters(1, off), two_parameters(0.5, off)}) {
            CertifiedSolution const exact = certified(to.problem, to.data, {to.data.rows()}).front();
            ASSERT_EQ(exact.status(), Status::certified);
            EXPECT_LT(exact.radius(), 1e-30);
            EXPECT_GT(exact.radius(), 0);
            EXPECT_NE(exact.theta()[to.data.rows() - 1], 0);
        }
}

/// Columns of both signs of which the third is the difference of the first two: their magnitudes are independent.
TEST(Certified, ARankIsThatOfTheSignedNumbers) {
    Records data{.psi = Eigen::MatrixXd(3, 12), .y = Vector<double>::Ones(12), .names = {}};
    for (Index k = 0; k < 12; ++k) {
        double const a = double(k * 7 % 11) - 5, b = double(k * 5 % 9) - 4;
        data.psi.col(k) << a, b, a - b;
    }
    CertifiedSolution const singular = certified({.size = 3, .prior = std::nullopt}, data, {12}).front();
    EXPECT_EQ(singular.status(), Status::singular);
    EXPECT_EQ(singular.rank(), 2);
    data.psi(2, 11) += 0x1p-30;
    EXPECT_EQ(certified({.size = 3, .prior = std::nullopt}, data, {12}).front().status(), Status::certified);
}

/// 2^-t <= 10^-digits for t = bits(digits), and hardly more, where digits log2(10) is just above a whole number:
/// denominators of its continued fraction.
template <class Bits>
bool suffice(Bits bits) {
    Reference const log2_10 = log(Reference(10)) / log(Reference(2));
    for (long const digits : {1L, 30L, 28L, 146L, 4004L, 12655L, 76573L, 1838395L, 13456039L, 44240665L, 579001193L}) {
        Reference const t = digits * log2_10, given = bits(digits);
        if (given < t || given > t * (1 + Reference(1e-9)) + 1) return false;
    }
    return true;
}
TEST(Certified, BitsForDigitsSuffice) {
    EXPECT_TRUE(suffice(&balls::bits_for));
    EXPECT_FALSE(suffice([](long digits) { return long(std::ceil(double(digits) * 3.3219280948873624)); }))
        << "log2(10) to nearest";
    EXPECT_FALSE(suffice([](long digits) { return balls::bits_for(digits) + 1; }));
}

}  // namespace
}  // namespace rlslab
