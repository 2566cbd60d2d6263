// A comparison as a page: the answer, digits along the record, their spread, and what they cost.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/digits_answer.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/report/page.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

/// The axes of digits end here: an error of ten times the answer is as bad as any other.
constexpr double least_digits = -1;

struct Shown {
    char const* axis;
    std::optional<double> Digits::*digits;
    Spread PerMeasure<Spread>::*spread;
};
constexpr Shown shown[] = {{"digits of theta", &Digits::theta, &PerMeasure<Spread>::theta},
                           {"digits of the worst component", &Digits::worst, &PerMeasure<Spread>::worst},
                           {"digits of P", &Digits::covariance, &PerMeasure<Spread>::covariance}};

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

/// The digits that a variant keeps of all three measures, by median.
double least_median(Result const& x) {
    return std::min({x.spread->theta.median, x.spread->worst.median, x.spread->covariance.median});
}

/// Those with digits, the most accurate first.
std::vector<Result const*> best_first(std::vector<Result const*> results) {
    std::erase_if(results, [](Result const* x) { return !x->spread; });
    std::ranges::stable_sort(results, std::greater<>(), [](Result const* x) { return least_median(*x); });
    return results;
}

/// What a reader sees first: in each arithmetic the recommended, the best and the worst variant, and the textbooks'.
std::vector<std::string> first_look(Comparison const& c) {
    std::vector<std::string> out{"conventional", "joseph"};
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& all) {
        out.push_back(recommended_in(c, r.arithmetic));
        std::vector<Result const*> const results = best_first(all);
        if (results.empty()) return;
        for (Result const* end : {results.front(), results.back()}) out.emplace_back(end->entry->variant);
    });
    return out;
}

/// What it costs to use this variant: "2.8 digits of P" less than the best variant for single rows, each
/// measure by itself; of the measures the worst.
std::string loss_text(Result const& x, std::vector<Result const*> results) {
    if (!is_sound(x)) return x.obstacle.empty() ? "it breaks down" : "-";
    std::erase_if(results, [](Result const* other) { return !takes_single_rows(*other) || !is_sound(*other); });
    Loss const loss = loss_of(x, results);
    return std::round(10 * loss.digits) < 1 ? "nothing" : fmt::format("{} digits of {}", tenths(loss.digits), loss.of);
}

/// "double (53 bits): ★ ud, in the code".
std::string panel_name(Comparison const& c, Recommendation const& r, std::vector<Result const*> const& results) {
    std::string const best = recommended_in(c, r.arithmetic);
    bool const in_code = c.digits ? !code(c).empty() : coded(c) == &r;
    std::string const mark = best.empty() ? "" : fmt::format(": ★ {}{}", best, in_code ? ", in the code" : "");
    return fmt::format("{} ({} bits){}", r.arithmetic, results.front()->entry->arithmetic->digits, mark);
}

/// Before the first checkpoint there is no digit to stand at: the cross is at the first point's height.
Event breakdown_event(Comparison const& c, Breakdown const& breakdown, Curve const& curve) {
    size_t const after = size_t(std::ranges::lower_bound(c.checkpoints, breakdown.step) - c.checkpoints.begin());
    double const y = curve.y[std::min(after, curve.y.size() - 1)];
    return {double(breakdown.step), std::isnan(y) ? least_digits : y,
            fmt::format("{}: {} at row {}{}", curve.name, name_of(breakdown.kind), breakdown.step,
                        breakdown.step < c.checkpoints.front()
                            ? fmt::format(", before the first checkpoint (row {})", c.checkpoints.front())
                            : ""),
            curve.name};
}

/// A panel for each measure in each arithmetic: one legend for all.
Figure along_the_record(Comparison const& c) {
    Figure figure{.name = "along", .title = "Digits kept, row by row", .x = "row", .y = "digits", .own_y = true};
    figure.first = first_look(c);
    for (Shown const& of : shown)
        for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& results) {
            Panel panel{.name = fmt::format("{}, {}", of.axis, panel_name(c, r, results)), .y_least = least_digits};
            for (size_t i = 0; i < results.size(); ++i) {
                Result const& x = *results[i];
                Curve curve{.name = std::string(x.entry->variant),
                            .look = look_of(x.entry->family, i),
                            .marks = false,
                            .strong = is_recommended(c, x)};
                for (size_t k = 0; k < x.path.size(); ++k) {
                    curve.x.push_back(double(c.checkpoints[k]));
                    curve.y.push_back((x.path[k].*of.digits).value_or(NAN));
                }
                if (x.breakdown && !x.path.empty()) panel.events.push_back(breakdown_event(c, *x.breakdown, curve));
                panel.curves.push_back(std::move(curve));
            }
            figure.panels.push_back(std::move(panel));
        });
    return figure;
}

