// A comparison as text for people: the answer, then what it rests on.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/digits_answer.hpp"

#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

/// Six digits of a decimal number. Where binary64 does not reach, the power of ten is kept as text.
std::string six_digits(std::string const& number) {
    double const x = std::strtod(number.c_str(), nullptr);
    size_t const e = number.find('e');
    if (e == std::string::npos || std::isnormal(x)) return std::isfinite(x) ? fmt::format("{:.6g}", x) : number;
    std::string digits = fmt::format("{:.6g}", std::strtod(number.substr(0, e).c_str(), nullptr));
    long exponent = std::strtol(number.c_str() + e + 1, nullptr, 10);
    if (digits.ends_with("10")) digits.pop_back(), ++exponent;
    return fmt::format("{}e{:+03}", digits, exponent);
}

/// Both exact solutions, and in how many digits they agree.
std::string theta_text(Comparison const& c) {
    size_t name = 11;
    for (std::string const& one : c.names) name = std::max(name, one.size());
    std::string out =
        fmt::format("{:<{}}  {:>14}  {:>14}  agree\n", "exact theta", name, "least squares", "with the prior");
    for (size_t i = 0; i < c.names.size(); ++i)
        out += fmt::format("{:<{}}  {:>14}  {:>14}  {:>5}\n", c.names[i], name, six_digits(c.least_squares[i]),
                           six_digits(c.theta[i]), tenths(c.agreement[i]));
    return out;
}

std::string indented(std::string const& text) {
    std::string out;
    for (size_t begin = 0, end; begin < text.size(); begin = end + 1) {
        end = text.find('\n', begin);
        out += (end > begin ? "    " : "") + text.substr(begin, end + 1 - begin);
    }
    return out;
}

/// Colours as in a terminal, or nothing.
struct Paint {
    bool on;
    std::string operator()(char const* code, std::string const& text) const {
        return on ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
    }
};

/// The regressors are a delay line: the fast forms, apart.
std::string fast_text(Comparison const& c, Paint const& paint) {
    std::string out;
    std::string_view arithmetic;
    for (FastResult const& r : c.fast) {
        if (r.arithmetic != arithmetic) {
            arithmetic = r.arithmetic;
            out += '\n' + paint("1", fmt::format("fast forms in {}", arithmetic)) +
                   paint("2", fmt::format("{:>{}}  {:<19}{:>6}", "prediction error", 47 - 14 - arithmetic.size(),
                                          "breakdown", "ops")) +
                   '\n';
        }
        std::string const broke =
            r.breakdown ? fmt::format("{} at {}", name_of(r.breakdown->kind), r.breakdown->step) : "none";
        out += paint(r.breakdown ? "31" : "0", fmt::format("  {:<28}{:>17}  {:<19}{:>6}", r.form,
                                                           known(r.digits, "{:.1f}"), broke, r.operations)) +
               '\n';
    }
    return out;
}

/// The results of a variant, one for each arithmetic that was tried, in their order.
struct Row {
    std::string_view variant;
    std::vector<Result const*> results;
};
std::vector<Row> shown_rows(Comparison const& c) {
    std::vector<Row> out;
    for (Result const& r : c.results) {
        if (!is_shown(c, r.entry->variant)) continue;
        auto row = std::ranges::find(out, r.entry->variant, &Row::variant);
        if (row == out.end()) row = out.insert(row, {r.entry->variant, {}});
        row->results.push_back(&r);
    }
    return out;
}

