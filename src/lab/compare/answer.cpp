// From a comparison to a sentence and a few lines of C++.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/digits_answer.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
using namespace report;
namespace {

/// The arithmetics of the hardware, named as in C++, the shortest first.
constexpr std::string_view hardware[] = {"float", "double"};

Result const& result_of(Comparison const& c, std::string const& arithmetic, std::string const& variant) {
    return *std::ranges::find_if(c.results, [&](Result const& x) {
        return x.entry->variant == variant && x.entry->arithmetic->name == arithmetic;
    });
}

std::string comment(std::string const& head, std::vector<std::string> const& items) {
    std::string const begin = "// " + head + "(";
    return begin + listed(items, "//" + std::string(begin.size() - 2, ' '), begin.size()) + ")\n";
}

}  // namespace

std::string class_of(std::string_view variant) {
    std::string out;
    bool capital = true;
    for (char const c : variant) {
        if (c != '_') out += capital ? char(c - 'a' + 'A') : c;
        capital = c == '_';
    }
    return out;
}

namespace {

/// "ud is 0.5 digits below the best form in P", or, behind another such text, "conventional 2.8 below in P".
std::string loss_text(Comparison const& c, Recommendation const& r, Loss const& loss, bool next, bool first) {
    std::string const who = next ? fmt::format("the next, {},", loss.variant) : loss.variant;
    if (std::isfinite(loss.digits) && loss.digits < 0.05)
        return who + (first ? " is as good as the best form" : " is as good");
    if (std::isfinite(loss.digits))
        return fmt::format("{} {}{:.1f}{} in {}", who, first ? "is " : "", loss.digits,
                           first ? " digits below the best form" : " below", loss.of);
    Result const& lost = result_of(c, r.arithmetic, loss.variant);
    return fmt::format("{} {}", who,
                       lost.broken + lost.others.broken > 0 ? "broke down: " + breakdown_text(lost) : "has no answer");
}

/// What the recommended one loses to the best of each measure, where it does, then the runner-up (but not the one of
/// beside_text) and `conventional`; or "".
std::string losses_text(Comparison const& c, Recommendation const& r) {
    std::vector<std::string> out;
    for (size_t i = 0; i < r.losses.size(); ++i)
        if ((i > 0 || r.losses[i].digits > 0) && (i != 1 || r.losses[i].variant != r.cheapest))
            out.push_back(loss_text(c, r, r.losses[i], i == 1, out.empty()));
    return fmt::format("{}", fmt::join(out, "; "));
}

/// What is within half a digit for less, and why `information`; or "".
std::string beside_text(Comparison const& c, Recommendation const& r) {
    if (r.exact_rows > 0)
        return fmt::format("its sums of products are exact up to {} rows of such numbers", r.exact_rows);
    if (r.cheapest.empty()) return "";
    Result const& x = result_of(c, r.arithmetic, r.cheapest);
    return fmt::format("within half a digit for less: {}, {:.1f} digits, {} operations", r.cheapest,
                       x.spread->theta.median, *x.operations);
}

}  // namespace

std::string verdict(Comparison const& c, size_t width) {
    std::string out;
    std::vector<std::pair<std::string, std::vector<std::string>>> without;  // why, and where
    size_t arithmetic = 0, variant = 0;
    for (Recommendation const& r : c.recommendations) {
        if (r.variant.empty()) {
            std::string const why = (r.too_short ? "has too few digits for this record: " : "use none: ") + r.why;
            auto const known =
                std::ranges::find(without, why, &std::pair<std::string, std::vector<std::string>>::first);
            (known == without.end() ? without.emplace_back(why, std::vector<std::string>()) : *known)
                .second.push_back(r.arithmetic);
            continue;
        }
        arithmetic = std::max(arithmetic, r.arithmetic.size());
        variant = std::max(variant, r.variant.size());
    }
    for (Recommendation const& r : c.recommendations) {
        if (r.variant.empty()) continue;
        Result const& best = result_of(c, r.arithmetic, r.variant);
        PerMeasure<Spread> const& spread = *best.spread;
        size_t const indent = arithmetic + 5;
        std::string const keeps = fmt::format(
            "in {:<{}}  use {:<{}}  keeps {:.1f} digits of theta ({:.1f} to {:.1f}), {:.1f} of its worst component, "
            "{:.1f} of P{}{}",
            r.arithmetic, arithmetic, r.variant, variant, spread.theta.median, spread.theta.low, spread.theta.high,
            spread.worst.median, spread.covariance.median,
            c.options.composition.empty() ? fmt::format("; {} operations", *best.operations) : "",
            best.ns_per_update ? fmt::format(", {:.0f} ns", *best.ns_per_update) : "");
        std::vector<std::string> lines{beside_text(c, r), losses_text(c, r)};
        std::erase(lines, "");
        out += wrapped(keeps + (lines.empty() ? "" : ";"), 0, indent, width) + '\n';
        for (std::string const& line : lines)
            out += std::string(indent, ' ') +
                   wrapped(line + (&line == &lines.back() ? "" : ";"), indent, indent, width) + '\n';
    }
    for (auto const& [why, where] : without)
        out += wrapped(fmt::format("in {}  {}", fmt::join(where, ", "), why), 0, 4, std::min(width, text_width)) + '\n';
    return out;
}

