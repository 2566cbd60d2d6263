// The figures of a page: orders, residuals, parameters on their way, outputs, responses, poles and zeros.
#include "src/lab/identify/figures.hpp"
#include "src/lab/identify/clock.hpp"
#include "src/lab/identify/responses.hpp"
#include "src/lab/identify/text.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

Curve banded(std::string name, size_t place, Signal x, Band const& band) {
    Curve out = line(std::move(name), place, std::move(x), band.value);
    out.lower = band.lower, out.upper = band.upper;
    return out;
}

/// The points of several regions, NaN between them: one curve.
struct Regions {
    Signal x, y;
    void add(std::vector<std::complex<double>> const& region, bool mirrored) {
        for (bool const below : {false, true}) {
            if (below && !mirrored) break;
            for (auto const& z : region) x.push_back(z.real()), y.push_back(below ? -z.imag() : z.imag());
            x.push_back(NAN), y.push_back(NAN);
        }
    }
};

}  // namespace

Curve curve(std::string name, size_t place, Signal x, Signal y) {
    Look look = look_of({}, place);
    size_t known = 0;
    for (size_t k = 0; k < y.size(); ++k)
        if (!std::isnan(y[k])) x[known] = x[k], y[known++] = y[k];
    x.resize(known), y.resize(known);
    return {.name = std::move(name), .look = look, .x = std::move(x), .y = y, .lower = y, .upper = y};
}
Curve line(std::string name, size_t place, Signal x, Signal y) {
    Curve out{.name = std::move(name), .look = look_of({}, place), .x = std::move(x), .y = y, .lower = y, .upper = y};
    out.marks = false;
    return out;
}
Curve dashed(std::string name, size_t place, Signal x, Signal y) {
    Curve out = line(std::move(name), place, std::move(x), std::move(y));
    out.look.dashed = true;  // over the measured line, which shows between the dashes
    return out;
}
Signal counting(size_t n, double from) {
    Signal out(n);
    for (size_t k = 0; k < n; ++k) out[k] = from + double(k);
    return out;
}
Signal times(Clock const& clock, Index count, double from) {
    Signal out = counting(size_t(count), from);
    for (double& x : out) x = clock.time(x);
    return out;
}
Curve level(std::string name, double from, double to, double y) {
    Curve out = line(std::move(name), 6, {from, to}, {y, y});
    out.look = {"#555555", true, ""};
    return out;
}

void draw_orders(std::vector<Figure>& out, Identified const& m) {
    constexpr double least_probability = 1e-8;
    Figure orders{
        "orders", "What each order explains, and what the criteria say of it", "order", "", false, false, false, {}};
    orders.own_y = true;
    for (OrderFit const& f : m.choice.fits)
        if (f.order > 0) orders.x_ticks.push_back(f.order);
    bool const is_one = std::ranges::find(m.choice.fits, m.order, &OrderFit::order) != m.choice.fits.end() &&
                        m.structure == fmt::format("order {}", m.order);
    size_t place = 0;
    auto const criterion = [&](std::string name,
                               std::vector<std::pair<std::string, double OrderFit::*>> const& which) -> Panel& {
        Panel p{std::move(name), {}, {}};
        for (size_t i = 0; i < which.size(); ++i) {
            Signal x, y;
            for (OrderFit const& f : m.choice.fits)
                if (f.order > 0 && std::isfinite(f.*which[i].second))
                    x.push_back(f.order), y.push_back(f.*which[i].second);
            p.curves.push_back(curve(which[i].first, place++, x, y));
        }
        if (is_one) p.events.push_back({.x = double(m.order), .text = fmt::format("order {}", m.order)});
        orders.panels.push_back(std::move(p));
        return orders.panels.back();
    };
    criterion("criteria: smaller is better", {{"AIC", &OrderFit::aic}, {"BIC", &OrderFit::bic}});
    Panel& white = criterion("whiteness of the residuals: tail probability", {{"whiteness", &OrderFit::ljung_box}});
    white.log_y = true, white.y_least = least_probability, white.y_holds = {white_level, 1};
    white.guides.push_back(level(fmt::format("level {}", white_level), 1,
                                 std::max(1.0, orders.x_ticks.empty() ? 1 : orders.x_ticks.back()), white_level));
    if (std::ranges::any_of(m.choice.fits,
                            [](OrderFit const& f) { return f.order > 0 && f.ljung_box < least_probability; }))
        orders.note = fmt::format("A triangle at the lower edge stands for a probability below {}.", least_probability);
    if (m.held_out > 0) criterion("one-step fit on held-out rows, %", {{"held out", &OrderFit::held_out}});
    out.push_back(std::move(orders));
}

