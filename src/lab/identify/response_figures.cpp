// What the model does: step responses, frequency responses, poles and zeros, with their intervals.
#include "src/lab/identify/clock.hpp"
#include "src/lab/identify/figures.hpp"
#include "src/lab/identify/responses.hpp"

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
