// The steps in order: read, excitation, order, the variant's recursion, what is left unexplained.
#include "identify/identify.hpp"

#include "identify/checks.hpp"
#include "identify/outliers.hpp"
#include "identify/structure.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/input/counting.hpp>
#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// NaN: a missing value.
struct Data {
    std::vector<Signal> inputs;
    Signal y;
    std::vector<double> resolutions;         ///< of each input, then of the output
    std::vector<long> lines;                 ///< of the file
    std::vector<std::string> counting = {};  ///< inputs that count upwards
};

double largest(Signal const& x, Index count) {
    double out = 0;
    for (Index k = 0; k < count; ++k)
        if (std::abs(x[size_t(k)]) > out) out = std::abs(x[size_t(k)]);
    return out;
}

Data read(DataFile const& file, IdentifyOptions const& options) {
    std::vector<std::string> names = options.inputs;
    names.push_back(options.output);
    for (std::string const& name : names)
        if (std::ranges::count(names, name) > 1)
            throw InputError(fmt::format("{}: column \"{}\" is asked for twice", name_of_file(file.path), printable(name)));
    Columns columns = read_data(file, names);
    Data out{.inputs = {}, .y = columns[options.output], .resolutions = {}, .lines = std::move(columns.lines)};
    for (std::string const& name : options.inputs) out.inputs.push_back(columns[name]);
    for (std::string const& name : names) {
        Signal there = columns[name];
        std::erase_if(there, [](double v) { return std::isnan(v); });
        // Computed numbers that carry some dozens of roundings: columns of condition 1e14 or so.
        out.resolutions.push_back(there.empty() ? 0 : resolution_of(there, 0x1p-46));
    }
    out.counting = counting_warnings(columns, options.inputs);
    return out;
}

/// Of the numbers that are there among the first `count`.
double take_mean(Signal& x, Index count) {
    double mean = 0, there = 0;
    for (Index k = 0; k < count; ++k) there += !std::isnan(x[size_t(k)]);
    for (Index k = 0; k < count; ++k)
        if (!std::isnan(x[size_t(k)])) mean += x[size_t(k)] / there;
    for (double& v : x) v -= mean;
    return mean;
}

bool changes(Signal const& x, Index count) {
    double first = nan;
    for (Index k = 0; k < count; ++k) {
        double const v = x[size_t(k)];
        if (std::isnan(first)) first = v;
        else if (!std::isnan(v) && v != first) return true;
    }
    return false;
}

/// The longest run without a missing value.
Signal longest_run(Signal const& x, Index count) {
    Index begin = 0, best = 0, length = 0;
    for (Index k = 0; k <= count; ++k)
        if (k == count || std::isnan(x[size_t(k)])) {
            if (k - begin > length) best = begin, length = k - begin;
            begin = k + 1;
        }
    return Signal(x.begin() + best, x.begin() + best + length);
}

/// The fit over the samples that were measured.
double fit_of(Signal const& y, Signal const& predicted, Index begin, Index end) {
    Signal measured, there;
    for (size_t k = size_t(begin); k < size_t(end); ++k)
        if (!std::isnan(y[k])) measured.push_back(y[k]), there.push_back(predicted[k]);
    auto const map = [](Signal const& x) { return Eigen::Map<Vector<double> const>(x.data(), Index(x.size())); };
    return measured.empty() ? nan : fit_percent(map(measured), map(there));
}

/// Of those that are there.
double rms_of(Signal const& x, Index begin, Index end) {
    double sum = 0, there = 0;
    for (size_t k = size_t(begin); k < size_t(end); ++k)
        if (!std::isnan(x[k])) sum += x[k] * x[k], ++there;
    return there > 0 ? std::sqrt(sum / there) : 0;
}

/// Correlation of the residuals with x, scaled by both powers.
Signal scaled_correlation(Signal const& eps, Signal const& x, Index lags) {
    Signal out = correlation(eps, x, lags);
    double const scale = std::sqrt(correlation(eps, eps, 0)[0]) * std::sqrt(correlation(x, x, 0)[0]);
    for (double& r : out) r = scale > 0 ? r / scale : 0;
    return out;
}

/// Samples first ... end - 1; a missing one is 0, the mean.
Signal present(Signal const& x, Index first, Index end) {
    Signal out(x.begin() + first, x.begin() + end);
    std::ranges::replace_if(
        out, [](double v) { return std::isnan(v); }, 0.0);
    return out;
}

