// The figures of a page: orders, residuals, parameters on their way, outputs, responses, poles and zeros.
#include "src/lab/identify/text.hpp"
#include "src/lab/identify/validate.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/core/input_error.hpp>

#include <algorithm>

namespace rlslab::identify {
using namespace report;
namespace {

/// A line, broken where a number is NaN.
Curve line(std::string name, size_t place, Signal x, Signal y) {
    Curve out{.name = std::move(name), .look = look_of({}, place), .x = std::move(x), .y = y, .lower = y, .upper = y};
    out.marks = false;
    return out;
}
/// Points with marks, without those that are NaN.
Curve curve(std::string name, size_t place, Signal x, Signal y) {
    size_t known = 0;
    for (size_t k = 0; k < y.size(); ++k)
        if (!std::isnan(y[k])) x[known] = x[k], y[known++] = y[k];
    x.resize(known), y.resize(known);
    Curve out = line(std::move(name), place, std::move(x), std::move(y));
    out.marks = true;
    return out;
}
/// Drawn over another line, which shows between the dashes.
Curve dashed(std::string name, size_t place, Signal x, Signal y) {
    Curve out = line(std::move(name), place, std::move(x), std::move(y));
    out.look.dashed = true;
    return out;
}
Curve banded(std::string name, size_t place, Signal x, Band const& band) {
    Curve out = line(std::move(name), place, std::move(x), band.value);
    out.lower = band.lower, out.upper = band.upper;
    return out;
}
/// A dashed grey line; at one height.
Curve guide(std::string name, Signal x, Signal y, char const* colour = "#555555") {
    Curve out = line(std::move(name), 6, std::move(x), std::move(y));
    out.look = {colour, true, ""};
    return out;
}
Curve level(std::string name, double from, double to, double y) { return guide(std::move(name), {from, to}, {y, y}); }
/// Each panel with its own range of y.
Figure figure_of(std::string name, std::string title, std::string x, std::string y, std::vector<Panel> panels = {}) {
    Figure out{std::move(name), std::move(title), std::move(x), std::move(y), false, false, false, std::move(panels)};
    out.own_y = true;
    return out;
}

Figure orders_of(Identified const& m) {
    constexpr double least_probability = 1e-8;
    Figure out = figure_of("orders", "What each order explains, and what the criteria say of it", "order", "");
    for (OrderFit const& f : m.choice.fits)
        if (f.order > 0) out.x_ticks.push_back(f.order);
    bool const is_one = std::ranges::find(m.choice.fits, m.order, &OrderFit::order) != m.choice.fits.end() &&
                        m.structure == fmt::format("order {}", m.order);
    size_t place = 0;
    auto const criterion = [&](std::string name,
                               std::vector<std::pair<std::string, double OrderFit::*>> const& which) -> Panel& {
        Panel p{std::move(name)};
        for (auto const& [of, number] : which) {
            Signal x, y;
            for (OrderFit const& f : m.choice.fits)
                if (f.order > 0 && std::isfinite(f.*number)) x.push_back(f.order), y.push_back(f.*number);
            p.curves.push_back(curve(of, place++, x, y));
        }
        if (is_one) p.events.push_back({.x = double(m.order), .text = fmt::format("order {}", m.order)});
        return out.panels.emplace_back(std::move(p));
    };
    criterion("criteria: smaller is better", {{"AIC", &OrderFit::aic}, {"BIC", &OrderFit::bic}});
    Panel& white = criterion("whiteness of the residuals: tail probability", {{"whiteness", &OrderFit::ljung_box}});
    white.log_y = true, white.y_least = least_probability, white.y_holds = {white_level, 1};
    white.guides.push_back(level(fmt::format("level {}", white_level), 1,
                                 std::max(1.0, out.x_ticks.empty() ? 1 : out.x_ticks.back()), white_level));
    if (std::ranges::any_of(m.choice.fits,
                            [](OrderFit const& f) { return f.order > 0 && f.ljung_box < least_probability; }))
        out.note = fmt::format("A triangle at the lower edge stands for a probability below {}.", least_probability);
    if (m.held_out > 0) criterion("one-step fit on held-out rows, %", {{"held out", &OrderFit::held_out}});
    return out;
}

/// The output over the held-out part, and what comes just before it; the errors over the whole record.
void draw_outputs(std::vector<Figure>& figures, Identified const& m) {
    Clock const clock(m.options);
    auto const with_fit = [](char const* of, double fit) { return fmt::format("{}: fit {}", of, percent_text(fit)); };
    size_t const N = m.measured.size();
    Index const presample = m.samples - Index(N), begins = m.samples - m.held_out - presample;  // of the held-out part
    bool const held_out = m.held_out > 0;
    // As many samples as a plot can show: the last of the fitted part, and the first of the held-out part.
    constexpr Index before = 100, shown = 400;
    Index const last = std::min(Index(N), held_out ? std::max<Index>(0, begins - before) + shown : Index(N)),
                from = std::max<Index>(0, last - shown);
    auto const window = [&](Signal const& x) { return Signal(x.begin() + from, x.begin() + last); };
    Signal const time = clock.times(presample + from, size_t(last - from));
    Figure output =
        figure_of("output",
                  held_out ? "Measured and modelled output: the end of the fitted part, and the held-out part"
                           : "Measured and modelled output",
                  clock.axis(), m.options.output,
                  {{with_fit("one step ahead", held_out ? m.held_out_one_step : m.fit_one_step),
                    {line("measured", 6, time, window(m.measured)), dashed("predicted", 1, time, window(m.one_step))},
                    {}}});  // a simulation may run away
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
    if (last < Index(N) || from > 0)
        output.note = fmt::format("Samples {} to {} of {}.", presample + from, presample + last - 1, m.samples);

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
    Figure record =
        figure_of("errors", "One-step errors over the whole record", clock.axis(), "error", {{"", {errors}, {}}});
    record.own_y = false;
    for (Figure* const figure : {&output, &record}) {
        for (Panel& panel : figure->panels)
            if (held_out)
                panel.events.push_back({.x = clock.time(double(presample + begins)), .text = "held out from here"});
        figures.push_back(std::move(*figure));
    }
}

/// Correlations of the residuals with themselves and with each input.
Figure correlations_of(Identified const& m) {
    Figure out = figure_of(
        "residuals",
        fmt::format("Correlation of the residuals (dashed: what 99 % of a white one keep, +- {:.3f})", m.bound),
        "lag in samples", "correlation");
    out.y_holds = {-m.bound, m.bound};
    auto const panel = [&](std::string const& name, Signal const& r, size_t skip) {
        Signal x;
        for (size_t lag = skip; lag < r.size(); ++lag) x.push_back(double(lag));
        Panel p{name,
                {curve("correlation", 0, x, Signal(r.begin() + long(skip), r.end()))},
                {level("bound", x.front(), x.back(), m.bound), level("bound", x.front(), x.back(), -m.bound)}};
        p.curves[0].line = false, p.curves[0].stems = true;
        out.panels.push_back(std::move(p));
    };
    panel("with itself, lags from 1", m.auto_correlation, 1);
    for (size_t j = 0; j < m.cross_correlation.size(); ++j)
        panel("with past " + printable(m.options.inputs[j]), m.cross_correlation[j], 0);
    return out;
}

/// The sums of the recursive residuals and of their squares, with their lines at 5 %.
Figure constancy_of(Identified const& m) {
    Clock const clock(m.options);
    Signal const time = clock.times(m.constancy.samples);
    Figure out = figure_of(
        "constancy",
        "One model throughout? Sums of the recursive residuals (a model that changes leaves the dashed lines; "
        "one that does not leaves each pair with a probability of about 5 %)",
        clock.axis(), "");
    auto const panel = [&](char const* name, char const* of, ConstancyPath const& path) {
        Panel p{name,
                {line(of, 1, time, path.value)},
                {guide("5 % line", time, path.lower), guide("5 % line", time, path.upper)}};
        // Lines that are cut off are read as none.
        p.y_holds = {std::ranges::min(path.lower), std::ranges::max(path.upper)};
        if (path.crosses)
            p.events.push_back({.x = time[size_t(*path.crosses)],
                                .text = "crosses at " + clock.row_text(m.constancy.row(*path.crosses))});
        out.panels.push_back(std::move(p));
    };
    panel("CUSUM", "sum, in standard deviations", m.constancy.cusum);
    panel("CUSUM of squares", "share of the sum of squares", m.constancy.squares);
    return out;
}

Figure steps_of(Identified const& m) {
    Clock const clock(m.options);
    Figure out = figure_of("step",
                           fmt::format("Step response of {}, with its {:g} % interval", printable(m.options.output),
                                       100 * m.options.confidence),
                           clock.axis(), m.options.output);
    for (size_t j = 0; j < m.responses.size(); ++j) {
        Band const& step = m.responses[j].step;
        Signal const time = clock.times(0, step.value.size());
        Panel panel{"to " + printable(m.options.inputs[j]), {banded("step response", 1, time, step)}, {}};
        panel.y_holds = {0};
        if (std::isfinite(m.gain[j])) panel.guides.push_back(level("steady-state gain", 0, time.back(), m.gain[j]));
        out.panels.push_back(std::move(panel));
    }
    return out;
}

Figure frequencies_of(Identified const& m, size_t j) {
    Clock const clock(m.options);
    Signal const frequency = clock.frequencies(m.frequencies);
    InputResponse const& r = m.responses[j];
    Figure out =
        figure_of(fmt::format("frequency{}", j == 0 ? "" : fmt::format("-{}", j + 1)),
                  fmt::format("Frequency response from {} to {}, with its {:g} % interval",
                              printable(m.options.inputs[j]), printable(m.options.output), 100 * m.options.confidence),
                  clock.axis_of_frequency(), "",
                  {{"magnitude in decibels", {banded("magnitude", 1, frequency, r.magnitude_db)}, {}},
                   {"phase in degrees", {banded("phase", 5, frequency, r.phase_deg)}, {}}});
    out.log_x = true;
    // A lower end near minus infinity would flatten the curve.
    auto const [least, most] = std::ranges::minmax(r.magnitude_db.value);
    Panel& magnitude = out.panels[0];
    magnitude.y_least = std::max(least - 10, most - 120);
    for (double& lower : magnitude.curves[0].lower)
        if (lower < magnitude.y_least) lower = magnitude.y_least;
    return out;
}

Figure poles_of(Identified const& m) {
    Figure out =
        figure_of("poles", fmt::format("Poles and zeros, with their {:g} % regions", 100 * m.options.confidence),
                  "real part", "imaginary part", {{"", {}, {}}});
    out.own_y = false, out.square = true;
    Signal cosine, sine;
    for (int i = 0; i <= 180; ++i)
        cosine.push_back(correctly::cos(i * 0.03490658503988659)),
            sine.push_back(correctly::sin(i * 0.03490658503988659));
    out.panels[0].guides.push_back(guide("unit circle", cosine, sine, "#999999"));
    constexpr double farthest = 4;  // a root beyond it would shrink the unit circle to a dot
    bool unknown = false;
    std::vector<std::string> beyond;
    auto const points = [&](std::string name, std::string mark, size_t place, std::vector<RootSpread> const& roots) {
        Signal x, y, of_regions, and_y;  // regions: NaN between them
        for (RootSpread const& root : roots) {
            if (!(std::abs(root.value) <= farthest)) {
                beyond.push_back(root.value.imag() == 0
                                     ? fmt::format("{:.4g}", root.value.real())
                                     : fmt::format("{:.4g}{:+.4g}i", root.value.real(), root.value.imag()));
                continue;
            }
            x.push_back(root.value.real()), y.push_back(root.value.imag());
            unknown |= !root.first_order;
            for (double const side : {1.0, -1.0}) {  // a pair has its region on both sides of the real axis
                if (root.value.imag() < 0 || (root.value.imag() == 0 && side < 0)) continue;
                for (auto const& z : region_of(root, m.options.confidence, m.quantile, m.student))
                    of_regions.push_back(z.real()), and_y.push_back(side * z.imag());
                of_regions.push_back(NAN), and_y.push_back(NAN);
            }
        }
        Curve c = curve(name, place, x, y);
        c.line = false, c.look.mark = std::move(mark);
        out.panels[0].curves.push_back(std::move(c));
        out.panels[0].curves.push_back(line(std::move(name), place, of_regions, and_y));
    };
    points("poles", "x", 1, m.pole_spreads);
    for (size_t j = 0; j < m.zeros.size(); ++j)
        points("zeros of " + printable(m.options.inputs[j]), "circle-open", j == 0 ? 0 : j + 1, m.zero_spreads[j]);
    if (unknown)
        out.note =
            "A root without a region: its error is as large as half the distance to the next root, or the coefficient "
            "that leads its polynomial may be 0.";
    if (!beyond.empty())
        out.note += fmt::format("{}Not shown, beyond {:g}: {}.", out.note.empty() ? "" : " ", farthest,
                                fmt::join(beyond, ", "));
    return out;
}

Figure trajectory_of(Identified const& m) {
    Clock const clock(m.options);
    // Starts where the record decides, not the prior: earlier bands can be a million times as wide as at the end.
    size_t begin = 0;
    for (size_t i = 0; i < m.trajectory.size(); ++i)
        if (((m.trajectory[i].sd.array() > 20 * m.trajectory.back().sd.array()) || m.trajectory[i].sd.array().isNaN())
                .any())
            begin = i + 1;
    if (begin >= m.trajectory.size()) begin = 0;
    Figure out = figure_of(
        "trajectory",
        fmt::format("Parameters on their way ({}), with bands of +- 2 standard deviations", m.options.variant),
        clock.seconds() ? clock.axis() : "row", "value");
    for (size_t j = 0; j < m.parameters.size(); ++j) {
        int const input = m.terms[j].input;  // parameters of one signal have like sizes: a panel for each
        std::string const of =
            input == -2 ? "constant" : "of " + (input == -1 ? m.options.output : m.options.inputs[size_t(input)]);
        auto panel = std::ranges::find(out.panels, of, &Panel::name);
        if (panel == out.panels.end()) panel = out.panels.insert(panel, {of, {}, {}});
        Curve c{.name = m.parameters[j].name, .look = look_of({}, j)};  // one look a parameter
        for (size_t i = begin; i < m.trajectory.size(); ++i) {
            TrajectoryPoint const& point = m.trajectory[i];
            double const value = point.theta[Index(j)], sd = point.sd[Index(j)];
            c.x.push_back(clock.time(double(point.row))), c.y.push_back(value);
            c.lower.push_back(value - 2 * sd), c.upper.push_back(value + 2 * sd);
        }
        c.marks = j >= 16;  // colours and dashes repeat from here on
        panel->curves.push_back(std::move(c));
    }
    return out;
}

}  // namespace

std::vector<Figure> figures_of(Identified const& m) {
    std::vector<Figure> out;
    bool const model = !m.measured.empty();
    if (!m.choice.fits.empty()) out.push_back(orders_of(m));
    if (model) draw_outputs(out, m), out.push_back(correlations_of(m));
    if (!m.constancy.samples.empty()) out.push_back(constancy_of(m));
    if (!m.responses.empty()) out.push_back(steps_of(m));
    for (size_t j = 0; j < m.responses.size(); ++j) out.push_back(frequencies_of(m, j));
    if (!m.poles.empty() || !m.zeros.empty()) out.push_back(poles_of(m));
    out.push_back(trajectory_of(m));
    return out;
}

}  // namespace rlslab::identify
