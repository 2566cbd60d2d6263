// The steps in order: read, excitation, order, the variant's recursion, what is left unexplained.
#include "identify/identify.hpp"

#include "identify/checks.hpp"
#include "identify/structure.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/model/counting.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Data {
    std::vector<Signal> inputs;
    Signal y;
    std::vector<std::string> warnings;
};

Data read(DataFile const& file, IdentifyOptions const& options) {
    std::vector<std::string> names = options.inputs;
    names.push_back(options.output);
    for (std::string const& name : names)
        if (std::ranges::count(names, name) > 1)
            throw InputError(fmt::format("{}: column \"{}\" is asked for twice", name_of_file(file.path), printable(name)));
    Columns const columns = read_data(file, names);
    Data out;
    for (std::string const& name : names) {
        Signal const& values = without_missing(columns, name);
        (name == options.output ? out.y : out.inputs.emplace_back()) = values;
    }
    out.warnings = counting_warnings(columns, options.inputs);
    return out;
}

double take_mean(Signal& x, Index fitted) {
    double mean = 0;
    for (Index k = 0; k < fitted; ++k) mean += x[size_t(k)] / double(fitted);
    for (double& v : x) v -= mean;
    return mean;
}

double largest(Signal const& x, Index count) {
    double out = 0;
    for (Index k = 0; k < count; ++k) out = std::max(out, std::abs(x[size_t(k)]));
    return out;
}

/// Correlation of the residuals with x, scaled by both powers.
Signal scaled_correlation(Signal const& eps, Signal const& x, Index lags) {
    Signal out = correlation(eps, x, lags);
    double const scale = std::sqrt(correlation(eps, eps, 0)[0]) * std::sqrt(correlation(x, x, 0)[0]);
    for (double& r : out) r = scale > 0 ? r / scale : 0;
    return out;
}

/// What the inputs can identify, over the part that is fitted: the order they support, `most` at best.
Index supported_order(Identified& out, Data const& data, Index fitted, Index most, std::vector<Index> const& coefficients,
                      Progress const& progress) {
    IdentifyOptions const& options = out.options;
    Index supported = most;
    for (size_t j = 0; j < data.inputs.size(); ++j) {
        Signal const u(data.inputs[j].begin(), data.inputs[j].begin() + fitted);
        Excitation const e = excitation(u, coefficients[j], {.progress = [&](double part) {
                                            if (progress) progress((double(j) + part) / double(data.inputs.size()));
                                        }});
        std::string const name = printable(options.inputs[j]);
        if (e.order < coefficients[j]) {
            supported = std::min(supported, e.order - 1);
            out.warnings.push_back(e.order >= 2 ? fmt::format("input {} is exciting of order {} only: it supports a model of order {}. An "
                                                              "input that changes more often, or at more "
                                                              "frequencies, supports a higher one",
                                                              name, e.order, e.order - 1)
                                                : fmt::format("input {} is exciting of order {} only", name, e.order));
        }
        constexpr Index long_enough = 20;  // a PRBS of long levels may well begin with one
        if (e.constant_at_start > long_enough && e.order > 0)
            out.warnings.push_back(
                fmt::format("input {} stands still over the first {} of {} fitted samples: they say nothing of the dynamics; cut them off",
                            name, e.constant_at_start, fitted));
        out.excitation.push_back(e);
    }
    return supported;
}

