// A comparison as a page: the answer, digits along the record, their spread, and what they cost.
#include "compare/answer.hpp"
#include "compare/words.hpp"
#include "report/page.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace rlslab {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
/// Digits below are drawn here: an error of ten times the answer is as bad as any other.
constexpr double floor_of_figures = -1;

struct Shown {
    char const *name, *title, *axis;
    std::optional<double> Digits::*digits;
    Spread PerMeasure<Spread>::*spread;
};
constexpr Shown shown[] = {{"theta", "Digits of theta along the record", "digits of theta", &Digits::theta, &PerMeasure<Spread>::theta},
                           {"worst", "Digits of theta's worst component along the record", "digits of the worst component", &Digits::worst, &PerMeasure<Spread>::worst},
                           {"covariance", "Digits of P along the record", "digits of P", &Digits::covariance, &PerMeasure<Spread>::covariance}};

double drawn(double digits) { return std::isnan(digits) ? digits : std::max(digits, floor_of_figures); }

/// Calls see(arithmetic, its results) for each arithmetic in turn.
template <class See>
void for_each_arithmetic(Comparison const& c, See const& see) {
    for (Recommendation const& r : c.recommendations) {
        std::vector<Result const*> of_it;
        for (Result const& x : c.results)
            if (x.entry->arithmetic->name == r.arithmetic) of_it.push_back(&x);
        see(r, of_it);
    }
}

std::string panel_name(Recommendation const& r, std::vector<Result const*> const& results) {
    return fmt::format("{} ({} bits)", r.arithmetic, results.front()->entry->arithmetic->digits);
}

Figure along_the_record(Comparison const& c, Shown const& of) {
    Figure figure{.name = fmt::format("along-{}", of.name), .title = of.title, .x = "row", .y = of.axis, .panels = {}, .own_y = true};
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& results) {
        Panel panel{.name = panel_name(r, results), .curves = {}, .guides = {}};
        for (size_t i = 0; i < results.size(); ++i) {
            Result const& x = *results[i];
            Curve curve{.name = std::string(x.entry->variant), .look = look_of(x.entry->variant, i), .x = {}, .y = {}, .marks = false};
            for (size_t k = 0; k < x.path.size(); ++k) {
                curve.x.push_back(double(c.checkpoints[k]));
                curve.y.push_back(drawn((x.path[k].*of.digits).value_or(nan)));
            }
            if (x.breakdown && !x.path.empty()) {
                size_t const after = size_t(std::ranges::lower_bound(c.checkpoints, x.breakdown->step) - c.checkpoints.begin());
                double const y = curve.y[std::min(after, curve.y.size() - 1)];
                panel.events.push_back({double(x.breakdown->step), std::isnan(y) ? floor_of_figures : y,
                                        fmt::format("{}: {} at row {}", curve.name, x.breakdown->kind, x.breakdown->step), curve.name});
            }
            panel.curves.push_back(std::move(curve));
        }
        figure.panels.push_back(std::move(panel));
    });
    return figure;
}

/// One figure an arithmetic: the most accurate variants first.
std::string spreads(Comparison const& c) {
    std::string out;
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> results) {
        std::erase_if(results, [](Result const* x) { return !x->spread; });
        std::ranges::stable_sort(results, std::greater<>(), [](Result const* x) {
            return std::min({x->spread->theta.median, x->spread->worst.median, x->spread->covariance.median});
        });
        if (results.empty()) return;
        Figure figure{.name = "spread-" + r.arithmetic, .title = "The spread of the digits in " + panel_name(r, results), .x = "", .y = "digits", .panels = {Panel{}}};
        for (size_t m = 0; m < std::size(shown); ++m) {
            Curve curve{.name = shown[m].axis, .look = look_of("", m), .x = {}, .y = {}, .line = false, .bars = true};
            for (size_t i = 0; i < results.size(); ++i) {
                Spread const& s = (*results[i]->spread).*shown[m].spread;
                curve.x.push_back(double(i) + 0.22 * (double(m) - 1));
                curve.y.push_back(drawn(s.median));
                curve.low.push_back(drawn(s.low));
                curve.high.push_back(drawn(s.high));
                curve.says.push_back(fmt::format("{}: {:.1f} ({:.1f} to {:.1f}) {}", results[i]->entry->variant, s.median, s.low, s.high, shown[m].axis));
            }
            figure.panels.front().curves.push_back(std::move(curve));
        }
        for (Result const* x : results) figure.x_names.emplace_back(x->entry->variant);
        out += figure_html(figure);
    });
    return out;
}

