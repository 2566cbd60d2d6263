// The bound of theta is above its error where probes are in F's own word, too: the rounding of z is in it.
#include <rlslab/adapt/certified.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/arithmetic/multiprecision.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using R = Reference;

/// Rows whose outputs are residuals of this size, beside a theta of +-1. In pairs: the second has the same regressor
/// and the other sign, so that theta stays small where lambda = 1. steady: a constant column and a constant residual.
struct Rows {
    Seed seed;
    Index d;
    double residual, spread;
    bool pairs, steady;
    Vector<double> psi = Vector<double>::Zero(d);
    double apart = 0, y = 0;
    int k = 0;
    void next() {
        bool const again = pairs && k++ % 2 == 1;
        if (!again) {
            double const common = seed.bell();
            for (Index j = 0; j < d; ++j) psi[j] = (1 - spread) * common + spread * seed.bell();
            if (steady) psi[0] = 1;
        }
        apart = again ? -apart : residual * (steady ? 0.1 : seed.bell());
        y = apart;
        for (Index j = 0; j < d; ++j) y += j % 2 ? -psi[j] : psi[j];
    }
};

/// The error of theta over its bound, the largest of all forms; both after 20, 100 and 400 rows. P0 is 2^14 times
/// 1 on the diagonal and rho beside it.
double largest_share(Rows rows, double lambda, double theta0, double rho = 0) {
    Index const d = rows.d;
    Problem<double> p{.size = d, .forgetting = lambda, .prior = Prior<double>{.variance = 0x1p14}};
    p.prior->theta = Vector<double>::Constant(d, theta0);
    if (rho > 0) {
        p.prior->covariance = Matrix<double>::Constant(d, d, 0x1p14 * rho);
        p.prior->covariance->diagonal().setConstant(0x1p14);
    }
    std::tuple all{Certified<Ud<double>>(p),          Certified<UdDelta<double>>(p), Certified<Carlson<double>>(p),
                   Certified<InverseQr<double>>(p),   Certified<Potter<double>>(p),  Certified<Joseph<double>>(p),
                   Certified<Information<double>>(p), Certified<Qr<double>>(p),      Certified<Gentleman<double>>(p),
                   Certified<Conventional<double>>(p)};
    R const beside = R(rho) / R(R(1) + R(double(d - 1)) * R(rho));  // P0^-1 in closed form
    Matrix<R> X = (Matrix<R>::Identity(d, d) - Matrix<R>::Constant(d, d, beside)) / R(R(0x1p14) * R(1 - rho));
    Vector<R> z = Vector<R>::Constant(d, R(0));
    for (Index j = 0; j < d; ++j)
        for (Index i = 0; i < d; ++i) z[i] += X(i, j) * R(theta0);
    double most = 0;
    for (int k = 1; k <= 400; ++k) {
        rows.next();
        for (Index j = 0; j < d; ++j) {
            for (Index i = 0; i < d; ++i) X(i, j) = R(lambda) * X(i, j) + R(rows.psi[i]) * R(rows.psi[j]);
            z[j] = R(lambda) * z[j] + R(rows.psi[j]) * R(rows.y);
        }
        std::apply([&](auto&... f) { (f.update(rows.psi, rows.y), ...); }, all);
        if (k != 20 && k != 100 && k != 400) continue;
        Vector<R> const theta = X.lu().solve(z);
        auto const look = [&](auto& f) {
            Vector<R> const found = f.theta().template cast<R>();
            R const error = R(sqrt(R((found - theta).squaredNorm()))), length = R(sqrt(R(found.squaredNorm())));
            double const bound = f.certificate().theta;
            if (std::isfinite(bound)) most = std::max(most, static_cast<double>(R(error / (length * R(bound)))));
        };
        std::apply([&](auto&... f) { (look(f), ...); }, all);
    }
    return most;
}

/// A search that tried to refute it: without the rounding of z the error is up to 10^6 bounds.
TEST(CertifiedTheta, IsAboveItsErrorInTheFiltersOwnWord) {
    std::uint64_t seed = 1;
    for (double const lambda : {1.0, 0.998046875, 0.9})
        for (double const residual : {0.1, 1e3, 1e6, 1e9})
            for (Index const d : {2, 5})
                for (double const spread : {1.0, 1e-3})
                    for (int const kind : {0, 1, 2, 3})
                        EXPECT_LE(largest_share({Seed{++seed}, d, residual, spread, kind >= 2, kind % 2 == 1}, lambda,
                                                kind == 2 ? 1e6 : 0),
                                  1)
                            << lambda << " " << residual << " " << d << " " << spread << " " << kind;
}
/// A full P0 whose factor cancels: the start of the probes is not the filter's, with its rounding.
TEST(CertifiedTheta, IsAboveItsErrorFromAFullPrior) {
    std::uint64_t seed = 1000;
    for (double const lambda : {1.0, 0.98046875, 0.9})
        for (double const residual : {0.1, 1e3, 1e8})
            for (Index const d : {2, 5})
                for (int const bits : {10, 20, 27})
                    EXPECT_LE(largest_share({Seed{++seed}, d, residual, 1, false, false}, lambda, 0,
                                            1 - std::ldexp(1.0, -bits)),
                              1)
                        << lambda << " " << residual << " " << d << " " << bits;
}
/// It does not grow with the rows where lambda = 1: sums of 32 rows are added without an error.
TEST(CertifiedTheta, StaysTightOverManyRows) {
    Certified<Ud<double, 3>> f({.size = 3});
    adapt_laws::run_rows(f, 100000, Seed{5});
    EXPECT_LT(f.certificate().theta, 1e-11);
}
TEST(CertifiedTheta, IsInTheState) {
    using F = Certified<Ud<double, 4>>;
    Problem<double> const p{.size = 4, .forgetting = 0.96875};
    adapt_laws::check_state(F(p, Seed{3}), F(p, Seed{4}),
                            [](F& f, int rows, Seed seed) { adapt_laws::run_rows(f, rows, seed); });
}

}  // namespace
}  // namespace rlslab