/// "4.9 (4.5 to 5.3)".
std::string spread_words(Spread const& s) {
    return fmt::format("{} ({} to {})", tenths(s.median), tenths(s.low), tenths(s.high));
}

/// One figure an arithmetic: the most accurate variants first.
std::string spreads(Comparison const& c) {
    std::string out;
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& all) {
        std::string const title = "The spread of the digits in " + panel_name(c, r, all);
        std::vector<Result const*> const results = best_first(all);
        if (results.empty()) return;
        Figure figure{.name = "spread-" + r.arithmetic, .title = title, .x = "", .y = "digits", .panels = {Panel{}}};
        figure.panels.front().y_least = least_digits;
        for (size_t m = 0; m < std::size(shown); ++m) {
            Curve curve{.name = shown[m].axis, .look = look_of({}, m), .line = false, .bars = true};
            for (size_t i = 0; i < results.size(); ++i) {
                Spread const& s = (*results[i]->spread).*shown[m].spread;
                curve.x.push_back(double(i) + 0.22 * (double(m) - 1));
                curve.y.push_back(s.median);
                curve.lower.push_back(s.low);
                curve.upper.push_back(s.high);
                curve.says.push_back(
                    fmt::format("{}: {} {}", results[i]->entry->variant, spread_words(s), shown[m].axis));
            }
            figure.panels.front().curves.push_back(std::move(curve));
        }
        for (size_t i = 0; i < results.size(); ++i) {
            bool const best = is_recommended(c, *results[i]);
            figure.x_names.push_back((best ? "★ " : "") + std::string(results[i]->entry->variant));
            if (best) figure.strong_x.push_back(i);
        }
        out += figure_html(figure);
    });
    return out;
}

/// Calls see(line) for each line, without its end.
template <class See>
void for_each_line(std::string const& text, See const& see) {
    for (size_t begin = 0, end; begin < text.size(); begin = end + 1) {
        end = std::min(text.find('\n', begin), text.size());
        see(text.substr(begin, end - begin));
    }
}

/// Preformatted: line by line, for escaped text is one line.
std::string pre(std::string const& text) {
    std::string out = "<pre>";
    for_each_line(text, [&](std::string const& line) { out += escaped(line) + '\n'; });
    return out + "</pre>\n";
}

/// Sentences: each line that does not go on with the one before.
std::string says(std::string const& text) {
    std::string out;
    for_each_line(text, [&](std::string const& line) {
        bool const goes_on = line.starts_with(' ') && !out.empty();
        out += goes_on ? escaped(line.substr(line.find_first_not_of(' ') - 1))
                       : (out.empty() ? "<div>" : "</div><div>") + escaped(line);
    });
    return "<div class=\"says\">" + out + "</div></div>\n";
}

Figure costs(Comparison const& c) {
    Figure figure{.name = "cost",
                  .title = "Digits of theta against what a row costs",
                  .x = "operations a row, theta included",
                  .y = "digits of theta",
                  .log_x = true,
                  .own_y = true};
    figure.names = true;
    figure.first = first_look(c);
    std::vector<std::string> uncounted;
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& results) {
        Panel panel{.name = panel_name(c, r, results), .y_least = least_digits};
        for (size_t i = 0; i < results.size(); ++i) {
            Result const& x = *results[i];
            if (std::string const name(x.entry->variant);
                !x.operations && std::ranges::find(uncounted, name) == uncounted.end())
                uncounted.push_back(name);
            if (!x.operations || !x.spread) continue;
            Spread const& s = x.spread->theta;
            panel.curves.push_back({.name = std::string(x.entry->variant),
                                    .look = look_of(x.entry->family, i),
                                    .x = {double(*x.operations)},
                                    .y = {s.median},
                                    .lower = {s.low},
                                    .upper = {s.high},
                                    .line = false,
                                    .bars = true,
                                    .says = {fmt::format("{}: {} operations, {} digits of theta", x.entry->variant,
                                                         *x.operations, spread_words(s))},
                                    .strong = is_recommended(c, x)});
        }
        figure.panels.push_back(std::move(panel));
    });
    if (!uncounted.empty())
        figure.note = fmt::format("Not drawn: {}, whose operations are a library's and are not counted.",
                                  fmt::join(uncounted, ", "));
    return figure;
}