/// Digits that half of the checkpoints reach: a row a variant, and as many arithmetics side by side as there is room
/// for; with a composition one, and behind it what the composition did.
std::string table_text(Comparison const& c, Paint const& paint, size_t width) {
    std::vector<Row> const rows = shown_rows(c);
    std::vector<Arithmetic const*> arithmetics;
    size_t name = 11;
    for (Row const& row : rows) {
        name = std::max(name, row.variant.size());
        for (Result const* r : row.results)
            if (std::ranges::find(arithmetics, r->entry->arithmetic) == arithmetics.end())
                arithmetics.push_back(r->entry->arithmetic);
    }
    bool const plain = c.options.composition.empty();
    constexpr size_t group = 23, operations = 7;
    size_t const room = (width - std::min(width, name + 2 + operations)) / group,
                 most = plain ? std::max<size_t>(room, 1) : 1;
    std::string out;
    for (size_t begin = 0; begin < arithmetics.size(); begin += most) {
        std::vector<Arithmetic const*> const these(
            arithmetics.begin() + long(begin), arithmetics.begin() + long(std::min(begin + most, arithmetics.size())));
        std::string titles, columns;
        for (Arithmetic const* a : these) {
            titles += fmt::format("{:>{}}", fmt::format("{}, of {:.1f}", a->name, a->decimal_digits()), group);
            columns += fmt::format("{:>9}{:>7}{:>7}", "theta", "worst", "P");
        }
        out += '\n' + paint("1", fmt::format("  {:<{}}{}", "digits kept", name, titles)) + '\n' +
               paint("2", fmt::format("  {:<{}}{}{:>{}}", "", name, columns, "ops", operations)) + '\n';
        for (Row const& row : rows) {
            bool best = false, broke = false;
            std::string cells, ops = "-", what;
            for (Arithmetic const* a : these) {
                auto const r = std::ranges::find(row.results, a, [](Result const* x) { return x->entry->arithmetic; });
                if (r == row.results.end()) {
                    cells += std::string(group, ' ');
                    continue;
                }
                best = best || is_recommended(c, **r), broke = broke || (*r)->broken + (*r)->others.broken > 0;
                std::string_view indent = "  ";
                for (auto const m : PerMeasure<Spread>::all()) {
                    cells += fmt::format("{}{:>7}", indent, (*r)->spread ? tenths((*(*r)->spread.*m).median) : "-");
                    indent = "";
                }
                if ((*r)->operations) ops = known((*r)->operations, "{}");
                if (!plain) what = counts_text(c, **r);
            }
            std::string line = fmt::format("{} {:<{}}{}{:>{}}",
                                           best    ? '*'
                                           : broke ? '!'
                                                   : ' ',
                                           row.variant, name, cells, ops, operations);
            if (!what.empty())
                line += line.size() + 2 + what.size() > width ? "\n    " + wrapped(what, 4, 4, width) : "  " + what;
            out += paint(best ? "32" : broke ? "31" : "0", line) + '\n';
        }
    }
    return out;
}

/// "ud 6.4 float, 15.2 double; symmetric at least 3.6, 12.4": the recommended form or the first shown, and the first of
/// those that have a bound, where a digit is predicted; "".
std::string predicted_text(Comparison const& c) {
    std::string out;
    bool whole = true;  // in each arithmetic
    for (bool const at_least : {false, true}) {
        auto const is_of = [&](Result const& r) {
            return r.predicted && r.predicted->at_least == at_least && is_shown(c, r.entry->variant);
        };
        auto named = std::ranges::find_if(c.results, [&](Result const& r) { return is_of(r) && is_recommended(c, r); });
        if (named == c.results.end()) named = std::ranges::find_if(c.results, is_of);
        if (named == c.results.end()) continue;
        std::vector<std::string> digits;
        auto const of_same = [&](Result const& r) { return r.entry->variant == named->entry->variant; };
        whole = whole && std::ranges::all_of(c.results, [&](Result const& r) { return !of_same(r) || r.predicted; });
        for (Result const& r : c.results)
            if (of_same(r) && r.predicted)
                digits.push_back(tenths(r.predicted->digits) +
                                 (whole && !out.empty() ? "" : fmt::format(" {}", r.entry->arithmetic->name)));
        out += fmt::format("{}{}{} {}", out.empty() ? "" : "; ", named->entry->variant, at_least ? " at least" : "",
                           fmt::join(digits, ", "));
    }
    return out;
}

/// What the probes show, of the forms in the table.
std::string probes_text(Comparison const& c, Paint const& paint, size_t width) {
    std::string titles, columns, lines;
    std::string_view last;
    for (Result const& r : c.results) {
        if (!r.probed || r.entry->arithmetic->name == last) continue;
        last = r.entry->arithmetic->name;
        titles += fmt::format("{:>30}", last);
        columns += fmt::format("{:>12}{:>9}{:>9}", "estimate", "bound", "truth");
    }
    if (titles.empty()) return "";
    for (Row const& row : shown_rows(c)) {
        std::string cells;
        for (Result const* r : row.results)
            if (r->probed)
                cells += fmt::format("{:>12.1e}{:>9.1e}{:>9}", r->probed->estimate, r->probed->bound,
                                     known(r->probed->truth, "{:.1e}"));
        if (!cells.empty()) lines += fmt::format("  {:<16}{}\n", row.variant, cells);
    }
    return '\n' + paint("1", fmt::format("  {:<16}{}", "probes", titles)) + '\n' +
           paint("2", fmt::format("  {:<16}{}", "", columns)) + '\n' + lines +
           wrapped(probes_sentence(c), 0, 4, width) + '\n';
}

