// Every number of a comparison worked out another way: two parameters, rationals, Cramer's rule.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/compare/score.hpp"
#include "src/lab/compare/rounded_problem.hpp"
#include "tests/common/laws.hpp"

#include <rlslab/model/regression.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
using namespace compare;
using namespace report;
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Columns that are nearly parallel, on a grid of 2^-6, so that short words store them with errors.
Records few_rows(Index rows = 14) {
    Records out{.psi = Eigen::MatrixXd(2, rows), .y = Vector<double>(rows), .names = {"a", "b"}};
    Seed seed{3};
    auto const grid = [&](double size) { return std::floor(64 * size * (seed.uniform() - 0.5)) / 64; };
    for (Index k = 0; k < rows; ++k) {
        double const x = grid(8), z = x + grid(2);
        out.psi.col(k) << x, z;
        out.y[k] = 3 * x - 0.5 * z + grid(1);
    }
    return out;
}

/// M and b after k rows, their solution and M^-1.
struct Solved {
    Rational theta[2], P[2][2], M[2][2];
};
Solved solved(Records const& r, Index rows, double lambda, double p00, double p11) {
    Rational const l(lambda);
    Rational m00 = p00 > 0 ? Rational(1) / Rational(p00) : Rational(0), m01 = 0,
             m11 = p11 > 0 ? Rational(1) / Rational(p11) : Rational(0), b0 = 0, b1 = 0;
    for (Index k = 0; k < rows; ++k) {
        Rational const x = r.psi(0, k), z = r.psi(1, k), y = r.y[k];
        m00 = l * m00 + x * x, m01 = l * m01 + x * z, m11 = l * m11 + z * z, b0 = l * b0 + x * y, b1 = l * b1 + z * y;
    }
    Rational const det = m00 * m11 - m01 * m01;
    return {{(b0 * m11 - b1 * m01) / det, (b1 * m00 - b0 * m01) / det},
            {{m11 / det, -m01 / det}, {-m01 / det, m00 / det}},
            {{m00, m01}, {m01, m11}}};
}

Reference wide(Rational const& x) { return Reference(numerator(x).str()) / Reference(denominator(x).str()); }
double digits_of(Reference const& error) { return error == 0 ? infinity : -static_cast<double>(log10(error)); }

double theta_digits(Vector<Reference> const& x, Solved const& s) {
    Reference const a = wide(s.theta[0]), b = wide(s.theta[1]), da = x[0] - a, db = x[1] - b;
    return digits_of(sqrt(Reference((da * da + db * db) / (a * a + b * b))));
}
double worst_digits(Vector<Reference> const& x, Solved const& s) {
    double out = infinity;
    for (int i = 0; i < 2; ++i)
        out = std::min(out, digits_of(abs(Reference((x[i] - wide(s.theta[i])) / wide(s.theta[i])))));
    return out;
}
Matrix<Reference> rebuilt(Stored<Reference> const& stored) {
    return covariance_of(stored, [](Matrix<Reference> const& X) {
        Reference const det = X(0, 0) * X(1, 1) - X(0, 1) * X(1, 0);
        return Matrix<Reference>{{X(1, 1) / det, -X(0, 1) / det}, {-X(1, 0) / det, X(0, 0) / det}};
    });
}
double covariance_digits(Stored<Reference> const& stored, Solved const& s) {
    Matrix<Reference> const P = rebuilt(stored);
    Reference error = 0, size = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            Reference const exact = wide(s.P[i][j]), d = P(i, j) - exact;
            error += d * d;
            size += exact * exact;
        }
    return digits_of(sqrt(Reference(error / size)));
}

void expect_digits(std::optional<double> const& said, double worked_out, double most, std::string const& what) {
    EXPECT_EQ(said.has_value(), !std::isnan(worked_out)) << what;
    if (said) {
        EXPECT_NEAR(*said, std::min(worked_out, most), 1e-9) << what;
    }
}

