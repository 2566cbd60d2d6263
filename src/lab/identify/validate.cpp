// Predictions, simulations and residuals of the model.
#include "src/lab/identify/validate.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/model/outliers.hpp>

#include <algorithm>

namespace rlslab::identify {
namespace {

struct Lines {
    double a, tail;  ///< of the sum; of the squares on one side
};
constexpr Lines at_5_percent{0.948, 0.025}, at_1_percent{1.143, 0.005};

/// The path with its lines at 5 %. half(r, level): half their distance at r = 1 ... m about `middle`(r).
template <class Middle, class Half>
ConstancyPath path_of(Signal value, Middle middle, Half half) {
    ConstancyPath out;
    double most = 0;
    for (size_t i = 0; i < value.size(); ++i) {
        double const r = double(i + 1), off = std::abs(value[i] - middle(r)), reach = half(r, at_5_percent);
        out.lower.push_back(middle(r) - reach), out.upper.push_back(middle(r) + reach);
        if (off > reach && !out.crosses) out.crosses = Index(i);
        out.surely |= off > half(r, at_1_percent);
        if (off > most) most = off, out.farthest = Index(i);
    }
    out.value = std::move(value);
    return out;
}

double solved_line(Index n, double tail) {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        double const c = (low + high) / 2;
        (tail_of_largest_excess(n, c) > tail ? low : high) = c;
    }
    return low;
}

/// y where there is a prediction, NaN elsewhere.
Signal where_known(Signal y, Signal const& predicted) {
    for (size_t k = 0; k < y.size(); ++k)
        if (std::isnan(predicted[k])) y[k] = NAN;
    return y;
}

/// Without missing samples; 0 if all are missing.
double rms_of(Signal const& x, Index begin, Index end) {
    double sum = 0, known = 0;
    for (size_t k = size_t(begin); k < size_t(end); ++k)
        if (!std::isnan(x[k])) sum += x[k] * x[k], ++known;
    return known > 0 ? std::sqrt(sum / known) : 0;
}

/// Correlation of the residuals with x, scaled by both powers.
Signal scaled_correlation(Signal const& eps, Signal const& x, Index lags) {
    Signal out = correlation(eps, x, lags);
    double const scale = std::sqrt(correlation(eps, eps, 0)[0]) * std::sqrt(correlation(x, x, 0)[0]);
    for (double& r : out) r = scale > 0 ? r / scale : 0;
    return out;
}

/// The first significant lag of an input, if all its lags up to `lag` are in the equation: by more than z standard
/// deviations. `lag` if none is, or if that fit would take too long.
Index first_significant_lag(Record const& record, std::vector<Term> const& terms, Index fitted, int input, Index lag,
                            double z) {
    std::vector<Term> wide;
    Index nearest = lag, furthest = lag;
    for (Term const& t : terms)
        if (t.input == input) nearest = std::min<Index>(nearest, t.lag), furthest = std::max<Index>(furthest, t.lag);
        else wide.push_back(t);
    Index const from = Index(wide.size()), d = from + furthest - nearest + 1;
    constexpr double most_work = 2e9;
    if (double(d) * double(d) * double(fitted) >= most_work || 2 * d >= fitted) return lag;
    for (Index l = nearest; l <= furthest; ++l) wide.push_back({"", "", input, int(l)});
    Records const rows = rows_of(wide, record.inputs, record.y).before(record.fitted).records;
    if (rows.rows() <= d) return lag;
    Fit const of_all = fit(rows);
    for (Index i = from; i < d; ++i)
        if (std::abs(of_all.theta[i]) > z * of_all.sd[i]) return nearest + i - from;
    return lag;
}

/// The correlations with past values of an input that exceed the 99 % bound of all lags of all inputs together. A
/// coloured residual and a coloured input are correlated by chance, too: N times the variance of r is the sum of their
/// correlations' products (Söderström & Stoica 1989, 11.2), which is 1 for white residuals.
std::vector<PastInput> past_inputs(Record const& record, std::vector<Term> const& terms, Index fitted,
                                   Signal const& auto_correlation, std::vector<Signal> const& cross_correlation) {
    std::vector<PastInput> out;
    Index const first = presample(terms), inputs = Index(record.inputs.size()),
                lags = Index(auto_correlation.size()) - 1;
    for (Index j = 0; j < inputs; ++j) {
        Signal const& r = cross_correlation[size_t(j)];
        Signal const u = zero_filled(record.inputs[size_t(j)], first, record.fitted),
                     of_u = scaled_correlation(u, u, lags);
        double spread = 1;
        for (Index lag = 1; lag <= lags; ++lag) spread += 2 * auto_correlation[size_t(lag)] * of_u[size_t(lag)];
        double const z = normal_quantile(1 - 0.005 / double(inputs * Index(r.size()))),
                     bound = z * std::sqrt(std::max(1.0, spread) / double(fitted));
        Index const lag = largest_at(r);
        if (double const most = r[size_t(lag)]; std::abs(most) > bound)
            out.push_back({int(j), lag, most, bound, first_significant_lag(record, terms, fitted, int(j), lag, z)});
    }
    return out;
}

/// One step ahead, for every sample; NaN where the equation has no row.
struct Predictions {
    Signal predicted, residuals;
};
Predictions predict(Rows const& rows, Vector<double> const& theta, Index samples) {
    Predictions out{Signal(size_t(samples), NAN), Signal(size_t(samples), NAN)};
    Records const& all = rows.records;
    for (Index k = 0; k < all.rows(); ++k) {
        double sum = 0;
        for (Index i = 0; i < all.parameters(); ++i) sum += all.psi(i, k) * theta[i];
        size_t const at = size_t(rows.samples[size_t(k)]);
        out.predicted[at] = sum, out.residuals[at] = all.y[k] - sum;
    }
    return out;
}

/// Whether every signal has sample k.
bool known(std::vector<Signal> const& signals, Index k) {
    return std::ranges::none_of(signals, [&](Signal const& x) { return std::isnan(x[size_t(k)]); });
}

/// A simulation from the measured outputs of the `lead` samples from `begin` on; NaN before and for these. Where an
/// input is missing it ends, and begins anew from the next samples that miss nothing.
Signal simulated_from(Record const& record, DifferenceEquation const& model, Index begin, Index lead) {
    Signal out(size_t(record.samples), NAN);
    std::vector<Signal> all = record.inputs;
    all.push_back(record.y);
    for (Index from = begin, k = begin; k <= record.samples; ++k) {
        if (k < std::min(from + lead, record.samples)) {
            if (!known(all, k)) from = k + 1;
            continue;
        }
        if (k < record.samples && known(record.inputs, k)) continue;
        auto const part = [&](Signal const& x) { return Signal(x.begin() + from, x.begin() + k); };
        std::vector<Signal> inputs;
        for (Signal const& u : record.inputs) inputs.push_back(part(u));
        Signal const run = simulate_from(model, inputs, part(record.y), lead);
        for (Index i = lead; i < Index(run.size()); ++i) out[size_t(from + i)] = run[size_t(i)];
        from = k + 1;
    }
    return out;
}

void set_properties(Validation& out, IdentifyOptions const& options, std::vector<Term> const& terms,
                    Vector<double> const& theta, Uncertainty const& uncertainty, double quantile) {
    out.poles = poles(out.model);
    out.pole_spreads = spreads_of_poles(out.model, terms, uncertainty);
    out.modes = modes_of(out.pole_spreads);
    out.cancellations = cancellations(out.model, terms, uncertainty, options.confidence);
    bool const stable = std::ranges::all_of(out.poles, [](std::complex<double> p) { return std::abs(p) < 1; });
    for (size_t j = 0; j < options.inputs.size(); ++j) {
        out.zeros.push_back(zeros(out.model, j));
        out.zero_spreads.push_back(spreads_of_zeros(out.model, terms, uncertainty, j));
        auto const [gain, sd] =
            stable ? gain_of(out.model, terms, uncertainty, j, quantile) : std::pair<double, double>(NAN, NAN);
        out.gain.push_back(gain), out.gain_sd.push_back(sd);
    }
    out.frequencies = response_frequencies(out.poles, out.zeros);
    Index const length = response_length(out.poles, terms);
    for (size_t j = 0; j < options.inputs.size(); ++j)
        out.responses.push_back(
            response_of(out.model, terms, theta, uncertainty, j, quantile, length, out.frequencies));
}

/// Tests of the residuals over the fitted rows. y: the largest fitted output.
void set_residual_tests(Validation& out, Record const& record, Structure const& structure, Signal const& residuals,
                        Index fitted, double y, bool noise_free) {
    // A missing residual adds nothing to a correlation: that of white residuals has the variance 1/N at most, N without
    // missing ones.
    Index const first = presample(structure.terms);
    Signal const eps = zero_filled(residuals, first, record.fitted);
    Index const N = Index(eps.size()), lags = ljung_box_lags(N, structure.order),
                outputs = past_outputs(structure.terms);
    double J = 0;
    for (double const x : eps) J += x * x;
    // In a record without noise the prior and the variant may leave up to 1e-9 of y without a warning.
    bool const rounding = J <= (noise_free ? double(fitted) * 1e-18 * y * y : rounding_alone(fitted, y));
    Vector<double> const e = Eigen::Map<Vector<double> const>(residuals.data() + first, N);
    out.ljung_box = ljung_box(rounding ? Vector<double>(Vector<double>::Zero(N)) : e, lags, outputs);
    out.auto_correlation = scaled_correlation(eps, eps, lags);
    constexpr Index furthest = 1000;
    Index longest = lags;
    for (Term const& t : structure.terms)
        if (t.input >= 0) longest = std::max(longest, std::min({N - 1, furthest, Index(t.lag) + 10}));
    for (Signal const& u : record.inputs)
        out.cross_correlation.push_back(scaled_correlation(eps, zero_filled(u, first, record.fitted), longest));
    if (rounding) return;
    for (auto const& [from, to] : {std::pair(first, record.fitted), {record.fitted, record.samples}})
        if (auto const o = outlier_in(Signal(residuals.begin() + from, residuals.begin() + to), structure.order))
            out.outliers.push_back(
                {from + o->at + 1, record.lines[size_t(from + o->at)], from == record.fitted, o->deviations, o->share});
    out.past_inputs = past_inputs(record, structure.terms, fitted, out.auto_correlation, out.cross_correlation);
}

}  // namespace

