// Extended least squares and instrumental variables around ud, over the fitted rows of the equation.
#include "src/lab/identify/estimate.hpp"

#include <rlslab/adapt/extended_least_squares.hpp>
#include <rlslab/adapt/instrumental_variables.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/matrices.hpp>
#include <rlslab/linalg/dot.hpp>
#include <rlslab/linalg/product.hpp>
#include <rlslab/variants/ud.hpp>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rlslab::identify {
using detail::product;
namespace {

/// The terms, and n further past lags of each input.
std::vector<Term> with_further_lags(std::vector<Term> terms, size_t inputs, int n) {
    size_t const own = terms.size();
    for (int j = 0; j < int(inputs); ++j) {
        int furthest = 0;
        for (size_t i = 0; i < own; ++i)
            if (terms[i].input == j) furthest = std::max(furthest, terms[i].lag);
        for (int i = 1; i <= n; ++i) terms.push_back({"", "", j, furthest + i});
    }
    return terms;
}

/// Further lags of each input, so that they are as many as the past outputs.
Index least_further_lags(std::vector<Term> const& terms, Index inputs) {
    return (past_outputs(terms) + inputs - 1) / inputs;
}

Rows fitted_rows(std::vector<Term> const& terms, Record const& record) {
    return rows_of(terms, record.inputs, record.y).before(record.fitted);
}

/// What both need; "": nothing stands against them.
std::string obstacle_of_any(IdentifyOptions const& o, std::vector<Term> const& terms, int n) {
    return n < 1 ? fmt::format("expected a whole number from 1 on, found {}", n)
           : past_outputs(terms) == 0
               ? "expected past outputs in the equation (--na 1 or more): without them coloured noise causes no bias"
           : o.forgetting != 1
               ? "does not go with --forgetting below 1: its standard deviations are those of lambda = 1"
               : "";
}
std::string obstacle_of_noise_model(IdentifyOptions const& o, std::vector<Term> const& terms, Record const& record,
                                    int n) {
    if (std::string const any = obstacle_of_any(o, terms, n); !any.empty()) return any;
    Index const rows = fitted_rows(terms, record).records.rows(), d = Index(terms.size());
    if (rows > d + n) return "";
    return fmt::format("{} rows are too few for {} parameters and {} of the noise: expected a smaller number", rows, d,
                       n);
}
std::string obstacle_of_instruments(IdentifyOptions const& o, std::vector<Term> const& terms, Record const& record,
                                    int n) {
    if (o.inputs.empty()) return "expected an input (--input), too: its further past lags are the instruments";
    if (std::string const any = obstacle_of_any(o, terms, n); !any.empty()) return any;
    Index const q = past_outputs(terms), least = least_further_lags(terms, Index(o.inputs.size()));
    if (n < least)
        return fmt::format(
            "expected {} or more: the further lags of the inputs are to be as many as the {} past outputs", least, q);
    std::vector<Term> const all = with_further_lags(terms, o.inputs.size(), n);
    Index const rows = presample(all) < record.fitted ? fitted_rows(all, record).records.rows() : 0;
    if (rows > Index(all.size()) - q) return "";
    return fmt::format("{} rows have all {} instruments: expected a smaller number", rows, Index(all.size()) - q);
}

/// take(row, sample) for each row, pass(sample) for each sample before `end` that has none, from the first row's on.
void for_each_sample(Rows const& rows, Index end, auto take, auto pass) {
    Index k = 0;
    for (Index at = rows.records.presample; at < end; ++at)
        if (k < Index(rows.samples.size()) && rows.samples[size_t(k)] == at) take(k++, at - rows.records.presample);
        else pass(at - rows.records.presample);
}

/// y less the first d terms, less(sample, e) of the residuals e before, for each sample that has a row; NaN for others.
Vector<double> residuals_of(Rows const& rows, Index samples, Index d, Vector<double> const& theta, auto const& less) {
    Records const& r = rows.records;
    Vector<double> e = Vector<double>::Constant(samples, NAN);
    for (Index k = 0; k < r.rows(); ++k) {
        Index const at = rows.samples[size_t(k)] - r.presample;
        double x = r.y[k];
        for (Index i = 0; i < d; ++i) x -= r.psi(i, k) * theta[i];
        e[at] = less(x, at, e);
    }
    return e;
}

/// Variance and test of the residuals (NaN: missing), of so many rows; `extra` parameters besides the equation's.
void judge(Cured& out, Structure const& structure, Vector<double> const& residuals, double largest_y, int extra) {
    Index const d = Index(structure.terms.size()) + extra;
    double J = 0;
    for (double const e : residuals)
        if (!std::isnan(e)) J += e * e;
    out.sigma2 = J / double(out.rows - d);
    bool const rounding = J <= rounding_alone(out.rows, largest_y);
    out.ljung_box = ljung_box(rounding ? Vector<double>(Vector<double>::Zero(residuals.size())) : residuals,
                              ljung_box_lags(residuals.size(), std::max(structure.order, extra)),
                              past_outputs(structure.terms) + extra);
}

std::vector<CuredParameter> parameters_of(Structure const& structure, Estimate const& estimate, auto const& theta) {
    std::vector<CuredParameter> out;
    for (size_t i = 0; i < structure.terms.size(); ++i)
        out.push_back({structure.terms[i].name, structure.terms[i].regressor, theta[Index(i)], NAN,
                       estimate.parameters[i].value});
    return out;
}

/// The variance of each number of theta in noise v of any colour. x: P psihat of each sample; v: 0 where it is missing.
Vector<double> sandwich(Matrix<double> const& x, Signal const& v, Index freedom) {
    Index const N = x.cols(), L = std::min<Index>({N - 1, Index(std::sqrt(double(N))), 200});
    Signal const r = correlation(v, v, L);
    Vector<double> out(x.rows());
    for (Index i = 0; i < x.rows(); ++i) {
        Vector<double> const of = x.row(i).transpose();
        Signal const own(of.begin(), of.end()), s = correlation(own, own, L);
        double sum = r[0] * s[0];
        for (Index lag = 1; lag <= L; ++lag)
            sum += 2 * (1 - double(lag) / double(L + 1)) * r[size_t(lag)] * s[size_t(lag)];
        out[i] = sum * double(N) * (double(N) / double(freedom));
    }
    return out;
}

}  // namespace