/// What the inputs can identify, over the part that is fitted: the order they support, `most` at best. as_read: their means are not taken
/// off, so that the resolution of their numbers shows.
Index supported_order(Identified& out, std::vector<Signal> const& as_read, Index fitted, Index most, std::vector<Index> const& coefficients,
                      Progress const& progress) {
    IdentifyOptions const& options = out.options;
    Index supported = most;
    for (size_t j = 0; j < as_read.size(); ++j) {
        Signal const u = longest_run(as_read[j], fitted);
        Excitation const e = excitation(u, coefficients[j], {.constant = options.intercept, .progress = [&](double part) {
                                                                 if (progress) progress((double(j) + part) / double(as_read.size()));
                                                             }});
        std::string const name = printable(options.inputs[j]);
        if (e.order < coefficients[j]) {
            supported = std::min(supported, e.order - 1);
            out.remarks.push_back(
                {Remark::Rank::excitation,
                 e.order >= 2 ? fmt::format("input {} is exciting of order {} only: it supports a model of order {}. An input that "
                                            "changes more often, or at more frequencies, supports a higher one",
                                            name, e.order, e.order - 1)
                              : fmt::format("input {} is exciting of order {} only", name, e.order),
                 "a richer input"});
        } else if (auto const spike = largest_spike(as_read[j], fitted); e.persistent < coefficients[j] && spike.deviations > 10)
            out.remarks.push_back(
                {Remark::Rank::outlier,
                 fmt::format("one value of input {}, in row {}, is {:.2g} standard deviations of the others off their mean, and the "
                             "estimate rests on the rows that have it. If it is wrong, empty its cell, and it is skipped",
                             name, spike.row, spike.deviations),
                 fmt::format("look at row {}", spike.row)});
        else if (e.persistent < coefficients[j])
            out.remarks.push_back(
                {Remark::Rank::excitation,
                 fmt::format("input {} changes {}: its coefficients beyond {} rest on a few rows, and the noise there decides them. An "
                             "input that changes more often says more",
                             name, e.changes == 1 ? "once" : fmt::format("{} times", e.changes), e.persistent),
                 "a richer input"});
        constexpr Index long_enough = 20;  // a PRBS of long levels may well begin with one
        if (e.constant_at_start > long_enough && e.changes > 1 && e.order > 0)
            out.remarks.push_back(
                {Remark::Rank::whiteness,
                 fmt::format("input {} stands still over the first {} of {} fitted samples: they say nothing of the dynamics; cut them off",
                             name, e.constant_at_start, fitted),
                 fmt::format("cut off the first {} samples", e.constant_at_start)});
        out.excitation.push_back(e);
    }
    return supported;
}

/// The residuals that follow past values of an input, by the 99 % bound of all lags of all inputs together. A coloured residual and a
/// coloured input are correlated by chance, too: N times the variance of r is the sum of their correlations' products (Söderström & Stoica
/// 1989, 11.2), which is 1 for white residuals.
void look_for_past_inputs(Identified& out, Data const& data, Index held_out_from) {
    Index const first = presample(out.terms), inputs = Index(data.inputs.size()), lags = Index(out.auto_correlation.size()) - 1;
    for (Index j = 0; j < inputs; ++j) {
        Signal const& r = out.cross_correlation[size_t(j)];
        Signal const u = present(data.inputs[size_t(j)], first, held_out_from), of_u = scaled_correlation(u, u, lags);
        double spread = 1;
        for (Index lag = 1; lag <= lags; ++lag) spread += 2 * out.auto_correlation[size_t(lag)] * of_u[size_t(lag)];
        double const z = normal_quantile(1 - 0.005 / double(inputs * Index(r.size()))),
                     bound = z * std::sqrt(std::max(1.0, spread) / double(out.fitted));
        Index at = 0;
        for (Index lag = 0; lag < Index(r.size()); ++lag)
            if (std::abs(r[size_t(lag)]) > std::abs(r[size_t(at)])) at = lag;
        if (!(std::abs(r[size_t(at)]) > bound)) continue;
        Followed f{int(j), at, r[size_t(at)], bound, at};
        // With all lags of this input to that one in the equation: which counts first?
        std::vector<Term> wide;
        Index nearest = at, furthest = at;
        for (Term const& t : out.terms)
            if (t.input == j) nearest = std::min<Index>(nearest, t.lag), furthest = std::max<Index>(furthest, t.lag);
            else wide.push_back(t);
        Index const from = Index(wide.size()), d = from + furthest - nearest + 1;
        constexpr double most_work = 2e9;
        if (double(d) * double(d) * double(out.fitted) < most_work && 2 * d < out.fitted) {
            for (Index lag = nearest; lag <= furthest; ++lag) wide.push_back({"", "", int(j), int(lag)});
            Records const rows = rows_of(wide, data.inputs, data.y).before(held_out_from).records;
            if (rows.rows() > d) {
                Fit const of_all = fit(rows);
                for (Index i = d - 1; i >= from; --i)
                    if (std::abs(of_all.theta[i]) > z * of_all.sd[i]) f.begins = nearest + i - from;
            }
        }
        out.followed.push_back(f);
    }
}