Validation validate(Record const& record, IdentifyOptions const& options, Structure const& structure, Rows const& rows,
                    Index fitted, Estimation const& estimation) {
    Validation out;
    out.bound = 2.5758293035489004 / std::sqrt(double(fitted));  // the normal distribution's 99.5 %
    Estimate const& estimate = estimation.estimate;
    Vector<double> const& theta = estimate.trajectory.back().theta;
    if (!theta.allFinite()) return out;
    Index const first = rows.records.presample;
    out.model = equation_of(structure.terms, theta, record.inputs.size());
    set_properties(out, options, structure.terms, theta, estimation.uncertainty, estimate.quantile);
    Predictions const of_model = predict(rows, theta, record.samples);
    Signal const measured = where_known(record.y, of_model.predicted);
    out.fit_one_step = fit_of(measured, of_model.predicted, first, record.fitted);
    out.held_out_one_step = fit_of(measured, of_model.predicted, record.fitted, record.samples);
    out.fit_error = rms_of(of_model.residuals, first, record.fitted);
    out.held_out_error = rms_of(of_model.residuals, record.fitted, record.samples);
    double const largest_y = rows.records.y.head(fitted).cwiseAbs().maxCoeff();
    set_residual_tests(out, record, structure, of_model.residuals, fitted, largest_y, estimate.noise_free);
    if (!estimate.noise_free)
        out.constancy = constancy(rows.before(record.fitted).records, rows.samples, rounding_alone(fitted, largest_y));
    double const mean = record.means.back();
    auto const with_mean = [&](Signal x) {
        x.erase(x.begin(), x.begin() + first);
        for (double& v : x) v += mean;
        return x;
    };
    out.measured = with_mean(record.y), out.one_step = with_mean(of_model.predicted);
    if (record.inputs.empty()) return out;
    out.simulated = with_mean(simulated_from(record, out.model, 0, first));
    if (record.samples - record.fitted <= first) return out;  // too short
    Signal const held_out = simulated_from(record, out.model, record.fitted - first, first);
    out.held_out_simulated = fit_of(where_known(record.y, held_out), held_out, record.fitted, record.samples);
    out.simulated_held_out = with_mean(held_out);
    return out;
}