Prior<double> prior_of(Estimate const& estimate, int more, double further) {
    Index const d = Index(estimate.scales.size());
    Vector<double> P0 = Vector<double>::Constant(d + more, further);
    for (Index i = 0; i < d; ++i) P0[i] = absolute_square(estimate.c / estimate.scales[size_t(i)]);
    return {.covariance = Matrix<double>(P0.asDiagonal())};
}

Vector<double> limit_deviations(Matrix<double> const& phi, std::vector<double> const& c, Matrix<double> const& P,
                                double sigma2) {
    Matrix<double> z = phi;
    for (Index k = 0; k < phi.cols(); ++k)
        for (Index i = 1; i <= std::min<Index>(k, Index(c.size())); ++i) z.col(k) -= c[size_t(i - 1)] * z.col(k - i);
    Vector<double> const unit = P.diagonal().cwiseSqrt();
    using Square = Matrix<double>;
    auto const between = [](Square const& F, Square const& X) { return product(product(F, X), Square(F.transpose())); };
    Square const scaled = unit.cwiseInverse().asDiagonal() * P * unit.cwiseInverse().asDiagonal(),
                 moments = product(Square(unit.asDiagonal() * phi), Square(z.transpose() * unit.asDiagonal())),
                 A = product(scaled, moments), I = Square::Identity(A.rows(), A.cols());  // A = M + I/2
    Square const inverse = Matrix<Quad>(A.cast<Quad>()).inverse().cast<double>();  // of doubles: panels, by processor
    Square F = product(inverse, Square(A - I)), X = between(inverse, scaled);
    auto const squares = [&F] { return dot(F.data(), F.data(), F.size()); };
    for (int j = 0; j < 60 && squares() > 1e-40 && F.allFinite(); ++j) X += between(F, X), F = product(F, F);
    return (squares() <= 1e-40 ? std::sqrt(sigma2) : NAN) * unit.cwiseProduct(X.diagonal().cwiseSqrt());
}

void expect_cures(IdentifyOptions const& o, Structure const& structure, Record const& record) {
    auto const expect = [](char const* option, std::string const& obstacle) {
        if (!obstacle.empty()) refuse("{}: {}", option, obstacle);
    };
    if (o.noise_model) expect("--noise-model", obstacle_of_noise_model(o, structure.terms, record, *o.noise_model));
    if (o.instruments) expect("--instruments", obstacle_of_instruments(o, structure.terms, record, *o.instruments));
}

double farthest_from_one(std::vector<double> const& c) {
    int const n = int(c.size());
    double most = 0;
    if (n <= 2)
        for (double const x : c) most += std::abs(x);
    else
        for (int k = 0; k <= 32 * n; ++k) {  // C(e^iw) and C(e^-iw) are as far off
            double re = 0, im = 0;
            for (int i = 1; i <= n; ++i) {
                double const w = 2 * std::numbers::pi * (k * i % (64 * n)) / (64 * n);
                re += c[size_t(i - 1)] * correctly::cos(w), im += c[size_t(i - 1)] * correctly::sin(w);
            }
            most = std::max(most, std::sqrt(re * re + im * im));
        }
    return most;
}

