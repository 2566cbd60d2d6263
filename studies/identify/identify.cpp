// The steps in order: read, excitation, order, the variant's recursion, what is left unexplained.
#include "identify.hpp"

#include <rlslab/model/suggestion.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

namespace rlslab {
namespace {

struct Data {
    std::vector<Signal> inputs;
    Signal y;
};

Data read(std::string const& file, IdentifyOptions const& options) {
    std::vector<std::string> names = options.inputs;
    if (names.empty()) throw InputError("--input: expected the name of an input column, or several: a,b");
    names.push_back(options.output);
    for (size_t i = 0; i < names.size(); ++i)
        if (std::ranges::count(names, names[i]) > 1)
            throw InputError(fmt::format("{}: column \"{}\" is asked for twice", printable(file, 200), printable(names[i])));
    Columns const columns = read_columns(file, names);
    Data out;
    for (std::string const& name : names) {
        Signal const& values = columns[name];
        auto const missing = std::ranges::find_if(values, [](double x) { return x != x; });
        if (missing != values.end())
            throw InputError(fmt::format("{}:{}: column \"{}\": expected a number in every row, found a missing value", printable(file, 200),
                                         columns.lines[size_t(missing - values.begin())], printable(name)));
        (name == options.output ? out.y : out.inputs.emplace_back()) = values;
    }
    return out;
}

double take_mean(Signal& x, Index fitted) {
    double mean = 0;
    for (Index k = 0; k < fitted; ++k) mean += x[size_t(k)] / double(fitted);
    for (double& v : x) v -= mean;
    return mean;
}

/// Correlation of the residuals with x, scaled by both powers.
Signal scaled_correlation(Signal const& eps, Signal const& x, Index lags) {
    Signal out = correlation(eps, x, lags);
    double const scale = std::sqrt(correlation(eps, eps, 0)[0] * correlation(x, x, 0)[0]);
    for (double& r : out) r = scale > 0 ? r / scale : 0;
    return out;
}

Entry const& entry_of(std::string const& variant) {
    std::vector<std::string_view> known;
    for (Entry const& e : catalogue())
        if (e.arithmetic->name == "double") known.push_back(e.variant);
    expect_one_of(known, variant, "--variant", "variant");
    return *std::ranges::find_if(catalogue(), [&](Entry const& e) { return e.arithmetic->name == "double" && e.variant == variant; });
}

/// Feeds the variant, looking at theta and P now and then.
void estimate(Identified& out, Records const& records) {
    IdentifyOptions const& options = out.options;
    Entry const& entry = entry_of(options.variant);
    Problem<double> const problem{.size = records.size(), .forgetting = options.forgetting, .prior = Prior<double>{.variance = options.p0}};
    constexpr Index points = 100;
    std::vector<Index> checkpoints;
    for (Index i = 1; i <= points; ++i)
        if (Index const row = std::max<Index>(1, i * records.rows() / points); checkpoints.empty() || row > checkpoints.back()) checkpoints.push_back(row);
    std::vector<Exact> const exact = certified(problem, records, checkpoints);
    auto const filter = entry.make(problem, Seed{1});
    Vector<double> theta(records.size());
    Index k = 0;
    for (size_t i = 0; i < checkpoints.size(); ++i) {
        filter->absorb(records, k, checkpoints[i]);
        k = checkpoints[i];
        Vector<Reference> const wide = filter->theta();
        TrajectoryPoint point{k, Vector<double>(records.size()), Vector<double>(records.size())};
        Matrix<Reference> const P = exact[i].covariance();
        for (Index j = 0; j < records.size(); ++j) {
            point.theta[j] = static_cast<double>(wide[j]);
            point.sd[j] = std::sqrt(static_cast<double>(P(j, j)));
        }
        out.trajectory.push_back(std::move(point));
    }
    theta = out.trajectory.back().theta;
    // With weights w_k = lambda^(N-k): cov theta = sigma^2 P M P, M = sum w_k^2 psi psi', and E J = sigma^2 (sum w_k - tr P M).
    Index const d = records.size();
    Matrix<double> const P = exact.back().covariance().cast<double>();
    Matrix<double> M = Matrix<double>::Zero(d, d);
    double J = 0, weight = 0;
    for (Index row = 0; row < records.rows(); ++row) {
        double predicted = 0;
        for (Index j = 0; j < records.size(); ++j) predicted += records.psi(j, row) * theta[j];
        J = options.forgetting * J + (records.y[row] - predicted) * (records.y[row] - predicted);
        weight = options.forgetting * weight + 1;
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) M(i, j) = options.forgetting * options.forgetting * M(i, j) + records.psi(i, row) * records.psi(j, row);
    }
    Matrix<double> const PM = P.lazyProduct(M), PMP = PM.lazyProduct(P);
    double used = 0;
    for (Index j = 0; j < d; ++j) used += PM(j, j);
    if (!(weight - used > 1))
        throw InputError(fmt::format("--forgetting: lambda = {} remembers about {:.0f} rows, too few for {} parameters", options.forgetting, weight, d));
    out.sigma2 = J / (weight - used);
    for (TrajectoryPoint& point : out.trajectory)
        for (Index j = 0; j < d; ++j) point.sd[j] *= std::sqrt(out.sigma2 * PMP(j, j) / P(j, j));
    out.quantile = quantile(boost::math::students_t(weight - used), 0.5 + options.confidence / 2);
    // What is wrong for another reason than noise, against what noise does.
    Problem<double> free = problem;
    free.prior.reset();
    Vector<Reference> const best = exact.back().theta(), without = certified(free, records, {records.rows()}).front().theta();
    bool rounded = false, biased = false;
    double scale = 0;
    for (Reference const& x : without) scale = std::max(scale, std::abs(static_cast<double>(x)));
    for (Index j = 0; j < d; ++j) {
        double const tenth = 0.1 * out.trajectory.back().sd[j] + 1e-9 * scale;
        rounded = rounded || !(std::abs(static_cast<double>(best[j]) - theta[j]) <= tenth);
        biased = biased || !(std::abs(static_cast<double>(Reference(best[j] - without[j]))) <= tenth);
    }
    if (rounded)
        out.warnings.push_back(fmt::format("{} has lost digits to rounding, more than the noise hides: another --variant (ud), or a smaller --p0", options.variant));
    if (biased) out.warnings.push_back("the prior moves the estimate by more than the noise does: a larger --p0");
    out.digits = std::min(exact.back().theta_digits(filter->theta()), 15.95);
    out.digits_worst = std::min(exact.back().theta_digits_worst(filter->theta()), 15.95);
}

}  // namespace

