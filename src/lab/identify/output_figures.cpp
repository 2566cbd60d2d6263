// The output, measured and modelled, and the errors one step ahead.
#include "src/lab/identify/clock.hpp"
#include "src/lab/identify/figures.hpp"
#include "src/lab/identify/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;

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

}  // namespace rlslab::identify
