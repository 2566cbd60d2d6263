// The verdict of a comparison in sentences.
#include "src/lab/compare/answer.hpp"
#include "src/lab/compare/words.hpp"
#include "src/lab/compare/digits_answer.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::compare {
namespace {

Result const& result_of(Comparison const& c, std::string const& arithmetic, std::string const& variant) {
    return *std::ranges::find_if(c.results, [&](Result const& x) {
        return x.entry->variant == variant && x.entry->arithmetic->name == arithmetic;
    });
}

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

std::string class_of(std::string_view variant) {
    std::string out;
    bool capital = true;
    for (char const c : variant) {
        if (c != '_') out += capital ? char(c - 'a' + 'A') : c;
        capital = c == '_';
    }
    return out;
}

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

}  // namespace rlslab::compare