Index largest_at(Signal const& r, Index first) {
    Index at = first;
    for (Index lag = first; lag < Index(r.size()); ++lag)
        if (std::abs(r[size_t(lag)]) > std::abs(r[size_t(at)])) at = lag;
    return at;
}

double fit_of(Signal const& y, Signal const& predicted, Index begin, Index end) {
    Signal measured, of_measured;
    for (size_t k = size_t(begin); k < size_t(end); ++k)
        if (!std::isnan(y[k])) measured.push_back(y[k]), of_measured.push_back(predicted[k]);
    auto const map = [](Signal const& x) { return Eigen::Map<Vector<double> const>(x.data(), Index(x.size())); };
    return measured.empty() ? NAN : fit_percent(map(measured), map(of_measured));
}

double tail_of_largest_excess(Index n, double c) {
    double const alpha = double(n + 1) * c;
    double sum = 0, choose = 1;  // n over j
    for (Index j = 0; j <= n; ++j) {
        if (j > 0) choose *= double(n - j + 1) / double(j);
        double const t = (double(j) - alpha) / double(n + 1);
        if (t < 0) continue;
        double const passed = correctly::pow(t, double(j)) * correctly::pow(1 - t, double(n - j));
        sum += choose * passed * (1 + alpha) / (1 + alpha + double(n - j));
    }
    return sum;
}