/// The same digits over other orders of the rows; "" where there are none.
std::string other_orders(Comparison const& c, std::vector<Result const*> const& results) {
    std::vector<std::vector<std::string>> rows;
    std::vector<size_t> best;
    int runs = 0;
    for (Result const* x : results) {
        if (x->others.runs == 0) continue;
        runs = std::max(runs, x->others.runs);
        if (is_recommended(c, *x)) best.push_back(rows.size());
        std::vector<std::string> row{(is_recommended(c, *x) ? "★ " : "") + std::string(x->entry->variant)};
        for (Shown const& of : shown)
            row.push_back(x->others.spread ? spread_words((*x->others.spread).*of.spread) : "-");
        row.push_back(x->others.broken > 0 ? fmt::format("in {} of {}", x->others.broken, x->others.runs) : "none");
        rows.push_back(std::move(row));
    }
    if (rows.empty()) return "";
    return fmt::format("<p>In {} other orders of the rows:</p>\n", runs) +
           table_html({"variant", "theta", "worst component", "P", "breakdown"}, rows, best);
}

/// For each arithmetic what storing the problem does to it, and its results; the recommended one stands out.
std::string tables(Comparison const& c) {
    std::string out;
    for_each_arithmetic(c, [&](Recommendation const&, std::vector<Result const*> const& results) {
        Arithmetic const& a = *results.front()->entry->arithmetic;
        out += fmt::format("<h3>{} ({} bits, {:.1f} digits)</h3>\n", a.name, a.digits, a.decimal_digits());
        for (RoundingEffect const& s : c.rounding)
            if (s.arithmetic == a.name) out += fmt::format("<p class=\"soft\">{}</p>\n", escaped(rounding_text(s, c)));
        std::vector<std::vector<std::string>> rows;
        std::vector<size_t> best;
        for (Result const* x : results) {
            if (is_recommended(c, *x)) best.push_back(rows.size());
            std::vector<std::string> row{(is_recommended(c, *x) ? "★ " : "") + std::string(x->entry->variant),
                                         loss_text(*x, results)};
            for (Shown const& of : shown) row.push_back(x->spread ? spread_words((*x->spread).*of.spread) : "-");
            row.push_back(breakdown_text(*x));
            row.push_back(x->asymmetry == 0 ? "0" : known(x->asymmetry, "{:.0e}"));
            row.push_back(known(x->operations, "{}"));
            if (c.options.timings) row.push_back(known(x->ns_per_update, "{:.0f}"));
            if (!c.options.composition.empty()) row.push_back(counts_text(c, *x));
            rows.push_back(std::move(row));
        }
        std::vector<std::string> head{"variant", "costs you", "theta",     "worst component",
                                      "P",       "breakdown", "asymmetry", "operations"};
        if (c.options.timings) head.emplace_back("ns");
        if (!c.options.composition.empty()) head.emplace_back("what the composition did");
        out += table_html(head, rows, best) + other_orders(c, results);
    });
    return out;
}

/// Estimate, bound and truth of the forms that take probes; "" without them.
std::string probes(Comparison const& c) {
    std::string out;
    auto const number = [](double x) { return fmt::format("{:.1e}", x); };
    for_each_arithmetic(c, [&](Recommendation const& r, std::vector<Result const*> const& results) {
        std::vector<std::vector<std::string>> rows;
        std::vector<size_t> best;
        for (Result const* x : results) {
            if (!x->probed) continue;
            if (is_recommended(c, *x)) best.push_back(rows.size());
            rows.push_back({(is_recommended(c, *x) ? "★ " : "") + std::string(x->entry->variant),
                            number(x->probed->estimate), number(x->probed->bound), known(x->probed->truth, "{:.1e}")});
        }
        if (!rows.empty())
            out += fmt::format("<h3>{}</h3>\n", r.arithmetic) +
                   table_html({"variant", "estimate", "bound", "truth"}, rows, best);
    });
    return out.empty() ? ""
                       : fmt::format("<section><h2>What probes show</h2>\n<p>{}</p>\n{}</section>",
                                     escaped(probes_sentence(c)), out);
}

