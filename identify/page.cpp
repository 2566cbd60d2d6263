// An identified model as a page.
#include "identify/text.hpp"
#include "report/page.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

/// Leaves out NaN.
Curve curve(std::string name, size_t place, Signal x, Signal y) {
    Look look = look_of({}, place);
    size_t known = 0;
    for (size_t k = 0; k < y.size(); ++k)
        if (!std::isnan(y[k])) x[known] = x[k], y[known++] = y[k];
    x.resize(known), y.resize(known);
    return {.name = std::move(name), .look = look, .x = std::move(x), .y = y, .lower = y, .upper = y};
}
Curve line(std::string name, size_t place, Signal x, Signal y) {
    Curve out = curve(std::move(name), place, std::move(x), std::move(y));
    out.marks = false;
    return out;
}
Curve dashed(std::string name, size_t place, Signal x, Signal y) {
    Curve out = line(std::move(name), place, std::move(x), std::move(y));
    out.look.dashed = true;  // over the measured line, which shows between the dashes
    return out;
}
Signal counting(size_t n, double from = 0) {
    Signal out(n);
    for (size_t k = 0; k < n; ++k) out[k] = from + double(k);
    return out;
}
Curve level(std::string name, double from, double to, double y) {
    Curve out = line(std::move(name), 6, {from, to}, {y, y});
    out.look = {"#555555", true, ""};
    return out;
}

/// Outputs, errors, correlations.
void draw_outputs(std::vector<Figure>& out, Identified const& m) {
    size_t const N = m.measured.size();
    Index const presample = m.samples - Index(N), begins = m.samples - m.held_out - presample;  // of the held-out part
    // As many samples as a plot can show: the last of the fitted part, and the first of the held-out part.
    constexpr Index before = 100, shown = 400;
    Index const last = std::min(Index(N), m.held_out > 0 ? std::max<Index>(0, begins - before) + shown : Index(N)),
                from = std::max<Index>(0, last - shown);
    auto const window = [&](Signal const& x) { return Signal(x.begin() + from, x.begin() + last); };
    Signal const time = counting(size_t(last - from), double(presample + from));
    Figure output{"output",
                  fmt::format("Measured and modelled output, samples {} to {}", presample + from, presample + last - 1),
                  "sample",
                  m.options.output,
                  false,
                  false,
                  false,
                  {{"one step ahead",
                    {line("measured", 6, time, window(m.measured)), dashed("predicted", 1, time, window(m.one_step))},
                    {}},
                   {"simulated from the first outputs",
                    {line("measured", 6, time, window(m.measured)), dashed("simulated", 5, time, window(m.simulated))},
                    {}}}};
    output.own_y = true;  // a simulation may run away
    if (m.held_out > 0) {
        output.title += fmt::format("; held out from {} on", presample + begins);
        for (Panel& panel : output.panels)
            panel.events.push_back({.x = double(presample + begins), .text = "held out from here"});
    }
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
        errors.x.push_back(double(presample) + double(k) + double(count - 1) / 2);
        errors.y.push_back(sum / known), errors.lower.push_back(low), errors.upper.push_back(high);
    }
    Figure record{"errors", "One-step errors over the whole record",
                  "sample", "error",
                  false,    false,
                  false,    {{"", {errors}, {}}}};
    if (m.held_out > 0)
        record.panels[0].events.push_back({.x = double(presample + begins), .text = "held out from here"});
    out.push_back(std::move(record));

    Figure correlations{
        "residuals",
        fmt::format("Correlation of the residuals (dashed: what 99 % of a white one keep, +- {:.3f})", m.bound),
        "lag",
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
        "row",
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
            c.x.push_back(double(point.row)), c.y.push_back(value), c.lower.push_back(value - 2 * sd),
                c.upper.push_back(value + 2 * sd);
        }
        c.marks = j >= 16;  // colours and dashes repeat from here on
        panel->curves.push_back(std::move(c));
    }
    out.push_back(std::move(trajectory));
}