double squares_line(Index m, double tail) {
    bool const wide = tail == at_1_percent.tail;
    expects(m >= 4 && (wide || tail == at_5_percent.tail), "4 residuals or more, and a level with a line");
    double const n = double(m) / 2 - 1;
    if (n < 60) {
        double const below = solved_line(m / 2 - 1, tail);
        return m % 2 == 0 ? below : (below + solved_line(m / 2, tail)) / 2;
    }
    auto const [a1, a2, a3] = wide ? std::tuple(1.6276236, -0.6703724, -1.2365861)  // Edgerton & Wells
                                   : std::tuple(1.3581015, -0.6701218, -0.8858694);
    return a1 / std::sqrt(n) + a2 / n + a3 / (n * std::sqrt(n));
}

Constancy constancy(Records const& rows, std::vector<Index> const& samples, double rounding) {
    Constancy out;
    Problem<double> const problem{.size = rows.parameters(), .prior = std::nullopt};
    auto const filter = find_entry("qr")->make(problem, Seed{1});
    double J = 0;
    for (Index k = 0; k < rows.rows(); ++k) {
        Step<double> const step = filter->update(rows.sample(k), rows.y[k]);
        if (std::isnan(step.innovation) && out.residuals.empty()) continue;  // theta is not determined yet
        double const w = step.innovation * std::sqrt(step.gamma);            // (1)
        J += w * w;
        out.samples.push_back(samples[size_t(k)]), out.residuals.push_back(w);
    }
    Index const m = Index(out.residuals.size());
    if (m < 4 || !std::isfinite(J) || J <= rounding) return {};
    double const count = double(m), sigma = std::sqrt(J / count);
    Signal sums, squares;
    double sum = 0, square = 0;
    for (double const w : out.residuals) {
        sum += w, square += w * w;
        sums.push_back(sum / sigma), squares.push_back(square / J);
    }
    out.cusum = path_of(
        std::move(sums), [](double) { return 0.0; },  // (2)
        [&](double r, Lines const& l) { return l.a * std::sqrt(count) * (1 + 2 * r / count); });
    double const narrow = squares_line(m, at_5_percent.tail), wide = squares_line(m, at_1_percent.tail);
    out.c0 = narrow;
    out.squares = path_of(
        std::move(squares), [&](double r) { return r / count; },  // (3)
        [&](double, Lines const& l) { return l.tail == at_5_percent.tail ? narrow : wide; });
    return out;
}

}  // namespace rlslab::identify