/// Whether what storing the data does is worth a line: it costs a digit, or more than digits.
bool is_told(RoundingEffect const& s, Comparison const& c) {
    auto const a =
        std::ranges::find(c.results, s.arithmetic, [](Result const& r) { return r.entry->arithmetic->name; });
    return s.forgetting != c.options.forgetting || s.rank < c.size || !s.in_range || !s.data_in_range ||
           !s.theta_digits || *s.theta_digits < a->entry->arithmetic->decimal_digits() - 1;
}

/// What broke down, or is foretold to, in an arithmetic, with the forms that the table leaves out; "".
std::string breakdowns_text(Comparison const& c, std::string_view arithmetic) {
    std::vector<std::string> out;
    for (Result const& r : c.results)
        if (r.entry->arithmetic->name == arithmetic && (r.broken + r.others.broken > 0 || r.foretold))
            out.push_back(fmt::format("{} {}", r.entry->variant, breakdown_text(r)));
    return out.empty() ? "" : fmt::format("breakdown in {}: {}", arithmetic, fmt::join(out, ", "));
}

}  // namespace

std::string as_table(Comparison const& c, bool colour, size_t columns) {
    Paint const paint{colour};
    size_t const width = line_width(columns, text_width);
    auto const head = [&](std::string const& name, std::string const& text) {
        return fmt::format("{:<12}", name) + wrapped(text, 12, 12, width) + '\n';
    };
    std::string out = c.digits ? answer_text(*c.digits, colour, columns)
                               : paint("32", verdict(c, columns > 0 ? width : std::string::npos));
    for (std::string const& warning : warnings(c)) out += paint("31", head("warning", warning));
    if (std::string const paste = code(c); !paste.empty() && !c.digits)
        out += '\n' + indented(columns > 0 ? folded(paste, columns - 4) : paste);

    std::string const condition = std::isinf(c.condition) ? "beyond 1e308" : fmt::format("{:.2g}", c.condition);
    std::string record = c.model.file.empty() ? "" : c.model.file + ": ";
    record += fmt::format("{} rows", c.rows) + (c.skipped > 0 ? fmt::format(", {} skipped", c.skipped) : "");
    if (c.run && c.run->rows > 0 && c.run->rows < c.rows + c.skipped)
        record += fmt::format(" (with those that --time put between the {} of the file)", c.run->rows);
    out += '\n' + head("record", record + fmt::format("; {} parameter{}, condition {}, lambda {}", c.size,
                                                      c.size == 1 ? "" : "s", condition, c.options.forgetting));
    out += head("prior", prior_text(c));
    bool const plain = c.options.composition.empty();
    if (!plain) out += head("composition", composition_text(c.options.composition)) + head("digits", against_text(c));
    if (std::string const predicted = predicted_text(c); !predicted.empty()) out += head("predicted P", predicted);
    out += '\n' + theta_text(c) + table_text(c, paint, width);

    std::vector<std::string> notes;
    for (size_t i = 0; i < c.results.size(); ++i) {
        std::string_view const arithmetic = c.results[i].entry->arithmetic->name;
        if (i > 0 && c.results[i - 1].entry->arithmetic->name == arithmetic) continue;
        for (RoundingEffect const& s : c.rounding)
            if (s.arithmetic == arithmetic && is_told(s, c))
                notes.push_back(fmt::format("{} {}", arithmetic, rounding_text(s, c)));
        notes.push_back(breakdowns_text(c, arithmetic));
        notes.push_back(other_orders_text(c, arithmetic));
    }
    notes.push_back(foretold_text(c));
    if (c.digits)
        notes.push_back("The table is for the prior above it. The answer has a prior and a scaling of its own.");
    for (std::string const& note : notes)
        if (!note.empty()) out += wrapped(note, 0, 4, width) + '\n';
    out += probes_text(c, paint, width) + fast_text(c, paint);
    return out +
           paint("2", wrapped("Columns: rlslab compare --help. All forms, spreads, times: --out, --csv, --json", 0, 0,
                              width)) +
           '\n';
}

}  // namespace rlslab::compare