std::string folded(std::string const& code, size_t width) {
    std::string out;
    for (size_t begin = 0, end; begin < code.size(); begin = end + 1) {
        end = std::min(code.find('\n', begin), code.size());
        std::string line = code.substr(begin, end - begin);
        bool const comment = line.starts_with("//");
        while (comment && code.compare(end, 6, "\n//   ") == 0) {
            size_t const from = code.find_first_not_of(' ', end + 3);
            begin = from, end = std::min(code.find('\n', from), code.size());
            line += ' ' + code.substr(begin, end - begin);
        }
        line = wrapped(line, 0, comment ? 0 : 4, width - (comment && line.size() > width ? 5 : 0));
        for (size_t at = line.find('\n'); comment && at != line.npos; at = line.find('\n', at + 1))
            line.insert(at + 1, "//   ");
        out += line + '\n';
    }
    return out;
}

Recommendation const* coded(Comparison const& c) {
    for (std::string_view const name : hardware)
        for (Recommendation const& r : c.recommendations)
            if (r.arithmetic == name && !r.variant.empty()) return &r;
    return nullptr;
}

std::string code(Comparison const& c) {
    if (c.digits) return code(*c.digits);
    Recommendation const* const r = coded(c);
    return r ? code(c, {.variant = r->variant, .arithmetic = r->arithmetic}) : "";
}

std::string code(Comparison const& c, CodedFilter const& filter) {
    std::string const& T = filter.arithmetic;
    if (std::ranges::find(hardware, T) == std::end(hardware)) return "";
    Composition const& composition = c.options.composition;
    std::string out = filter.guarded ? "#include <rlslab/adapt/guard.hpp>\n" : composition_includes(composition);
    std::string const variant = fmt::format("#include <rlslab/variants/{}.hpp>\n", filter.variant);
    out += (out.find(variant) == out.npos ? variant : "") + "\n";
    out += comment(fmt::format("{} = psi'theta,  psi = ", c.model.output.empty() ? "y" : c.model.output),
                   c.model.regressors);
    out += comment("theta = ", c.names);
    std::vector<std::string> means;
    for (auto const& [column, mean] : c.model.means) means.push_back(fmt::format("{} less {}", column, mean));
    if (!means.empty()) out += comment("the columns as the filter takes them: ", means);
    if (!filter.exponents.empty()) {
        std::vector<std::string> factors;
        for (int const e : filter.exponents) factors.push_back(fmt::format("2^{}", e));
        out += comment("then each regressor times ", factors);
        out += fmt::format(
            "// and the output times 2^{}; theta_i of the columns before that = theta_i times the regressor's factor "
            "times 2^{}\n",
            filter.output_exponent, -filter.output_exponent);
    }
    std::string prior = fmt::format("{{.variance = {:#}}}", c.options.p0.value_or(0));
    if (c.scaled_prior) {
        Matrix<double> const P0 = *c.scaled_prior->prior().covariance;
        std::vector<std::string> entries;
        for (Index i = 0; i < c.size; ++i)
            entries.push_back(fmt::format("{:#}", P0(i, i)));  // with a point: a whole number may not narrow to float
        std::string const begin = fmt::format("rlslab::Vector<{}> const P0{{{{", T);
        out += begin + listed(entries, std::string(begin.size(), ' '), begin.size()) + "}};\n";
        prior = "{.covariance = P0.asDiagonal()}";
    }
    constexpr Index largest_fixed = 16;  // a fixed size keeps everything in the object: no heap after the start
    std::string type = fmt::format("rlslab::{}<{}{}>", class_of(filter.variant), T,
                                   c.size <= largest_fixed ? fmt::format(", {}", c.size) : "");
    if (filter.guarded) type = fmt::format("rlslab::Guarded<{}>", type);
    std::string const problem = fmt::format("{{.size = {}, .forgetting = {:#}, .prior = rlslab::Prior<{}>{}}}", c.size,
                                            c.options.forgetting, T, prior);
    if (composition.empty()) out += fmt::format("{} filter({});\n", type, problem);
    else
        out += fmt::format("rlslab::Problem<{}> const problem{};\n", T, problem) +
               composition_code(composition, type, filter.variant, T, c.size);
    out +=
        filter.guarded || !composition.guard.empty()
            ? "// each row: filter.update(psi, y); filter.signal() is what the guard saw, filter.counts() how often\n"
            : "// a row: step = filter.update(psi, y); use theta() if step.health is sound\n";
    return out;
}

}  // namespace rlslab::compare