Cured with_noise_model(IdentifyOptions const& options, Structure const& structure, Record const& record,
                       Estimate const& estimate) {
    if (estimate.noise_free)
        refuse("--noise-model: the residuals are rounding errors alone: expected a record with noise");
    int const n = *options.noise_model;
    Rows const rows = fitted_rows(structure.terms, record);
    Records const& r = rows.records;
    Index const d = r.parameters(), N = record.fitted - r.presample;
    Cured out{.of_noise = true, .order = n, .rows = r.rows()};
    ExtendedLeastSquares<Ud<double>> f({.size = d + n, .prior = prior_of(estimate, n, 1 / estimate.sigma2)}, n);
    Matrix<double> phi = Matrix<double>::Zero(d + n, N);
    for_each_sample(
        rows, record.fitted,
        [&](Index k, Index at) {
            out.health = worse(out.health, f.update(r.sample(k), r.y[k]).health);
            for (Index i = 0; i < d + n; ++i) phi(i, at) = f.phi()[i];
        },
        [&](Index) { f.pass_time(); });
    Vector<double> const theta = f.theta();
    judge(out, structure,
          residuals_of(rows, N, d, theta,
                       [&](double x, Index at, Vector<double> const& e) {
                           for (Index i = 1; i <= std::min<Index>(n, at); ++i)
                               if (!std::isnan(e[at - i])) x -= theta[d + i - 1] * e[at - i];
                           return x;
                       }),
          r.y.cwiseAbs().maxCoeff(), n);
    out.parameters = parameters_of(structure, estimate, theta);
    std::vector<double> const c(theta.begin() + d, theta.end());
    for (int i = 1; i <= n; ++i)
        out.parameters.push_back({fmt::format("c{}", i), fmt::format("e[k-{}]", i), c[size_t(i - 1)], NAN, NAN});
    out.farthest = farthest_from_one(c);
    if (!(out.farthest < 1)) return out;
    Vector<double> const sd = limit_deviations(phi, c, f.filter().covariance(), out.sigma2);
    for (Index i = 0; i < d + n; ++i) out.parameters[size_t(i)].sd = sd[i];
    return out;
}

Cured with_instruments(IdentifyOptions const& options, Structure const& structure, Record const& record,
                       Estimate const& estimate) {
    int const n = *options.instruments;
    Rows const rows = fitted_rows(with_further_lags(structure.terms, options.inputs.size(), n), record);
    Records const& r = rows.records;
    Index const d = Index(structure.terms.size()), q = past_outputs(structure.terms), m = r.parameters() - q,
                N = record.fitted - r.presample;
    Records const zeta{.psi = r.psi.bottomRows(m), .y = r.y, .presample = r.presample};
    Cured out{.order = n, .rows = r.rows()};
    InstrumentalVariables<Ud<double>> f({.size = d, .prior = prior_of(estimate)},
                                        {.size = m, .prior = default_prior(zeta, 1).prior()}, q);
    Matrix<double> psihat = Matrix<double>::Zero(d, N);
    for_each_sample(
        rows, record.fitted,
        [&](Index k, Index at) {
            Vector<double> const psi = r.psi.col(k).head(d);
            out.health = worse(out.health, f.update(psi, zeta.sample(k), r.y[k]).health);
            for (Index i = 0; i < d; ++i) psihat(i, at) = f.psihat()[i];
        },
        [&](Index) { f.pass_time(); });
    Vector<double> const theta = f.theta(),
                         v = residuals_of(rows, N, d, theta, [](double x, Index, auto const&) { return x; });
    judge(out, structure, v, r.y.cwiseAbs().maxCoeff(), 0);
    out.parameters = parameters_of(structure, estimate, theta);
    Vector<double> const variances =
        sandwich(product(f.filter().covariance(), psihat), zero_filled(Signal(v.begin(), v.end()), 0, N), out.rows - d);
    for (Index i = 0; i < d; ++i) out.parameters[size_t(i)].sd = std::sqrt(variances[i]);
    return out;
}

std::string cure_for(Identified const& m, Record const& record) {
    IdentifyOptions const& o = m.options;
    bool const a_higher_order_passes =
        !structure_given(o) && std::ranges::any_of(m.choice.fits, [&](OrderFit const& f) {
            return f.order > m.order && f.ljung_box >= white_level;
        });
    if (o.noise_model || o.instruments || a_higher_order_passes || m.noise_free || !m.past_inputs.empty()) return "";
    Index const inputs = Index(o.inputs.size());
    std::string out;
    if (obstacle_of_noise_model(o, m.terms, record, 2).empty()) out = "--noise-model 2";
    int const least = inputs > 0 ? int(least_further_lags(m.terms, inputs)) : 0;
    if (obstacle_of_instruments(o, m.terms, record, least).empty())
        out += fmt::format("{}--instruments {}", out.empty() ? "" : " ", least);
    return out;
}

}  // namespace rlslab::identify