void predict(Identified& out, Data const& data, Records const& all, Vector<double> const& theta) {
    size_t const inputs = data.inputs.size();
    Index const first = all.presample, begin = out.samples - out.held_out;
    out.model = equation_of(out.terms, theta, inputs);
    out.poles = poles(out.model);
    for (size_t j = 0; j < inputs; ++j) out.zeros.push_back(zeros(out.model, j));
    Vector<double> predicted(all.rows());
    for (Index k = 0; k < all.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < all.parameters(); ++i) sum += all.psi(i, k) * theta[i];
        predicted[k] = sum;
    }
    Signal const free = simulate_from(out.model, data.inputs, data.y, first);
    out.fit_one_step = fit_percent(all.y.head(out.fitted), predicted.head(out.fitted));
    if (out.held_out) out.held_out_one_step = fit_percent(all.y.tail(out.held_out), predicted.tail(out.held_out));
    if (out.held_out > first) {  // simulated from its own first outputs
        auto const tail = [&](Signal const& x) { return Signal(x.begin() + begin - first, x.end()); };
        std::vector<Signal> later;
        for (Signal const& u : data.inputs) later.push_back(tail(u));
        Signal const there = simulate_from(out.model, later, tail(data.y), first);
        out.held_out_simulated = fit_percent(Eigen::Map<Vector<double> const>(data.y.data() + begin, out.held_out),
                                             Eigen::Map<Vector<double> const>(there.data() + first, out.held_out));
    }
    Vector<double> const residuals = all.y.head(out.fitted) - predicted.head(out.fitted);
    Index const lags = ljung_box_lags(out.fitted, out.order), outputs = past_outputs(out.terms);
    double J = 0;
    for (double const x : residuals) J += x * x;
    bool const nothing_left = J <= rounding_alone(out.fitted, all.y.head(out.fitted).cwiseAbs().maxCoeff());
    out.ljung_box = ljung_box(nothing_left ? Vector<double>(Vector<double>::Zero(out.fitted)) : residuals, lags, outputs);
    Signal const eps(residuals.data(), residuals.data() + residuals.size());
    out.auto_correlation = scaled_correlation(eps, eps, lags);
    for (Signal const& u : data.inputs)
        out.cross_correlation.push_back(scaled_correlation(eps, Signal(u.begin() + first, u.begin() + first + out.fitted), lags));
    for (Index k = 0; k < all.rows(); ++k) {
        out.measured.push_back(all.y[k] + out.means.back());
        out.one_step.push_back(predicted[k] + out.means.back());
        out.simulated.push_back(free[size_t(first + k)] + out.means.back());
    }
}

}  // namespace

Signal const& without_missing(Columns const& columns, std::string const& name) {
    Signal const& values = columns[name];
    auto const missing = std::ranges::find_if(values, [](double x) { return x != x; });
    if (missing != values.end())
        throw InputError(fmt::format("{}:{}: column \"{}\": expected a number in every row, found a missing value", columns.file,
                                     columns.lines[size_t(missing - values.begin())], printable(name)));
    return values;
}