Comparison compared(Records const& r, double lambda, std::optional<double> p0 = {}) {
    return compare::compare(
        r,
        {.forgetting = lambda, .p0 = p0, .arithmetics = {"bfloat16", "binary16", "float", "double"}, .timings = false});
}

TEST(ComparisonNumbers, DigitsAtEachCheckpoint) {
    Records const given = few_rows();
    for (double const lambda : {1.0, 0.875}) {
        Comparison const c = compared(given, lambda);
        ASSERT_TRUE(c.scaled_prior);
        Matrix<double> const P0 = *c.scaled_prior->prior().covariance;
        ASSERT_EQ(c.checkpoints.size(), size_t(given.rows()));
        int finite = 0;
        for (Result const& r : c.results) {
            Arithmetic const& a = *r.entry->arithmetic;
            Records const stored = as_stored(given, a);
            auto const filter =
                r.entry->make({.size = 2, .forgetting = lambda, .prior = c.scaled_prior->prior()}, Seed{1});
            ASSERT_EQ(r.path.size(), c.checkpoints.size());
            for (Index k = 0; k < given.rows(); ++k) {
                if (r.entry->block == 1) filter->update(stored.sample(k), stored.y[k]);
                else filter->update_block(stored, k, k + 1);
                std::string const what =
                    std::string(r.entry->variant) + " in " + std::string(a.name) + " at " + std::to_string(k);
                Solved const s = solved(stored, k + 1, lambda, P0(0, 0), P0(1, 1));
                Digits const& said = r.path[size_t(k)];
                double const most = a.digits * std::log10(2);
                Vector<Reference> const theta = filter->theta();
                if (!is_finite(theta[0]) || !is_finite(theta[1])) continue;
                ++finite;
                expect_digits(said.theta, theta_digits(theta, s), most, what);
                expect_digits(said.worst, worst_digits(theta, s), most, what);
                expect_digits(said.covariance, covariance_digits(filter->stored(), s), most, what);
            }
            EXPECT_EQ(r.last.theta, r.path.back().theta);
            EXPECT_EQ(r.last.worst, r.path.back().worst);
            EXPECT_EQ(r.last.covariance, r.path.back().covariance);
        }
        EXPECT_GT(finite, 700);
    }
}

/// Digits and breakdowns of runs, and the spread of the digits.
struct Tally {
    PerMeasure<std::vector<double>> all;
    int broke = 0;
    Index first = -1;  ///< row of the breakdown of the first run

    void take(AnyFilter& filter, Records const& rows, Problem<double> const& problem, Arithmetic const& a,
              bool first_run) {
        Index breakdown = -1;
        for (Index k = 0; k < rows.rows(); ++k) {
            filter.update(rows.sample(k), rows.y[k]);
            Stored<Reference> const held = filter.stored();
            Vector<Reference> const theta = filter.theta();
            bool const finite = is_finite(theta[0]) && is_finite(theta[1]);
            Matrix<Reference> const X = rebuilt({Stored<Reference>::Quantity::covariance, held.form, held.F, held.D});
            // A 2 x 2 matrix is definite if its trace and determinant are positive; 257 bits hold the products of short
            // words.
            Reference const off = (X(0, 1) + X(1, 0)) / 2;
            if (!(X(0, 0) + X(1, 1) > 0 && X(0, 0) * X(1, 1) - off * off > 0) && breakdown < 0) breakdown = k + 1;
            if (k + 1 < 4) continue;
            Solved const s = solved(rows, k + 1, problem.forgetting, (*problem.prior->covariance)(0, 0),
                                    (*problem.prior->covariance)(1, 1));
            double const most = a.digits * std::log10(2);
            all.theta.push_back(finite ? std::min(most, theta_digits(theta, s)) : -infinity);
            all.worst.push_back(finite ? std::min(most, worst_digits(theta, s)) : -infinity);
            double const P = covariance_digits(held, s);
            all.covariance.push_back(std::isnan(P) ? -infinity : std::min(most, P));
        }
        broke += breakdown >= 0;
        if (first_run) first = breakdown;
    }
    Spread spread(size_t m) const {
        std::vector<double> sorted = all.*(PerMeasure<std::vector<double>>::all()[m]);
        std::ranges::sort(sorted);
        double const last = double(sorted.size() - 1);
        auto const tenth = [&](double rank) { return std::round(10 * sorted[size_t(rank)]) / 10; };
        return {tenth(std::floor(last / 10)), tenth(std::floor(last / 2)), tenth(std::ceil(9 * last / 10))};
    }
};