void predict(Identified& out, Data const& data, Rows const& rows, Vector<double> const& theta) {
    size_t const inputs = data.inputs.size();
    Records const& all = rows.records;
    Index const first = all.presample, begin = out.samples - out.held_out;
    out.model = equation_of(out.terms, theta, inputs);
    out.poles = poles(out.model);
    for (size_t j = 0; j < inputs; ++j) out.zeros.push_back(zeros(out.model, j));
    Signal predicted(size_t(out.samples), nan), residuals(size_t(out.samples), nan);
    for (Index k = 0; k < all.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < all.parameters(); ++i) sum += all.psi(i, k) * theta[i];
        size_t const at = size_t(rows.samples[size_t(k)]);
        predicted[at] = sum, residuals[at] = all.y[k] - sum;
    }
    Signal measured = data.y;  // where there is a prediction
    for (size_t k = 0; k < measured.size(); ++k)
        if (std::isnan(predicted[k])) measured[k] = nan;
    out.fit_one_step = fit_of(measured, predicted, first, begin);
    out.held_out_one_step = fit_of(measured, predicted, begin, out.samples);
    out.fit_error = rms_of(residuals, first, begin), out.held_out_error = rms_of(residuals, begin, out.samples);
    Signal const free = simulate_from(out.model, data.inputs, data.y, first);
    if (out.held_out > first && inputs > 0) {  // simulated from its own first outputs
        auto const tail = [&](Signal const& x) { return Signal(x.begin() + begin - first, x.end()); };
        std::vector<Signal> later;
        for (Signal const& u : data.inputs) later.push_back(tail(u));
        Signal const y = tail(data.y);
        out.held_out_simulated = fit_of(y, simulate_from(out.model, later, y, first), first, Index(y.size()));
    }
    for (auto const& [from, to] : {std::pair(first, begin), {begin, out.samples}})
        if (auto const e = too_large(Signal(residuals.begin() + from, residuals.begin() + to), out.order))
            out.outliers.push_back({from + e->at + 1, data.lines[size_t(from + e->at)], from == begin, e->deviations, e->share});
    // A missing residual adds nothing to a correlation: the variance of a white one's is 1/N at most, N those that are there.
    Signal const eps = present(residuals, first, begin);
    Index const N = Index(eps.size()), lags = ljung_box_lags(N, out.order), outputs = past_outputs(out.terms);
    double J = 0;
    for (double const x : eps) J += x * x;
    double const y = all.y.head(out.fitted).cwiseAbs().maxCoeff();
    // Of a record without noise the prior and the variant leave up to 1e-9 of y where nothing warns of them.
    bool const nothing_left = J <= (out.noise_free ? double(out.fitted) * 1e-18 * y * y : rounding_alone(out.fitted, y));
    Vector<double> const e = Eigen::Map<Vector<double> const>(residuals.data() + first, N);
    out.ljung_box = ljung_box(nothing_left ? Vector<double>(Vector<double>::Zero(N)) : e, lags, outputs);
    out.auto_correlation = scaled_correlation(eps, eps, lags);
    constexpr Index furthest = 1000;
    Index longest = lags;
    for (Term const& t : out.terms)
        if (t.input >= 0) longest = std::max(longest, std::min({N - 1, furthest, Index(t.lag) + 10}));
    for (Signal const& u : data.inputs) out.cross_correlation.push_back(scaled_correlation(eps, present(u, first, begin), longest));
    if (nothing_left) out.outliers.clear();
    else look_for_past_inputs(out, data, begin);
    for (size_t k = size_t(first); k < size_t(out.samples); ++k) {
        out.measured.push_back(data.y[k] + out.means.back());
        out.one_step.push_back(predicted[k] + out.means.back());
        out.simulated.push_back(free[k] + out.means.back());
    }
}

template <bool hint>
std::vector<std::string> sentences(std::vector<Remark> const& remarks) {
    std::vector<std::string> out;
    for (Remark const& f : remarks)
        if (f.hint == hint) out.push_back(f.sentence);
    return out;
}

}  // namespace

std::vector<std::string> Identified::warnings() const { return sentences<false>(remarks); }
std::vector<std::string> Identified::hints() const { return sentences<true>(remarks); }
std::string Identified::next() const {
    auto const first = std::ranges::find_if(remarks, [](Remark const& f) { return !f.next.empty(); });
    return first == remarks.end() ? "" : first->next;
}