/// Preformatted: line by line, for escaped text is one line.
std::string pre(std::string const& text) {
    std::string out = "<pre>";
    for (size_t begin = 0, end; begin < text.size(); begin = end + 1) {
        end = std::min(text.find('\n', begin), text.size());
        out += escaped(text.substr(begin, end - begin)) + '\n';
    }
    return out + "</pre>\n";
}

Figure costs(Comparison const& c) {
    Figure figure{.name = "cost", .title = "Digits of theta against what a row costs", .x = "operations a row, theta included", .y = "digits of theta", .log_x = true,
                  .panels = {}, .own_y = true};
    figure.names = true;
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& results) {
        Panel panel{.name = panel_name(r, results), .curves = {}, .guides = {}};
        for (size_t i = 0; i < results.size(); ++i) {
            Result const& x = *results[i];
            if (!x.operations || !x.spread) continue;
            Spread const& s = x.spread->theta;
            panel.curves.push_back({.name = std::string(x.entry->variant), .look = look_of(x.entry->variant, i), .x = {double(*x.operations)}, .y = {drawn(s.median)},
                                    .low = {drawn(s.low)}, .high = {drawn(s.high)}, .line = false, .bars = true,
                                    .says = {fmt::format("{}: {} operations, {:.1f} digits of theta ({:.1f} to {:.1f})", x.entry->variant, *x.operations, s.median, s.low,
                                                         s.high)}});
        }
        figure.panels.push_back(std::move(panel));
    });
    return figure;
}

std::string table(Comparison const& c) {
    std::vector<std::vector<std::string>> rows;
    for (Result const& x : c.results) {
        std::vector<std::string> row{std::string(x.entry->variant), std::string(x.entry->arithmetic->name)};
        for (Shown const& of : shown)
            row.push_back(x.spread ? fmt::format("{} ({} to {})", tenths(((*x.spread).*of.spread).median), tenths(((*x.spread).*of.spread).low),
                                                 tenths(((*x.spread).*of.spread).high))
                                   : "-");
        row.push_back(breakdown_text(x));
        row.push_back(x.operations ? fmt::format("{}", *x.operations) : "-");
        row.push_back(x.ns_per_update ? fmt::format("{:.0f}", *x.ns_per_update) : "-");
        rows.push_back(std::move(row));
    }
    return table_html({"variant", "arithmetic", "theta", "worst component", "P", "breakdown", "operations", "ns"}, rows);
}

std::string solutions(Comparison const& c) {
    std::vector<std::vector<std::string>> rows;
    for (size_t i = 0; i < c.names.size(); ++i)
        rows.push_back({c.names[i], c.model.regressors[i], c.least_squares[i], c.theta[i], tenths(c.agreement[i])});
    return table_html({"parameter", "multiplies", "least squares, without prior", "with the prior", "digits they share"}, rows);
}

}  // namespace

std::string as_page(Comparison const& c) {
    std::string const what = c.model.file.empty() ? "a record" : c.model.file.substr(c.model.file.rfind('/') + 1);
    std::string body = fmt::format("<h1>Which recursive least squares for {}</h1>\n<p class=\"soft\">{} rows, {} parameters, forgetting {}, condition {:.2g}. rlslab {}</p>\n",
                                   escaped(what), c.rows, c.size, c.options.forgetting, c.condition, RLSLAB_VERSION);
    body += pre(verdict(c));
    if (std::string const paste = code(c); !paste.empty()) body += pre(paste);
    body += "<section><h2>Along the record</h2>\n<p>Each point compares a variant with the exact solution for the rows so far, as the arithmetic stores them. "
            "A cross marks the first row after which the stored P was not positive definite, decided exactly, or something was not finite. "
            "Less than -1 digit is drawn at -1.</p>\n";
    for (Shown const& of : shown) body += figure_html(along_the_record(c, of));
    body += fmt::format("</section><section><h2>How much of that is luck</h2>\n<p>Bars reach from the low to the high end of the spread over the checkpoints{}: "
                        "nine tenths of the digits counted are at least as many as the low end, one tenth as the high end.</p>\n",
                        c.options.forgetting == 1 ? " and over four orders of the rows" : "");
    body += spreads(c) + "</section><section><h2>What it costs</h2>\n" + figure_html(costs(c));
    body += "</section><section><h2>All numbers</h2>\n" + table(c) + "</section><section><h2>The exact solutions</h2>\n";
    body += fmt::format("<p>{}</p>\n", escaped(prior_text(c))) + solutions(c);
    body += fmt::format("<p class=\"soft\">Proven to {:.0e} relative, for the data as binary64, at {} bits.</p></section>\n", c.radius, c.bits);
    return page("rlslab compare: " + what, body);
}

}  // namespace rlslab