/// The spread is that of the digits at rows 2 d and later: over the draws in the record's order, and apart over the
/// other orders. The breakdowns are counted likewise.
TEST(ComparisonNumbers, TheSpreadAndTheBreakdownsOverTheDrawsAndTheOrders) {
    Records const given = few_rows();
    int broken = 0, later = 0, several = 0;
    for (double const lambda : {1.0, 0.875}) {
        Comparison const c = compared(given, lambda);
        for (Result const& r : c.results) {
            if (r.entry->block > 1) continue;
            Arithmetic const& a = *r.entry->arithmetic;
            Problem<double> const problem{.size = 2, .forgetting = lambda, .prior = c.scaled_prior->prior()};
            Tally own, others;
            bool const exact = exact_rows(as_stored(given, a), problem, a).has_value();
            size_t draw = 0;
            for (int i = 0; i < r.runs && draw < 16; ++draw) {
                Records const rows = as_stored(drawn(given, draw), a);
                if (exact && !exact_rows(rows, problem, a)) continue;
                own.take(*r.entry->make(problem, Seed{1}), rows, problem, a, i++ == 0);
            }
            auto const orders = row_orders(given.rows(), lambda, 1);
            for (size_t i = 1; i < orders.size(); ++i)
                others.take(*r.entry->make(problem, Seed{1}), in_order(as_stored(given, a), orders[i]), problem, a,
                            false);
            std::string const what = std::string(r.entry->variant) + " in " + std::string(a.name);
            EXPECT_EQ(r.breakdown.value_or(Breakdown{-1, {}}).step, own.first) << what;
            EXPECT_EQ(r.others.runs, lambda == 1 ? 3 : 0);
            EXPECT_EQ(r.broken, own.broke) << what;
            EXPECT_EQ(r.others.broken, others.broke) << what;
            broken += own.broke + others.broke, later += others.broke > 0 && !r.breakdown, several += r.runs > 1;
            ASSERT_TRUE(r.spread);
            ASSERT_EQ(r.others.spread.has_value(), lambda == 1);
            for (size_t m = 0; m < 3; ++m) {
                auto const measure = PerMeasure<Spread>::all()[m];
                EXPECT_EQ((*r.spread).*measure, own.spread(m)) << what << " measure " << m;
                if (lambda == 1) {
                    EXPECT_EQ((*r.others.spread).*measure, others.spread(m)) << what << " measure " << m;
                }
            }
        }
    }
    EXPECT_GT(broken, 10);
    EXPECT_GT(several, 10);
    EXPECT_GT(later, 0) << "no form broke down in another order alone";
}