Identified identify(DataFile const& from, IdentifyOptions const& asked, Progress const& progress) {
    Identified out{};
    IdentifyOptions const& options = out.options = completed(asked);
    std::string const file = out.file = printable(from.path, 200);
    entry_of(options.variant);
    Data data = read(from, options);
    for (std::string const& sentence : data.counting) out.remarks.push_back({Remark::Rank::excitation, sentence, ""});
    Index const samples = out.samples = Index(data.y.size()), inputs = Index(data.inputs.size());
    out.held_out = Index(std::floor(options.validate * double(samples)));
    Index const fitted_samples = samples - out.held_out;
    if (!changes(data.y, samples))
        throw InputError(fmt::format("{}: column \"{}\" does not change: there is nothing to model", file, printable(options.output)));
    if (!changes(data.y, fitted_samples))
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
    std::vector<Signal> const as_read = data.inputs;
    for (Index j = 0; j <= inputs; ++j) {
        Signal& x = j < inputs ? data.inputs[size_t(j)] : data.y;
        if (longest_run(x, fitted_samples).empty())
            throw InputError(fmt::format("{}: column \"{}\": expected a number in the part that is fitted, found missing values alone",
                                         file, printable(options.inputs[size_t(j)])));
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
    Index const highest = inputs > 0 ? *std::ranges::max_element(coefficients) - 1 : 0,
                supported = supported_order(out, as_read, fitted_samples, highest, coefficients, progress);
    if (given ? supported < highest : supported < 1)
        throw InputError(fmt::format(
            "{}: {} ({})", file,
            supported < 1   ? "the input does not excite the system: it supports no model of order 1 or more"
            : options.order ? fmt::format("order {} cannot be identified from this input; it supports order {}", options.order, supported)
                            : fmt::format("{} coefficients of an input cannot be identified from this record; it supports {}", highest + 1,
                                          supported + 1),
            fmt::join(out.warnings(), "; ")));

    Rows const of_widest = rows_of(widest, data.inputs, data.y).before(fitted_samples);
    if (of_widest.records.rows() <= of_widest.records.parameters())
        throw InputError(
            fmt::format("{}: {} has {} parameters, and {} of its rows in the fitted part miss no value: expected more, or a lower order",
                        file, structure_text(options, most), widest.size(), of_widest.records.rows()));
    if (options.regressors.empty() && !options.na) {
        int const up_to = given ? options.order : int(std::min<Index>(most, supported));
        OrderColumns const columns = order_columns(data.inputs, data.y, up_to, options.delay, options.intercept);
        out.choice = choose_order(columns, up_to, Index(columns.samples.end() - std::ranges::lower_bound(columns.samples, fitted_samples)));
        if (out.choice.fits.size() < 2)
            throw InputError(fmt::format("{}: the output, the inputs and their past are linearly dependent already at order 1", file));
    }
    out.terms = given ? widest : terms_of(options, out.choice.order);
    out.order = given ? order_of(widest, options.delay) : out.choice.order;
    out.structure = structure_text(options, given ? 0 : out.order);
    out.why = given ? "given" : out.choice.why;

    Rows const all = rows_of(out.terms, data.inputs, data.y);
    Records const fitted = all.before(fitted_samples).records;
    out.fitted = fitted.rows(), out.skipped = all.records.skipped;
    Problem<double> const problem{.size = fitted.parameters(), .prior = std::nullopt};
    CertifiedSolution const exact = certified(problem, fitted, {fitted.rows()}).front();
    if (exact.status() != Status::certified)
        throw InputError(fmt::format("{}: {}: the regressors are linearly dependent (exact rank {} of {})", file, out.structure,
                                     exact.rank(), fitted.parameters()));
    Vector<double> resolution(fitted.parameters());
    for (Index i = 0; i < fitted.parameters(); ++i) {
        int const input = out.terms[size_t(i)].input;
        resolution[i] = input == -2 ? 0 : input == -1 ? data.resolutions.back() : data.resolutions[size_t(input)];
    }
    Estimation const estimation = estimate(out, fitted, resolution);

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
        bool const stable = std::ranges::all_of(out.poles, [](std::complex<double> p) { return std::abs(p) < 1; });
        for (size_t j = 0; j < data.inputs.size(); ++j) {
            auto const [gain, sd] = !stable ? std::pair(nan, nan) : gain_of(out.model, out.terms, estimation, j, out.quantile);
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
                            {.size = P0.rows(), .forgetting = options.forgetting, .prior = Prior<double>{.covariance = P0}}, all.records,
                            all.samples, out.means.back(), out.sigma2, options.confidence);
    }
    advise(out, given ? 0 : int(std::min<Index>(most, supported)));
    std::ranges::stable_sort(out.remarks, {}, [](Remark const& f) { return std::pair(f.hint, f.rank); });
    return out;
}

}  // namespace rlslab::identify