/// Correlations of the residuals with themselves and with each input.
void draw_correlations(std::vector<Figure>& out, Identified const& m) {
    Figure correlations{
        "residuals",
        fmt::format("Correlation of the residuals (dashed: what 99 % of a white one keep, +- {:.3f})", m.bound),
        "lag in samples",
        "correlation",
        false,
        false,
        false,
        {}};
    correlations.own_y = true;
    correlations.y_holds = {-m.bound, m.bound};
    auto const panel = [&](std::string const& name, Signal const& r, size_t skip) {
        Signal const x = counting(r.size() - skip, double(skip));
        Signal const y(r.begin() + long(skip), r.end());
        Panel p{name,
                {curve("correlation", 0, x, y)},
                {level("bound", x.front(), x.back(), m.bound), level("bound", x.front(), x.back(), -m.bound)}};
        p.curves[0].line = false, p.curves[0].stems = true;
        correlations.panels.push_back(std::move(p));
    };
    panel("with itself, lags from 1", m.auto_correlation, 1);
    for (size_t j = 0; j < m.cross_correlation.size(); ++j)
        panel("with past " + printable(m.options.inputs[j]), m.cross_correlation[j], 0);
    out.push_back(std::move(correlations));
}

void draw_trajectory(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    // Starts where the record decides, not the prior: earlier bands can be a million times as wide as at the end.
    size_t begin = 0;
    for (size_t i = 0; i < m.trajectory.size(); ++i)
        if (((m.trajectory[i].sd.array() > 20 * m.trajectory.back().sd.array()) || m.trajectory[i].sd.array().isNaN())
                .any())
            begin = i + 1;
    if (begin >= m.trajectory.size()) begin = 0;
    Figure trajectory{
        "trajectory",
        fmt::format("Parameters on their way ({}), with bands of +- 2 standard deviations", m.options.variant),
        clock.seconds() ? clock.axis() : "row",
        "value",
        false,
        false,
        false,
        {}};
    trajectory.own_y = true;
    for (size_t j = 0; j < m.parameters.size(); ++j) {
        Parameter const& p = m.parameters[j];
        int const input =
            j < m.terms.size() ? m.terms[j].input : -2;  // parameters of one signal have like sizes: a panel for each
        std::string const of =
            input == -2 ? "constant" : "of " + (input == -1 ? m.options.output : m.options.inputs[size_t(input)]);
        auto panel = std::ranges::find(trajectory.panels, of, &Panel::name);
        if (panel == trajectory.panels.end()) panel = trajectory.panels.insert(panel, {of, {}, {}});
        Curve c{.name = p.name,
                .look = look_of({}, j),
                .x = {},
                .y = {},
                .lower = {},
                .upper = {}};  // one look a parameter
        for (size_t i = begin; i < m.trajectory.size(); ++i) {
            TrajectoryPoint const& point = m.trajectory[i];
            double const value = point.theta[Index(j)], sd = point.sd[Index(j)];
            c.x.push_back(clock.seconds() ? clock.time(double(point.row)) : double(point.row)), c.y.push_back(value),
                c.lower.push_back(value - 2 * sd), c.upper.push_back(value + 2 * sd);
        }
        c.marks = j >= 16;  // colours and dashes repeat from here on
        panel->curves.push_back(std::move(c));
    }
    out.push_back(std::move(trajectory));
}

/// A fit in words: "one step ahead: fit 91.20 %".
std::string with_fit(char const* what, double fit) { return fmt::format("{}: fit {}", what, percent_text(fit)); }