TEST(ComparisonNumbers, OfTheProblem) {
    Records const given = few_rows();
    for (double const lambda : {1.0, 0.875}) {
        Comparison const c = compared(given, lambda, 2.0);
        Solved const with = solved(given, given.rows(), lambda, 2, 2),
                     without = solved(given, given.rows(), lambda, 0, 0);
        Vector<double> const s = regressor_scales(given);
        Reference change = 0, size = 0;
        for (int i = 0; i < 2; ++i) {
            Reference const d = (wide(with.theta[i]) - wide(without.theta[i])) * s[i],
                            w = wide(without.theta[i]) * s[i];
            change += d * d;
            size += w * w;
            EXPECT_NEAR(c.agreement[size_t(i)],
                        digits_of(abs(Reference(wide(with.theta[i]) / wide(without.theta[i]) - 1))), 1e-12);
            EXPECT_NEAR(static_cast<double>(Reference(Reference(c.theta[size_t(i)]) / wide(with.theta[i]) - 1)), 0,
                        1e-29);
            EXPECT_NEAR(
                static_cast<double>(Reference(Reference(c.least_squares[size_t(i)]) / wide(without.theta[i]) - 1)), 0,
                1e-29);
            EXPECT_NE(c.theta[size_t(i)], c.least_squares[size_t(i)]);
        }
        EXPECT_NEAR(c.prior_bias / static_cast<double>(sqrt(Reference(change / size))), 1, 1e-12);
        // kappa^2 = (t + sqrt(t^2 - 4 D)) / (t - sqrt(t^2 - 4 D)) with trace t and determinant D of the Gram matrix
        Reference const t = wide(without.M[0][0] + without.M[1][1]),
                        D = wide(without.M[0][0] * without.M[1][1] - without.M[0][1] * without.M[1][0]);
        Reference const root = sqrt(Reference(t * t - 4 * D));
        EXPECT_NEAR(c.condition / static_cast<double>(sqrt(Reference((t + root) / (t - root)))), 1, 1e-11);
        EXPECT_FALSE(c.scaled_prior);
        EXPECT_EQ(c.rows, given.rows());
        EXPECT_EQ(c.size, 2);
        EXPECT_LE(c.radius, 1e-30);
    }
    EXPECT_EQ(compared(few_rows(), 1).prior_bias, default_prior(few_rows(), 1).bias);
}

TEST(ComparisonNumbers, OfStorage) {
    Records const given = few_rows();
    double const lambda = 0.99, p0 = 2;
    Comparison const c = compared(given, lambda, p0);
    ASSERT_EQ(c.rounding.size(), 3u);  // double stores what is given
    Solved const as_given = solved(given, given.rows(), lambda, p0, p0);
    Vector<double> const s = regressor_scales(given);
    for (RoundingEffect const& effect : c.rounding) {
        Arithmetic const& a = *std::ranges::find(arithmetics(), effect.arithmetic, &Arithmetic::name);
        Records const stored = as_stored(given, a);
        double const l = a.round(lambda);
        EXPECT_EQ(effect.forgetting, l);
        EXPECT_EQ(effect.rank, 2);
        EXPECT_TRUE(effect.in_range);
        Solved const with = solved(stored, stored.rows(), l, p0, p0), without = solved(stored, stored.rows(), l, 0, 0);
        Reference change = 0, size = 0, moved = 0, whole = 0;
        for (int i = 0; i < 2; ++i) {
            Reference const d = (wide(with.theta[i]) - wide(without.theta[i])) * s[i],
                            w = wide(without.theta[i]) * s[i];
            change += d * d;
            size += w * w;
            Reference const m = wide(with.theta[i]) - wide(as_given.theta[i]), g = wide(as_given.theta[i]);
            moved += m * m;
            whole += g * g;
        }
        EXPECT_NEAR(effect.prior_bias / static_cast<double>(sqrt(Reference(change / size))), 1, 1e-12);
        ASSERT_TRUE(effect.theta_digits);
        EXPECT_NEAR(*effect.theta_digits, digits_of(sqrt(Reference(moved / whole))), 1e-9);
    }
    Records parallel = given;  // apart by less than bfloat16 can tell
    for (Index k = 0; k < given.rows(); ++k)
        parallel.psi(1, k) = parallel.psi(0, k) * (1 + std::ldexp(double(k % 3), -14));
    Comparison const p = compared(parallel, 1);
    EXPECT_EQ(p.rounding[0].rank, 1);
    EXPECT_EQ(p.rounding[2].rank, 2);
    EXPECT_EQ(p.recommendations[0].why, "as stored there the regressors have rank 1 of 2");
    EXPECT_NE(p.recommendations[3].variant, "");
    Comparison const wide_prior = compared(given, 1, 1e30);  // beyond binary16, within the others
    EXPECT_FALSE(wide_prior.rounding[1].in_range);
    EXPECT_TRUE(wide_prior.rounding[0].in_range);
    EXPECT_EQ(wide_prior.recommendations[1].why, "P0 leaves its range: another --p0");
    for (Result const& r : wide_prior.results)
        if (r.entry->arithmetic->name == "binary16") {
            ASSERT_TRUE(r.breakdown);
            EXPECT_EQ(r.breakdown->step, 0);
            EXPECT_EQ(r.runs, 0);
        }
}