Identified identify(std::string const& path, IdentifyOptions const& asked, Progress const& progress) {
    IdentifyOptions options = asked;
    // Means of a window are not the equation's means: what taking them off leaves is a constant.
    options.intercept = options.intercept || options.detrend;
    std::string const file = printable(path, 200);
    entry_of(options.variant);
    Data data = read(path, options);
    if (std::ranges::all_of(data.y, [&](double v) { return v == data.y[0]; }))
        throw InputError(fmt::format("{}: column \"{}\" does not change: there is nothing to model", file, printable(options.output)));
    Index const samples = Index(data.y.size());
    int const most = options.order ? options.order : options.max_order;
    Index const inputs = Index(data.inputs.size()), widest = Index(most) * (1 + inputs) + inputs + options.intercept;
    Index const held_out = Index(std::floor(options.validate * double(samples))), fitted_samples = samples - held_out;
    if (fitted_samples < most + options.delay + widest + 1)
        throw InputError(fmt::format("{}: order {} has {} parameters and needs at least {} samples to fit, found {}", file, most, widest,
                                     most + options.delay + widest + 1, fitted_samples));
    Identified out;
    out.file = file, out.options = options, out.samples = samples;
    if (options.detrend) {
        for (Signal& u : data.inputs) out.means.push_back(take_mean(u, fitted_samples));
        out.means.push_back(take_mean(data.y, fitted_samples));
    } else {
        out.means.assign(size_t(inputs + 1), 0.0);
    }

    // What the input can identify, over the part that is fitted.
    Index supported = most;
    for (size_t i = 0; i < data.inputs.size(); ++i) {
        Signal const u(data.inputs[i].begin(), data.inputs[i].begin() + fitted_samples);
        Excitation const e = excitation(u, most + 1, [&](double part) {
            if (progress) progress((double(i) + part) / double(data.inputs.size()));
        });
        if (e.order < most + 1) {
            supported = std::min(supported, std::max<Index>(0, e.order - 1));
            out.warnings.push_back(fmt::format("input {} is exciting of order {} only: it supports a model of order {}", printable(options.inputs[i]),
                                               e.order, std::max<Index>(0, e.order - 1)));
        }
        constexpr Index long_enough = 20;    // a PRBS of long levels may well begin with one
        if (e.still > long_enough && e.order > 0)
            out.warnings.push_back(fmt::format("input {} stands still over the first {} of {} fitted samples: they say nothing of the dynamics",
                                               printable(options.inputs[i]), e.still, fitted_samples));
        out.excitation.push_back(e);
    }
    if (supported < 1)
        throw InputError(fmt::format("{}: the input does not excite the system: it supports no model of order 1 or more ({})", file,
                                     fmt::join(out.warnings, "; ")));
    if (options.order && supported < options.order)
        throw InputError(fmt::format("{}: order {} cannot be identified from this input; it supports order {} ({})", file, options.order, supported,
                                     fmt::join(out.warnings, "; ")));

    OrderColumns const columns = order_columns(data.inputs, data.y, int(std::min<Index>(most, supported)), options.delay, options.intercept);
    out.choice = choose_order(columns, int(std::min<Index>(most, supported)), held_out);
    if (out.choice.fits.size() < 2)
        throw InputError(fmt::format("{}: the output, the inputs and their past are linearly dependent already at order 1", file));
    out.order = options.order ? options.order : out.choice.order;
    out.why = options.order ? "given" : out.choice.why;

    Arx const model{.na = out.order, .nb = out.order, .delay = options.delay, .intercept = options.intercept, .inputs = int(inputs)};
    std::vector<std::span<double const>> spans(data.inputs.begin(), data.inputs.end());
    Records all = arx_records(spans, options.inputs, data.y, model, file);
    out.held_out = held_out;
    out.fitted = all.rows() - held_out;
    Records const fitted{.psi = all.psi.leftCols(out.fitted), .y = all.y.head(out.fitted), .names = all.names};
    Problem<double> problem{.size = fitted.size(), .prior = std::nullopt};
    Exact const exact = certified(problem, fitted, {fitted.rows()}).front();
    if (exact.status() != Status::certified)
        throw InputError(fmt::format("{}: at order {} the regressors are linearly dependent (exact rank {} of {})", file, out.order, exact.rank(),
                                     fitted.size()));
    out.condition = condition(fitted, options.forgetting);
    estimate(out, fitted);

    double const t = out.quantile;
    TrajectoryPoint const& last = out.trajectory.back();
    for (Index i = 0; i < fitted.size(); ++i)
        out.parameters.push_back({fitted.names[size_t(i)], last.theta[i], last.sd[i], last.theta[i] - t * last.sd[i], last.theta[i] + t * last.sd[i]});

    DifferenceEquation& equation = out.model;
    equation.delay = options.delay;
    equation.a.assign(last.theta.data(), last.theta.data() + model.na);
    for (Index j = 0; j < inputs; ++j) {
        double const* const b = last.theta.data() + model.na + j * (model.nb + 1);
        equation.b.emplace_back(b, b + model.nb + 1);
    }
    if (options.intercept) equation.c = last.theta[last.theta.size() - 1];
    out.poles = poles(equation);
    for (size_t j = 0; j < equation.b.size(); ++j) out.zeros.push_back(zeros(equation, j));

    Vector<double> predicted(all.rows());
    for (Index k = 0; k < all.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < all.size(); ++i) sum += all.psi(i, k) * last.theta[i];
        predicted[k] = sum;
    }
    Index const first = all.lead_in;
    Signal const free = simulate_from(equation, data.inputs, data.y, first);
    // The held-out part is simulated from its own first outputs.
    Index const begin = samples - held_out;
    auto const tail = [&](Signal const& x, Index from) { return Signal(x.begin() + from, x.end()); };
    out.fit_one_step = fit_percent(fitted.y, predicted.head(out.fitted));
    out.held_out_one_step = held_out ? fit_percent(all.y.tail(held_out), predicted.tail(held_out)) : std::nan("");
    out.held_out_simulated = std::nan("");
    if (held_out > first) {
        std::vector<Signal> later;
        for (Signal const& u : data.inputs) later.push_back(tail(u, begin - first));
        Signal const there = simulate_from(equation, later, tail(data.y, begin - first), first);
        out.held_out_simulated = fit_percent(Eigen::Map<Vector<double> const>(data.y.data() + begin, held_out),
                                             Eigen::Map<Vector<double> const>(there.data() + first, held_out));
    }
    Vector<double> const residuals = fitted.y - predicted.head(out.fitted);
    Index const lags = whiteness_lags(out.fitted, out.order);
    double J = 0;
    for (double const x : residuals) J += x * x;
    bool const exactly = J <= rounding_alone(out.fitted, fitted.y.cwiseAbs().maxCoeff());
    out.whiteness = exactly ? 1 : whiteness(residuals, lags, out.order);
    Signal const eps(residuals.data(), residuals.data() + residuals.size());
    out.auto_correlation = scaled_correlation(eps, eps, lags);
    for (Signal const& u : data.inputs) out.cross_correlation.push_back(scaled_correlation(eps, Signal(u.begin() + first, u.begin() + first + out.fitted), lags));
    out.bound = 2.576 / std::sqrt(double(out.fitted));    // the normal distribution's 99.5 %
    for (Index k = 0; k < all.rows(); ++k) {
        out.measured.push_back(all.y[k] + out.means.back());
        out.one_step.push_back(predicted[k] + out.means.back());
        out.simulated.push_back(free[size_t(first + k)] + out.means.back());
    }
    if (out.whiteness < 0.01)
        out.warnings.push_back(fmt::format("the residuals are not white (p = {:.2g}): the estimate is biased, and its standard deviations are too small",
                                           out.whiteness));
    for (auto const& pole : out.poles)
        if (std::abs(pole) >= 1) {
            out.warnings.push_back("a pole lies on or outside the unit circle: simulation grows");
            break;
        }
    return out;
}

}  // namespace rlslab