/// The output over the held-out part, and what comes just before it.
void draw_outputs(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    size_t const N = m.measured.size();
    Index const presample = m.samples - Index(N), begins = m.samples - m.held_out - presample;  // of the held-out part
    bool const held_out = m.held_out > 0;
    // As many samples as a plot can show: the last of the fitted part, and the first of the held-out part.
    constexpr Index before = 100, shown = 400;
    Index const last = std::min(Index(N), held_out ? std::max<Index>(0, begins - before) + shown : Index(N)),
                from = std::max<Index>(0, last - shown);
    auto const window = [&](Signal const& x) { return Signal(x.begin() + from, x.begin() + last); };
    Signal const time = times(clock, last - from, double(presample + from));
    Figure output{"output",
                  held_out ? "Measured and modelled output: the end of the fitted part, and the held-out part"
                           : "Measured and modelled output",
                  clock.axis(),
                  m.options.output,
                  false,
                  false,
                  false,
                  {{with_fit("one step ahead", held_out ? m.held_out_one_step : m.fit_one_step),
                    {line("measured", 6, time, window(m.measured)), dashed("predicted", 1, time, window(m.one_step))},
                    {}}}};
    if (!m.simulated.empty()) {
        Signal simulated = m.simulated;
        if (!m.simulated_held_out.empty())
            std::copy(m.simulated_held_out.begin() + begins, m.simulated_held_out.end(), simulated.begin() + begins);
        output.panels.push_back(
            {m.simulated_held_out.empty()
                 ? "simulated from the first outputs"
                 : with_fit("simulated from the last outputs before the held-out part", m.held_out_simulated),
             {line("measured", 6, time, window(m.measured)), dashed("simulated", 5, time, window(simulated))},
             {}});
    }
    output.own_y = true;  // a simulation may run away
    if (last < Index(N) || from > 0)
        output.note = fmt::format("Samples {} to {} of {}.", presample + from, presample + last - 1, m.samples);
    double const boundary = clock.time(double(presample + begins));
    if (held_out)
        for (Panel& panel : output.panels) panel.events.push_back({.x = boundary, .text = "held out from here"});
    out.push_back(std::move(output));

    // Bins of a long record: their mean, and the band from the least to the largest.
    size_t const bin = (N + 999) / 1000;
    Curve errors = line(bin > 1 ? fmt::format("mean of {} samples, band from the least to the largest", bin)
                                : "measured less predicted",
                        1, {}, {});
    for (size_t k = 0, next = 0; k < N; k = next) {
        size_t const end = k < size_t(begins) ? size_t(begins) : N,
                     count = std::min(bin, end - k);  // no bin on both sides
        next = k + count;
        double sum = 0, known = 0, low = INFINITY, high = -INFINITY;
        for (size_t i = k; i < k + count; ++i)
            if (double const e = m.measured[i] - m.one_step[i]; !std::isnan(e))
                sum += e, ++known, low = std::min(low, e), high = std::max(high, e);
        if (known == 0) continue;
        errors.x.push_back(clock.time(double(presample) + double(k) + double(count - 1) / 2));
        errors.y.push_back(sum / known), errors.lower.push_back(low), errors.upper.push_back(high);
    }
    Figure record{"errors",     "One-step errors over the whole record",
                  clock.axis(), "error",
                  false,        false,
                  false,        {{"", {errors}, {}}}};
    if (held_out) record.panels[0].events.push_back({.x = boundary, .text = "held out from here"});
    out.push_back(std::move(record));
}

/// The sums of the recursive residuals and of their squares, with their lines at 5 %.
void draw_constancy(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    Constancy const& c = m.constancy;
    Signal time;
    for (Index const k : c.samples) time.push_back(clock.time(double(k)));
    Figure figure{
        "constancy",
        "One model throughout? Sums of the recursive residuals (a model that changes leaves the dashed lines; "
        "one that does not leaves each pair with a probability of about 5 %)",
        clock.axis(),
        "",
        false,
        false,
        false,
        {}};
    figure.own_y = true;
    auto const panel = [&](char const* name, char const* of, ConstancyPath const& path) {
        Panel p{name, {line(of, 1, time, path.value)}, {}};
        for (Signal const& bound : {path.lower, path.upper}) {
            p.guides.push_back(line("5 % line", 6, time, bound));
            p.guides.back().look = {"#555555", true, ""};
        }
        // Lines that are cut off are read as none.
        p.y_holds = {std::ranges::min(path.lower), std::ranges::max(path.upper)};
        if (path.crosses)
            p.events.push_back({.x = time[size_t(*path.crosses)],
                                .text = "crosses at " + clock.row_text(c.samples[size_t(*path.crosses)] + 1)});
        figure.panels.push_back(std::move(p));
    };
    panel("CUSUM", "sum, in standard deviations", c.cusum);
    panel("CUSUM of squares", "share of the sum of squares", c.squares);
    out.push_back(std::move(figure));
}