void draw_poles(std::vector<Figure>& out, Identified const& m) {
    Figure plane{"poles", "Poles and zeros", "real part", "imaginary part", false, false, false, {{"", {}, {}}}};
    plane.square = true;
    Signal cosine, sine;
    for (int i = 0; i <= 180; ++i)
        cosine.push_back(correctly::cos(i * 0.03490658503988659)),
            sine.push_back(correctly::sin(i * 0.03490658503988659));
    Curve circle = line("unit circle", 6, cosine, sine);
    circle.look = {"#999999", true, ""};
    plane.panels[0].guides.push_back(circle);
    auto const points = [&](std::string name, std::string mark, size_t place,
                            std::vector<std::complex<double>> const& values) {
        Signal x, y;
        for (auto const& z : values) x.push_back(z.real()), y.push_back(z.imag());
        Curve c = curve(std::move(name), place, x, y);
        c.line = false, c.look.mark = std::move(mark);
        plane.panels[0].curves.push_back(std::move(c));
    };
    points("poles", "x", 1, m.poles);
    for (size_t j = 0; j < m.zeros.size(); ++j)
        points("zeros of " + m.options.inputs[j], "circle-open", j == 0 ? 0 : j + 1, m.zeros[j]);
    out.push_back(std::move(plane));
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

/// If the variant gave no numbers, only the orders and the trajectory.
std::vector<Figure> figures_of(Identified const& m) {
    std::vector<Figure> out;
    bool const model = !m.measured.empty();
    if (!m.choice.fits.empty()) draw_orders(out, m);
    if (model) draw_outputs(out, m);
    draw_trajectory(out, m);
    if (model) draw_poles(out, m);
    return out;
}

/// A box for each sentence; kind: "warning", "next".
std::string boxes(std::string const& kind, std::string const& type, std::vector<std::string> const& sentences) {
    std::string out;
    for (std::string const& words : sentences)
        out += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", type, kind, escaped(words));
    return out.empty() ? "" : "<ul class=\"claims\">" + out + "</ul>";
}

/// Without the text of the header.
std::vector<std::string> order_lines_below(Identified const& m) {
    std::vector<std::string> out = order_lines(m);
    std::string const header = fmt::format("{} ({})", m.structure, m.why);
    if (out.front().starts_with(header))
        out.front().erase(0, header.size() + (out.front().starts_with(header + "; ") ? 2 : 0));
    std::erase(out, "");
    return out;
}

}  // namespace

std::string as_page(Identified const& m) {
    std::vector<Figure> const figures = figures_of(m);
    std::string body = fmt::format("<header><h1>{}: {}</h1><p class=\"question\">{}</p>",
                                   escaped(printable(std::filesystem::path(m.file).filename().string(), 60)),
                                   escaped(m.structure), escaped(m.why));
    body += boxes("warning", "fails", m.warnings()) + "</header>";
    for (std::string const& words : order_lines_below(m)) body += fmt::format("<p>{}</p>", escaped(words));
    for (std::string const& words : result_lines(m))
        if (!words.starts_with("next: ") && !words.starts_with("hint: "))
            body += fmt::format("<p>{}</p>", escaped(words));
    body += boxes("hint", "next", m.hints());
    if (!m.next().empty()) body += boxes("next", "next", {m.next()});
    for (Figure const& figure : figures) body += figure_html(figure);
    body += "<section><h2>Parameters</h2>\n";
    std::vector<std::vector<std::string>> rows;
    for (Parameter const& p : m.parameters)
        rows.push_back({printable(p.name), p.regressor, number_text(p.value, 6), number_text(p.sd, 2),
                        fmt::format("{} ... {}", number_text(p.lower, 5), number_text(p.upper, 5))});
    body += table_html(
        {"parameter", "of", "estimate", "sd", fmt::format("{:g} % interval", 100 * m.options.confidence)}, rows);
    body += "</section>\n";
    for (auto const& lines : {data_lines(m), input_lines(m)})
        for (std::string const& words : lines) body += fmt::format("<p class=\"soft\">{}</p>", escaped(words));
    if (m.run) body += as_html(*m.run);
    return page(m.file + ": identified", body);
}

}  // namespace rlslab::identify