std::string solutions(Comparison const& c) {
    std::vector<std::vector<std::string>> rows;
    for (size_t i = 0; i < c.names.size(); ++i)
        rows.push_back({c.names[i], c.model.regressors[i], c.least_squares[i], c.theta[i], tenths(c.agreement[i])});
    return table_html(
        {"parameter", "multiplies", "least squares, without prior", "with the prior", "digits they share"}, rows);
}

}  // namespace

std::string as_page(Comparison const& c) {
    std::string const what = c.model.file.empty() ? "a record" : c.model.file.substr(c.model.file.rfind('/') + 1);
    std::string body = fmt::format(
        "<h1>Which recursive least squares for {}</h1>\n<p class=\"soft\">{} rows, {} parameters, forgetting {}, "
        "condition {:.2g}. rlslab {}</p>\n",
        escaped(what), c.rows, c.size, c.options.forgetting, c.condition, RLSLAB_VERSION);
    bool const plain = c.options.composition.empty();
    if (!plain)
        body += fmt::format("<p>Around each variant: {}. Digits are counted {}.</p>\n",
                            escaped(composition_text(c.options.composition)), escaped(against_text(c)));
    std::string list;
    for (std::string const& warning : warnings(c))
        list += fmt::format("<li class=\"fails\"><b>warning</b> {}</li>", escaped(warning));
    if (!list.empty()) body += "<ul class=\"claims\">" + list + "</ul>\n";
    if (c.digits) body += pre(answer_text(*c.digits, false));
    else body += says(verdict(c));
    if (std::string const paste = code(c); !paste.empty() && !c.digits) body += pre(paste);
    body += fmt::format(
        "<section><h2>Along the record</h2>\n<p>{} A cross marks the first row after which the stored P was not "
        "positive definite, decided exactly, or something was not finite{}. The axes end at {} digits: a triangle at "
        "the lower edge stands for fewer, its number is in the tooltip. A star and the strong line mark the "
        "recommended variant.</p>\n",
        plain ? "Each point compares a variant with the exact solution for the rows so far, as the arithmetic stores "
                "them."
              : "Each point compares a composition with what it would answer without rounding.",
        std::ranges::any_of(c.results,
                            [&](Result const& x) { return x.breakdown && x.breakdown->step < c.checkpoints.front(); })
            ? fmt::format("; one left of its line broke down before the first checkpoint, row {}",
                          c.checkpoints.front())
            : "",
        least_digits);
    body += figure_html(along_the_record(c));
    body += fmt::format(
        "</section><section><h2>How much of that is luck</h2>\n<p>Bars reach from the low to the high end of the "
        "spread over the checkpoints{}: nine tenths of the digits counted are at least as many as the low end, one "
        "tenth as the high end.</p>\n",
        plain ? " and over the draws of the roundings" : "");
    body += spreads(c) + "</section><section><h2>What it costs</h2>\n" + figure_html(costs(c));
    body +=
        "</section><section><h2>All numbers</h2>\n<p>Digits: the median, and in brackets what nine tenths and one "
        "tenth of the counts reach. \"Costs you\": by how much a variant's median is below the best median of "
        "the variants that take single rows and never broke down, in the column where that is most. Asymmetry: max "
        "|P_ij - P_ji| / max |P_ij| of the stored P.</p>\n" +
        (foretold_text(c).empty() ? "" : fmt::format("<p>{}</p>\n", escaped(foretold_text(c)))) + tables(c) +
        "</section>" + probes(c) + "<section><h2>The exact solutions</h2>\n";
    body += fmt::format("<p>{}</p>\n", escaped(prior_text(c))) + solutions(c);
    body += fmt::format(
        "<p class=\"soft\">Proven to {:.0e} relative, for the data as binary64, at {} bits.</p></section>\n", c.radius,
        c.bits);
    if (c.run) body += as_html(*c.run);
    return page("rlslab compare: " + what, body);
}

}  // namespace rlslab::compare