Identified identify(DataFile const& from, IdentifyOptions const& asked, Progress const& progress) {
    Identified out{};
    IdentifyOptions const& options = out.options = completed(asked);
    std::string const file = out.file = printable(from.path, 200);
    entry_of(options.variant);
    Data data = read(from, options);
    out.warnings = data.warnings;
    Index const samples = out.samples = Index(data.y.size()), inputs = Index(data.inputs.size());
    out.held_out = Index(std::floor(options.validate * double(samples)));
    Index const fitted_samples = samples - out.held_out;
    if (std::ranges::all_of(data.y, [&](double v) { return v == data.y[0]; }))
        throw InputError(fmt::format("{}: column \"{}\" does not change: there is nothing to model", file, printable(options.output)));
    if (std::all_of(data.y.begin(), data.y.begin() + fitted_samples, [&](double v) { return v == data.y[0]; }))
        throw InputError(fmt::format("{}: column \"{}\" does not change over the {} samples that are fitted: expected a smaller --validate",
                                     file, printable(options.output), fitted_samples));

    bool const given = structure_given(options);
    int const most = given ? 0 : options.max_order;
    std::vector<Term> const widest = terms_of(options, most);
    Index const needed = presample(widest) + Index(widest.size()) + 1;
    if (fitted_samples < needed)
        throw InputError(fmt::format("{}: {} has {} parameters and needs at least {} samples to fit, found {}: expected a lower order{}",
                                     file, structure_text(options, most), widest.size(), needed, fitted_samples,
                                     out.held_out > 0 ? ", or a smaller --validate" : ""));
    for (Index j = 0; j <= inputs; ++j) {
        Signal& x = j < inputs ? data.inputs[size_t(j)] : data.y;
        out.means.push_back(options.detrend ? take_mean(x, fitted_samples) : 0.0);
        // Squares of what is left must not underflow.
        if (double const size = largest(x, fitted_samples); size > 0 && size < 0x1p-400)
            throw InputError(
                fmt::format("{}: column \"{}\" is {:.2g} in size at most: expected moderate numbers; multiply it by a power of ten", file,
                            printable(j < inputs ? options.inputs[size_t(j)] : options.output), size));
    }

    // An input of m coefficients must be exciting of order m.
    std::vector<Index> coefficients(size_t(inputs), 0);
    for (Term const& t : widest)
        if (t.input >= 0) ++coefficients[size_t(t.input)];
    Index const highest = *std::ranges::max_element(coefficients) - 1,
                supported = supported_order(out, data, fitted_samples, highest, coefficients, progress);
    if (given ? supported < highest : supported < 1)
        throw InputError(fmt::format(
            "{}: {} ({})", file,
            supported < 1   ? "the input does not excite the system: it supports no model of order 1 or more"
            : options.order ? fmt::format("order {} cannot be identified from this input; it supports order {}", options.order, supported)
                            : fmt::format("{} coefficients of an input cannot be identified from this record; it supports {}", highest + 1,
                                          supported + 1),
            fmt::join(out.warnings, "; ")));

    if (options.regressors.empty() && !options.na) {
        int const up_to = given ? options.order : int(std::min<Index>(most, supported));
        out.choice = choose_order(order_columns(data.inputs, data.y, up_to, options.delay, options.intercept), up_to, out.held_out);
        if (out.choice.fits.size() < 2)
            throw InputError(fmt::format("{}: the output, the inputs and their past are linearly dependent already at order 1", file));
    }
    out.terms = given ? widest : terms_of(options, out.choice.order);
    out.order = given ? order_of(widest, options.delay) : out.choice.order;
    out.structure = structure_text(options, given ? 0 : out.order);
    out.why = given ? "given" : out.choice.why;

    Records const all = records_of(out.terms, data.inputs, data.y);
    out.fitted = all.rows() - out.held_out;
    Records const fitted{.psi = all.psi.leftCols(out.fitted), .y = all.y.head(out.fitted), .names = all.names};
    Problem<double> const problem{.size = fitted.parameters(), .prior = std::nullopt};
    CertifiedSolution const exact = certified(problem, fitted, {fitted.rows()}).front();
    if (exact.status() != Status::certified)
        throw InputError(fmt::format("{}: {}: the regressors are linearly dependent (exact rank {} of {})", file, out.structure,
                                     exact.rank(), fitted.parameters()));
    Estimation const estimation = estimate(out, fitted);

    Vector<double> const& theta = out.trajectory.back().theta;
    for (Index i = 0; i < fitted.parameters(); ++i) {
        double const value = std::isfinite(theta[i]) ? theta[i] : nan, reach = out.quantile * estimation.sd[i];
        out.parameters.push_back(
            {out.terms[size_t(i)].name, out.terms[size_t(i)].of, value, estimation.sd[i], value - reach, value + reach});
    }
    out.aic = out.bic = out.fpe = out.fit_one_step = out.held_out_one_step = out.held_out_simulated = nan;
    out.ljung_box = {nan, nan, 0, 0};
    out.bound = 2.5758293035489004 / std::sqrt(double(out.fitted));  // the normal distribution's 99.5 %
    if (theta.allFinite()) {
        predict(out, data, all, theta);
        out.cancellations = cancellations(out.model, out.terms, estimation, options.confidence);
        for (size_t j = 0; j < data.inputs.size(); ++j) {
            auto const [gain, sd] = gain_of(out.model, out.terms, estimation, j, out.quantile);
            out.gain.push_back(gain), out.gain_sd.push_back(sd);
        }
    }
    if (options.forgetting == 1) {
        double const J = std::max(out.sigma2 * out.freedom, rounding_alone(out.fitted, fitted.y.cwiseAbs().maxCoeff()));
        std::tie(out.aic, out.bic, out.fpe) = [](Criteria const& c) {
            return std::tuple(c.aic, c.bic, c.fpe);
        }(criteria(J, out.fitted, fitted.parameters()));
    }
    if (!options.composition.empty()) {
        Vector<double> const scales = Eigen::Map<Vector<double> const>(out.scales.data(), Index(out.scales.size()));
        Matrix<double> const P0 = (out.c / scales.array()).square().matrix().asDiagonal();
        out.tracked = track(options.composition, options.variant,
                            {.size = P0.rows(), .forgetting = options.forgetting, .prior = Prior<double>{.covariance = P0}}, all,
                            out.means.back(), out.sigma2, options.confidence);
    }
    advise(out, given ? 0 : int(std::min<Index>(most, supported)));
    return out;
}

}  // namespace rlslab