/// max |F_ij - F_ji| / max |F_ij| of what is stored at the end.
TEST(ComparisonNumbers, Asymmetry) {
    Records const given = few_rows();
    Comparison const c = compared(given, 0.875);
    int asymmetric = 0;
    for (Result const& r : c.results) {
        Arithmetic const& a = *r.entry->arithmetic;
        Records const stored = as_stored(given, a);
        auto const filter = r.entry->make({.size = 2, .forgetting = 0.875, .prior = c.scaled_prior->prior()}, Seed{1});
        for (Index k = 0; k < stored.rows(); ++k)
            if (r.entry->block == 1) filter->update(stored.sample(k), stored.y[k]);
            else filter->update_block(stored, k, k + 1);
        Stored<Reference> const held = filter->stored();
        if (held.form == Stored<Reference>::Form::factor) {
            EXPECT_EQ(r.asymmetry, 0) << r.entry->variant;
            EXPECT_TRUE(r.factor) << r.entry->variant;
            continue;
        }
        EXPECT_FALSE(r.factor);
        Reference largest = 0;
        for (Reference const& x : held.F.reshaped()) largest = std::max(largest, Reference(abs(x)));
        double const expected = static_cast<double>(Reference(abs(Reference(held.F(0, 1) - held.F(1, 0))) / largest));
        ASSERT_TRUE(r.asymmetry) << r.entry->variant;
        EXPECT_EQ(*r.asymmetry, expected) << r.entry->variant << a.name;
        asymmetric += expected > 0;
    }
    EXPECT_GT(asymmetric, 3);
}

TEST(ComparisonNumbers, OperationsAreThoseOfTheCountedScalar) {
    Comparison const c = compared(few_rows(), 1);
    for (Result const& r : c.results) {
        auto const counted = cost(r.entry->variant, 2);
        EXPECT_EQ(r.operations.has_value(), counted.has_value());
        if (!counted) continue;
        EXPECT_EQ(*r.operations, counted->update.additions + counted->update.multiplications +
                                     counted->update.divisions + counted->update.square_roots +
                                     counted->theta.additions + counted->theta.multiplications +
                                     counted->theta.divisions + counted->theta.square_roots);
    }
}

/// Four draws, each of its own: of stochastic rounding, and of the rows in other units.
TEST(ComparisonNumbers, RoundingsAreDrawnFourTimes) {
    Records const given = few_rows();
    auto const of = [&](double lambda) {
        return compare::compare(given, {.forgetting = lambda,
                                        .variants = {"ud"},
                                        .arithmetics = {"binary16-stochastic", "binary16"},
                                        .timings = false})
            .results;
    };
    for (double const lambda : {1.0, 0.875})
        for (Result const& r : of(lambda)) EXPECT_EQ(r.runs, 4) << "there is no other form";
    std::vector<std::optional<double>> once;
    for (Result const& r : of(0.875))
        if (r.entry->arithmetic->stochastic) {
            for (size_t k = 3; k < r.path.size(); ++k) once.push_back(r.path[k].theta);
            EXPECT_NE(spread_of(once), r.spread->theta) << "the draws are all the same";
        }
}

}  // namespace
}  // namespace rlslab
