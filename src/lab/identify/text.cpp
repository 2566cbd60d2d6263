// What is said of a model, once, and its renderers: a terminal, a page, the tracked rows. An unknown number is "-".
#include "src/lab/identify/text.hpp"
#include "src/lab/identify/validate.hpp"
#include "src/lab/report/page.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/composition_text.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <filesystem>
#include <fmt/args.h>

namespace rlslab::identify {
using namespace report;
namespace {

using Words = std::vector<std::string>;
template <class... Values>
void say(Words& out, fmt::format_string<Values...> line, Values&&... values) {
    out.push_back(fmt::format(line, std::forward<Values>(values)...));
}
std::string joined(Words const& words, char const* between = ", ") {
    return fmt::format("{}", fmt::join(words, between));
}
std::string input(Identified const& m, size_t j) { return printable(m.options.inputs[j]); }

std::string list_of(std::vector<std::complex<double>> const& values) {
    Words parts;
    for (auto const& z : values)
        if (z.imag() > 0) say(parts, "{:.4f} +- {:.4f}i (|z| {:.3f})", z.real(), z.imag(), std::abs(z));
        else if (z.imag() == 0) say(parts, "{:.4f}", z.real());
    return parts.empty() ? "none" : joined(parts);
}
/// "time constant 4.5 samples (sd 0.2), natural frequency 0.1 cycles per sample, damping 0.3".
std::string modes_text(std::vector<Mode> const& modes, Clock const& clock) {
    Words parts;
    for (Mode const& m : modes)
        if (m.pole == 0.0) say(parts, "a pole at 0, without a time constant");
        else if (m.pole.imag() > 0)
            say(parts, "natural frequency {}, damping {}", clock.frequency_text(m.natural_frequency),
                Clock::text(m.damping, 1, ""));
        else if (std::isfinite(m.time_constant.value))
            say(parts, "time constant {}{}", clock.time_text(m.time_constant),
                m.pole.real() < 0 ? " with changing sign" : "");
        else say(parts, "{:.4g} does not decay", m.pole.real());
    return joined(parts, "; ");
}
/// "stays within its 5 % lines", "crosses its 5 % line at row 120 (1.19 s)".
std::string crossing_text(ConstancyPath const& path, Identified const& m) {
    if (!path.crosses) return "stays within its 5 % lines";
    return fmt::format("crosses its 5 % line{} at {}", path.surely ? ", and the one at 1 %," : "",
                       Clock(m.options).row_text(m.constancy.row(*path.crosses)));
}
std::string whiteness_text(double sigma2, LjungBox const& w, bool judged) {
    std::string const p = w.p == 0 ? "p < 1e-300" : fmt::format("p = {:.3g}", w.p),
                      verdict = w.zeros     ? "nothing is left beyond rounding"
                                : !judged   ? "no verdict on those of the last theta over all rows"
                                : w.white() ? fmt::format("they pass for white: {} >= {}", p, white_level)
                                            : fmt::format("not white: {} < {}", p, white_level);
    return fmt::format("sigma^2 = {}; {} (Ljung-Box: Q = {}, {} lags, {} degrees of freedom)", number_text(sigma2, 4),
                       verdict, number_text(w.Q, 4), w.lags, w.freedom);
}

// --- lines -----------------------------------------------------------------------------------------------------------

/// The record, how it was estimated, with which prior.
Words data_lines(Identified const& m) {
    IdentifyOptions const& o = m.options;
    std::string prior =
        o.p0 ? fmt::format("P0 = {:.4g} I", *o.p0)
             : fmt::format("P0_ii = (c / s_i)^2, c = 2^{:.0f}, s_i the size of regressor i", correctly::log2(m.c));
    if (m.prior_effect <= 0.1) prior += fmt::format(": it moves no parameter by more than {:.1g} sd", m.prior_effect);
    Words means;
    for (size_t j = 0; o.detrend && j < m.means.size(); ++j)
        say(means, "{} {:.5g}", j < o.inputs.size() ? input(m, j) : printable(o.output), m.means[j]);
    std::string const step = o.sample_time ? fmt::format(", one each {:g} s", *o.sample_time) : "";
    return {fmt::format("{} samples{}: {} rows fitted, {}{}{}{}", m.samples, step, m.fitted,
                        m.held_out > 0 ? fmt::format("the last {} samples held out", m.held_out) : "none held out",
                        m.skipped > 0 ? fmt::format("; {} rows skipped, which miss a value", m.skipped) : "",
                        means.empty() ? "" : "; means taken off: ", joined(means)),
            fmt::format("{} in double, lambda = {}, prior {}", o.variant, o.forgetting, prior)};
}

/// The order of excitation of each input.
Words input_lines(Identified const& m) {
    Words out;
    if (m.options.inputs.empty())
        say(out, "no input: {} is predicted from its own past alone", printable(m.options.output));
    for (size_t j = 0; j < m.excitation.size(); ++j)
        if (Index const order = m.excitation[j].order; order == Index(m.excitation[j].orders.size()))
            say(out, "input {}: excites enough for every order tried (exciting of order {} at least)", input(m, j),
                order);
        else say(out, "input {}: exciting of order {}", input(m, j), order);
    return out;
}

/// The structure, the order that each criterion suggests, and the equation with its signs. On a page the structure and
/// why it was chosen stand above.
Words structure_lines(Identified const& m, bool on_a_page) {
    bool const given = structure_given(m.options), apart = !given && m.options.forgetting != 1;
    Words out;
    if (!on_a_page || apart)
        say(out, "{} ({}{})", m.structure, m.why, apart ? ", all orders fitted without forgetting" : "");
    if (!given && !m.choice.fits.empty())
        say(out, "AIC says {}, BIC {}, FPE {}, F-test {}", m.choice.aic, m.choice.bic, m.choice.fpe,
            m.choice.f_test > 0 ? fmt::format("{}", m.choice.f_test) : "none");
    if (!out.empty()) out = {joined(out, "; ")};
    out.push_back(equation_text(m.terms, m.options.output));
    return out;
}

void say_tracked(Words& out, Tracked const& t, Words const& names, double confidence) {
    TrackedRow const& last = t.rows.back();
    std::string const happened = counts_text(last.happened);
    say(out,
        "tracked over all rows by {}: one-step fit {} %{}, {} % of the outputs within their {:g} % interval; noise "
        "variance at the end {}{}{}",
        t.text, number_text(t.fit, 4), last.happened.outliers > 0 ? " without the outliers" : "",
        number_text(100 * t.covered, 3), 100 * confidence, number_text(last.noise_variance, 4),
        happened.empty() ? "" : "; ", happened);
    if (t.broken > 0)
        say(out, "warning: {} broke down: {} at row {}; nothing of it is to be used from there on", t.text,
            name_of(t.kind), t.broken);
    for (std::string const& warning : t.warnings) out.push_back("warning: " + warning);
    Words parts;
    for (Index j = 0; j < last.theta.size(); ++j)
        say(parts, "{} = {} +- {}", names[size_t(j)], number_text(last.theta[j], 5),
            number_text(t.quantile * last.theta_sd[j], 2));
    out.push_back("at the end " + joined(parts));
}

void say_model(Words& out, Identified const& m) {
    Clock const clock(m.options);
    double const size = m.poles.empty() ? 0 : std::abs(m.poles[0]);
    out.push_back("poles: " + list_of(m.poles) +
                  (0 < size && size < 1 ? fmt::format("; slowest: time constant {:.3g} {}",
                                                      clock.time(-1 / correctly::log(size)), clock.unit())
                                        : ""));
    if (!m.modes.empty()) out.push_back("modes: " + modes_text(m.modes, clock));
    for (size_t j = 0; j < m.zeros.size(); ++j) say(out, "zeros of {}: {}", input(m, j), list_of(m.zeros[j]));
    for (size_t j = 0; j < m.gain.size() && clock.seconds(); ++j) {
        int const delay = delay_of(m.terms, int(j));
        say(out, "delay of {}: {} ({} samples)", input(m, j), clock.time_text({double(delay)}), delay);
    }
    for (size_t j = 0; j < m.gain.size(); ++j)
        say(out, "steady-state gain of {}: {}", input(m, j),
            std::isfinite(m.gain[j]) ? fmt::format("{:.5g} (sd {})", m.gain[j], number_text(m.gain_sd[j], 2))
            : size >= 1              ? "none, a pole lies on or outside the unit circle"
                                     : "not determined, a pole may lie at 1");
    say(out, "fit: {} one step ahead; held out: {} one step ahead{} (0 %: no better than the mean)",
        percent_text(m.fit_one_step), percent_text(m.held_out_one_step),
        m.options.inputs.empty() ? "" : fmt::format(", {} simulated", percent_text(m.held_out_simulated)));
}

/// Poles, zeros, gain, fit, residuals, arithmetic.
Words result_lines(Identified const& m) {
    Words out;
    bool const model = !m.measured.empty();
    if (model) say_model(out, m);
    if (std::isnan(m.ljung_box.p))
        say(out, "residuals: sigma^2 = {} of the certified minimiser; those of the variant are not numbers",
            number_text(m.sigma2, 4));
    else out.push_back("residuals: " + whiteness_text(m.sigma2, m.ljung_box, m.options.forgetting == 1));
    if (model && m.ljung_box.Q > 0) {
        Words largest;
        auto const add = [&](std::string const& with, Signal const& r, Index at) {
            say(largest, "{} {:.2g} at lag {}", with, r[size_t(at)], at);
        };
        add("their largest correlation: with themselves", m.auto_correlation, largest_at(m.auto_correlation, 1));
        for (size_t j = 0; j < m.cross_correlation.size(); ++j)
            add("with past " + input(m, j), m.cross_correlation[j], largest_at(m.cross_correlation[j]));
        say(out, "{} (99 % bound {:.2g})", joined(largest, "; "), m.bound);
    }
    if (!m.constancy.samples.empty())
        say(out, "constancy: the CUSUM of the recursive residuals {}; that of their squares {}",
            crossing_text(m.constancy.cusum, m), crossing_text(m.constancy.squares, m));
    if (m.options.forgetting != 1)
        say(out, "criteria: AIC, BIC and FPE are those of a fit without forgetting; none here");
    else if (std::isfinite(m.aic))
        say(out, "criteria: AIC {:.6g}, BIC {:.6g}, FPE {:.4g}, of {} parameters over {} rows", m.aic, m.bic, m.fpe,
            m.terms.size(), m.fitted);
    std::string const kappa = std::isfinite(m.condition) ? fmt::format("kappa = {:.3g}", m.condition) : "kappa > 1e308",
                      &variant = m.options.variant;
    auto const digits = [](double x) { return number_text(std::round(10 * x) / 10, 3); };
    if (m.failure)
        say(out, "arithmetic: {} broke down after row {} ({}); {}", variant, m.failure->row,
            m.failure->kind == Health::indefinite ? "P not positive definite" : "not finite", kappa);
    else
        say(out,
            "arithmetic: {} agrees with the certified minimiser in {} of 15.9 digits ({} in its worst component); {}",
            variant, digits(m.digits), digits(m.digits_worst), kappa);
    if (m.tracked) say_tracked(out, *m.tracked, parameter_names(m), m.options.confidence);
    return out;
}

// --- tables ----------------------------------------------------------------------------------------------------------

/// Cells under a head; `line`: the format of a line of text; what stands above and below.
struct Table {
    Words head;
    std::string line = {}, title = {};
    std::vector<Words> rows = {};
    Words below = {};