void draw_steps(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    Figure figure{"step",
                  fmt::format("Step response of {}, with its {:g} % interval", printable(m.options.output),
                              100 * m.options.confidence),
                  clock.axis(),
                  m.options.output,
                  false,
                  false,
                  false,
                  {}};
    figure.own_y = true;
    for (size_t j = 0; j < m.responses.size(); ++j) {
        Band const& step = m.responses[j].step;
        Panel panel{"to " + printable(m.options.inputs[j]),
                    {banded("step response", 1, times(clock, Index(step.value.size()), 0), step)},
                    {}};
        panel.y_holds = {0};
        if (std::isfinite(m.gain[j]))
            panel.guides.push_back(level("steady-state gain", 0, clock.time(double(step.value.size() - 1)), m.gain[j]));
        figure.panels.push_back(std::move(panel));
    }
    out.push_back(std::move(figure));
}

void draw_frequencies(std::vector<Figure>& out, Identified const& m) {
    Clock const clock(m.options);
    Signal frequency;
    for (double const f : m.frequencies) frequency.push_back(clock.frequency(f));
    for (size_t j = 0; j < m.responses.size(); ++j) {
        InputResponse const& r = m.responses[j];
        Figure figure{
            fmt::format("frequency{}", j == 0 ? "" : fmt::format("-{}", j + 1)),
            fmt::format("Frequency response from {} to {}, with its {:g} % interval", printable(m.options.inputs[j]),
                        printable(m.options.output), 100 * m.options.confidence),
            clock.axis_of_frequency(),
            "",
            true,
            false,
            false,
            {{"magnitude in decibels", {banded("magnitude", 1, frequency, r.magnitude_db)}, {}},
             {"phase in degrees", {banded("phase", 5, frequency, r.phase_deg)}, {}}}};
        figure.own_y = true;
        // A lower end near minus infinity would flatten the curve.
        auto const [least, most] = std::ranges::minmax(r.magnitude_db.value);
        Panel& magnitude = figure.panels[0];
        magnitude.y_least = std::max(least - 10, most - 120);
        for (double& lower : magnitude.curves[0].lower)
            if (lower < magnitude.y_least) lower = magnitude.y_least;
        out.push_back(std::move(figure));
    }
}

void draw_poles(std::vector<Figure>& out, Identified const& m) {
    Figure plane{"poles",     fmt::format("Poles and zeros, with their {:g} % regions", 100 * m.options.confidence),
                 "real part", "imaginary part",
                 false,       false,
                 false,       {{"", {}, {}}}};
    plane.square = true;
    Signal cosine, sine;
    for (int i = 0; i <= 180; ++i)
        cosine.push_back(correctly::cos(i * 0.03490658503988659)),
            sine.push_back(correctly::sin(i * 0.03490658503988659));
    Curve circle = line("unit circle", 6, cosine, sine);
    circle.look = {"#999999", true, ""};
    plane.panels[0].guides.push_back(circle);
    constexpr double farthest = 4;  // a root beyond it would shrink the unit circle to a dot
    bool unknown = false;
    std::vector<std::string> beyond;
    auto const points = [&](std::string name, std::string mark, size_t place, std::vector<RootSpread> const& roots) {
        Signal x, y;
        Regions regions;
        for (RootSpread const& root : roots) {
            if (!(std::abs(root.value) <= farthest)) {
                beyond.push_back(root.value.imag() == 0
                                     ? fmt::format("{:.4g}", root.value.real())
                                     : fmt::format("{:.4g}{:+.4g}i", root.value.real(), root.value.imag()));
                continue;
            }
            x.push_back(root.value.real()), y.push_back(root.value.imag());
            unknown |= !root.first_order;
            if (root.value.imag() >= 0)
                regions.add(region_of(root, m.options.confidence, m.quantile, m.student), root.value.imag() > 0);
        }
        Curve about = line(name, place, regions.x, regions.y);
        Curve c = curve(std::move(name), place, x, y);
        c.line = false, c.look.mark = std::move(mark);
        plane.panels[0].curves.push_back(std::move(c));
        plane.panels[0].curves.push_back(std::move(about));
    };
    points("poles", "x", 1, m.pole_spreads);
    for (size_t j = 0; j < m.zeros.size(); ++j)
        points("zeros of " + printable(m.options.inputs[j]), "circle-open", j == 0 ? 0 : j + 1, m.zero_spreads[j]);
    if (unknown)
        plane.note =
            "A root without a region: its error is as large as half the distance to the next root, or the coefficient "
            "that leads its polynomial may be 0.";
    if (!beyond.empty())
        plane.note += fmt::format("{}Not shown, beyond {:g}: {}.", plane.note.empty() ? "" : " ", farthest,
                                  fmt::join(beyond, ", "));
    out.push_back(std::move(plane));
}

}  // namespace rlslab::identify