    /// The head and the rows, a line each.
    std::string text() const {
        std::string out;
        auto const add = [&](Words const& cells) {
            fmt::dynamic_format_arg_store<fmt::format_context> all;
            for (std::string const& cell : cells) all.push_back(cell);
            out += fmt::vformat(line, all);
        };
        add(head);
        std::ranges::for_each(rows, add);
        return out;
    }
};

Table orders_of(Identified const& m) {
    Table out{.head = {"", "order", "parameters", "AIC", "BIC", "FPE", "white: p", "held out"},
              .line = "{:>1} {:>5}  {:>10} {:>10} {:>10} {:>10}  {:>8}  {:>8}\n"};
    for (OrderFit const& f : m.choice.fits)
        out.rows.push_back({f.order == m.order ? "*" : "", std::to_string(f.order), std::to_string(f.parameters),
                            number_text(f.aic, 5), number_text(f.bic, 5), number_text(f.fpe, 3),
                            number_text(f.ljung_box, 2), percent_text(f.held_out)});
    return out;
}

Table cured_table(Cured const& c) {
    Table out{.head = {"parameter", "of", "estimate", "sd", "least squares", "off by sd"},
              .line = "{:>12} {:>9} {:>14} {:>10}"};
    out.title = c.of_noise ? fmt::format(
                                 "noise model: C e with C of order {}, by extended least squares over {} rows; sd is "
                                 "of first order (docs/theory.md 89)",
                                 c.order, c.rows)
                           : fmt::format(
                                 "instruments: the equation's inputs and constant, and further past of each input ({} "
                                 "lag{}), over {} rows; sd is of first order, for noise of any colour "
                                 "(docs/theory.md 90)",
                                 c.order, c.order == 1 ? "" : "s", c.rows);
    for (CuredParameter const& p : c.parameters)
        out.rows.push_back({printable(p.name), p.regressor, number_text(p.value, 6), number_text(p.sd, 2),
                            number_text(p.least_squares, 6), number_text(p.shift(), 2)});
    say(out.below, "their residuals: {}{}", whiteness_text(c.sigma2, c.ljung_box, true),
        c.of_noise || c.ljung_box.white() ? "" : "; they need not be white, the instruments allow for that");
    if (c.health != Health::sound)
        say(out.below, "warning: ud broke down ({}): do not use these numbers", name_of(c.health));
    if (c.of_noise && c.farthest < 1)
        say(out.below, "|C(e^iw) - 1| < 1 at every w (at most {:.3g}): the recursion converges there", c.farthest);
    else if (c.of_noise)
        say(out.below,
            "|C(e^iw) - 1| reaches {}, not below 1: the recursion may converge slowly or not at all: no sd is given",
            number_text(c.farthest, 3));
    return out;
}

/// The parameters; then those of a noise model, and of instruments.
std::vector<Table> parameters_of(Identified const& m) {
    std::vector<Table> out{
        {.head = {"parameter", "of", "estimate", "sd", fmt::format("{:g} % interval", 100 * m.options.confidence)},
         .line = "{:>12} {:>9}  {}"}};
    for (Parameter const& p : m.parameters)
        out[0].rows.push_back({printable(p.name), p.regressor, number_text(p.value, 6), number_text(p.sd, 2),
                               fmt::format("{} ... {}", number_text(p.lower, 5), number_text(p.upper, 5))});
    for (auto const& cured : {m.noise_model, m.instruments})
        if (cured) out.push_back(cured_table(*cured));
    size_t name = 9, of = 4;
    for (Table& t : out) {
        for (Words const& row : t.rows) name = std::max(name, row[0].size()), of = std::max(of, row[1].size());
        t.line = fmt::format("  {{:<{}}}  {{:<{}}} {}\n", name, of, t.line);
    }
    return out;
}

// --- a page ----------------------------------------------------------------------------------------------------------

/// A box for each sentence; kind: "warning", "next".
std::string boxes(std::string const& kind, std::string const& type, Words const& sentences) {
    std::string out;
    for (std::string const& words : sentences)
        out += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", type, kind, escaped(words));
    return out.empty() ? "" : "<ul class=\"claims\">" + out + "</ul>";
}
std::string paragraphs(Words const& lines, char const* of_class = "") {
    std::string out;
    for (std::string const& words : lines) out += fmt::format("<p{}>{}</p>", of_class, escaped(words));
    return out;
}

}  // namespace

std::string percent_text(double x) { return std::isfinite(x) ? fmt::format("{:.2f} %", x) : "-"; }
std::string number_text(double x, int digits) { return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "-"; }

std::vector<std::string> parameter_names(Identified const& m) {
    Words out;
    for (Term const& t : m.terms) out.push_back(printable(t.name));
    return out;
}

std::string Clock::text(Uncertain x, double factor, char const* unit) {
    std::string const space = *unit ? " " : "", sd = number_text(x.sd * factor, 2);
    return number_text(x.value * factor, 4) + space + unit + (sd == "-" ? "" : fmt::format(" (sd {})", sd));
}

std::string as_table(Identified const& m, size_t columns) {
    size_t const width = line_width(columns, 120);
    std::string out;
    auto const in_lines = [&](std::string const& text) { out += wrapped(text, 0, 4, width) + '\n'; };
    auto const on_a_terminal = [&](std::string const& text) {
        if (columns > 0) in_lines(text);
        else out += text + '\n';
    };
    Words const data = data_lines(m);
    on_a_terminal(printable(m.file, 200) + ": " + data[0]);
    on_a_terminal(data[1]);
    std::ranges::for_each(input_lines(m), on_a_terminal);
    for (std::string const& warning : m.warnings()) in_lines("warning: " + warning);
    out += '\n';
    std::ranges::for_each(structure_lines(m, false), on_a_terminal);
    if (!structure_given(m.options) && !m.choice.fits.empty()) out += '\n' + orders_of(m).text();
    out += '\n';
    for (Table const& t : parameters_of(m)) {
        if (!t.title.empty()) in_lines(t.title), out += '\n';
        out += t.text() + '\n';
        std::ranges::for_each(t.below, in_lines);
        if (!t.below.empty()) out += '\n';
    }
    std::ranges::for_each(result_lines(m), in_lines);
    for (std::string const& hint : m.hints()) in_lines("hint: " + hint);
    if (!m.next().empty()) in_lines("next: " + m.next());
    return out;
}

std::string as_page(Identified const& m) {
    std::string body = fmt::format("<header><h1>{}: {}</h1><p class=\"question\">{}</p>",
                                   escaped(printable(std::filesystem::path(m.file).filename().string(), 60)),
                                   escaped(m.structure), escaped(m.why));
    body += boxes("warning", "fails", m.warnings()) + "</header>";
    body += paragraphs(structure_lines(m, true)) + paragraphs(result_lines(m)) + boxes("hint", "next", m.hints());
    if (!m.next().empty()) body += boxes("next", "next", {m.next()});
    for (Figure const& figure : figures_of(m)) body += figure_html(figure);
    for (Table const& t : parameters_of(m))
        body += fmt::format("<section>{}\n{}{}</section>\n",
                            t.title.empty() ? "<h2>Parameters</h2>" : paragraphs({t.title}), table_html(t.head, t.rows),
                            paragraphs(t.below));
    body += paragraphs(data_lines(m), " class=\"soft\"") + paragraphs(input_lines(m), " class=\"soft\"");
    if (m.run) body += as_html(*m.run);
    return page(m.file + ": identified", body);
}

std::string tracked_csv(Tracked const& t, std::vector<std::string> const& names) {
    std::string out = "row,y,predicted,predicted_sd,noise_variance";
    for (std::string name : names) {
        std::replace(name.begin(), name.end(), '"', '\'');
        out += fmt::format(",\"{0}\",\"{0}_sd\"", name);
    }
    out += ",refactored,unusable,outliers,changes,windups,breakdowns\n";
    auto const cell = [](double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; };
    for (TrackedRow const& r : t.rows) {
        out += fmt::format("{},{},{},{},{}", r.row, cell(r.y), cell(r.predicted), cell(r.sd), cell(r.noise_variance));
        for (Index j = 0; j < r.theta.size(); ++j) out += fmt::format(",{},{}", cell(r.theta[j]), cell(r.theta_sd[j]));
        CompositionCounts const& h = r.happened;
        out += fmt::format(",{},{},{},{},{},{}\n", h.refactored, h.unusable, h.outliers, h.changes, h.windups,
                           h.breakdowns);
    }
    return out;
}

}  // namespace rlslab::identify
