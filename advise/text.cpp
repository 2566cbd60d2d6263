// The advice in words, in JSON, and in C++ to paste.
#include "advise/advise.hpp"
#include "compare/answer.hpp"
#include "compare/words.hpp"

#include <rlslab/core/text.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

using Json = nlohmann::ordered_json;

std::string bold(std::string const& text, bool colour) { return colour ? "\x1b[1m" + text + "\x1b[0m" : text; }

std::string arithmetic_of(Tried const& t) { return t.comparison.options.arithmetics.front(); }

/// "2^-3"
std::string power(double scaling) { return fmt::format("2^{}", std::ilogb(scaling)); }

/// What holds the digits down in this arithmetic.
std::string limit(Tried const& t) {
    if (!t.nearest) return "every variant broke down or kept nothing";
    double const most = kept(t, *t.nearest);
    std::string const found = fmt::format("at most {} digits ({})", tenths(most), t.nearest->entry->variant);
    if (most == t.from_data) return found + ": rounding the data to it leaves no more";
    if (most == t.from_prior) return found + ": the prior leaves no more, and a weaker one was not to be had";
    return found;
}

std::string scaling_text(Advice const& a) {
    Tried const& t = *a.chosen();
    if (t.scaling.size() == 0) return "none is needed: P0 is scaled to the columns, and no number leaves the range";
    std::vector<std::string> factors;
    for (size_t i = 0; i < a.model.regressors.size(); ++i)
        factors.push_back(fmt::format("{} times {}", a.model.regressors[i], power(t.scaling[Index(i)])));
    return fmt::format("{}, {} times {}; theta_i of the columns as given is theta_i times the regressor's factor over the output's",
                       fmt::join(factors, ", "), a.model.output, power(t.output_scaling));
}

std::string guard_text(Advice const& a) {
    if (!a.guard) return "none for this variant in this arithmetic";
    GuardCounts const& n = a.guard->counts;
    if (a.guard->same_bits) return "Guarded<> with its default policy: on this record it changed no bit of theta";
    return fmt::format(
        "none: on this record the default policy met {} outliers, {} changes, {} windups and {} breakdowns, and changed theta", n.outliers,
        n.changes, n.windups, n.breakdowns);
}

std::string paste(Advice const& a) {
    Result const& r = *a.choice();
    Comparison c = a.chosen()->comparison;
    c.model = a.model;
    std::string remarks;
    if (a.chosen()->scaling.size() > 0) remarks = "// the columns as the filter takes them: " + scaling_text(a) + "\n";
    return code(c, {.variant = std::string(r.entry->variant),
                    .arithmetic = std::string(r.entry->arithmetic->name),
                    .guarded = a.guard && a.guard->same_bits,
                    .remarks = remarks});
}

std::string line(std::string const& head, std::string const& text) {
    return "  " + head + std::string(12 - head.size(), ' ') + wrapped(text, 14, 14, text_width) + "\n";
}

}  // namespace

std::string as_text(Advice const& a, bool colour) {
    Comparison const& first = a.tried.front().comparison;
    std::string out = fmt::format("{}: {} rows, {} parameters, lambda {:g}; wanted: {} digits of every parameter\n\n", a.model.file,
                                  first.rows, first.size, a.options.forgetting, tenths(a.options.digits));
    for (Tried const& t : a.tried)
        if (t.enough.empty())
            out += wrapped(fmt::format("{}{}: {}", arithmetic_of(t), t.scaling.size() > 0 ? ", columns scaled" : "", limit(t)), 0, 4,
                           text_width) +
                   "\n";
    Tried const* const t = a.chosen();
    if (!t) {
        out += fmt::format("\n{}\n", bold("nothing tried keeps them", colour));
        return out + "what may: a longer arithmetic (--arithmetic), fewer or less dependent regressors, more rows\n";
    }
    Result const& r = *a.choice();
    out += fmt::format("{}\n", bold(fmt::format("use {} in {}", r.entry->variant, arithmetic_of(*t)), colour));
    out += line("keeps", fmt::format("{} digits of the worst parameter, in nine tenths of {} checkpoints along {}; never broke down",
                                     tenths(kept(*t, r)), t->comparison.checkpoints.size(),
                                     r.runs > 1 ? fmt::format("{} orders of the rows", r.runs) : "the record"));
    out += line("of these", fmt::format("arithmetic {}, prior {}{}", tenths(r.spread->worst.low), tenths(t->from_prior),
                                        t->from_data < 99 ? fmt::format(", rounding the data {}", tenths(t->from_data)) : ""));
    out += line("costs", fmt::format("{} operations a row", *r.operations));
    DefaultPrior const& prior = *t->comparison.scaled_prior;
    out += line("prior", fmt::format("P0_ii = (c / s_i)^2, c = {:g}, s_i the size of regressor i", prior.c));
    out += line("scaling", scaling_text(a));
    out += line("guard", guard_text(a));
    std::vector<std::string> others;
    for (Result const* other : t->enough)
        if (other != &r) others.push_back(fmt::format("{} {} ({})", other->entry->variant, tenths(kept(*t, *other)), *other->operations));
    out += line("also", others.empty() ? "no other variant" : fmt::format("{} (digits, operations)", fmt::join(others, ", ")));
    std::string const text = paste(a);
    return out + (text.empty() ? "" : "\n" + text);
}

std::string as_json(Advice const& a) {
    auto const tenth = [](double x) { return std::isfinite(x) ? Json::parse(fmt::format("{:.1f}", x + 0.0)) : Json(nullptr); };
    Json out{{"digits", a.options.digits}, {"forgetting", a.options.forgetting}, {"tried", Json::array()}};
    for (Tried const& t : a.tried) {
        Json one{{"arithmetic", arithmetic_of(t)},
                 {"c", t.comparison.scaled_prior->c},
                 {"digits_left_by_prior", tenth(t.from_prior)},
                 {"digits_left_by_rounding_the_data", t.from_data < 99 ? tenth(t.from_data) : Json(nullptr)},
                 {"column_scaling", std::vector<double>(t.scaling.begin(), t.scaling.end())},
                 {"output_scaling", t.output_scaling},
                 {"variants", Json::array()}};
        for (Result const& r : t.comparison.results)
            one["variants"].push_back({{"variant", r.entry->variant},
                                       {"digits", r.spread ? tenth(kept(t, r)) : Json(nullptr)},
                                       {"broken", r.broken},
                                       {"operations", r.operations ? Json(*r.operations) : Json(nullptr)},
                                       {"enough", std::ranges::find(t.enough, &r) != t.enough.end()}});
        out["tried"].push_back(std::move(one));
    }
    out["advice"] = nullptr;
    if (Result const* const r = a.choice()) {
        out["advice"] = {
            {"variant", r->entry->variant}, {"arithmetic", r->entry->arithmetic->name}, {"guarded", a.guard && a.guard->same_bits}};
        if (a.guard)
            out["advice"]["guard_met"] = {{"outliers", a.guard->counts.outliers},
                                          {"changes", a.guard->counts.changes},
                                          {"windups", a.guard->counts.windups},
                                          {"breakdowns", a.guard->counts.breakdowns}};
        out["advice"]["code"] = paste(a);
    }
    return out.dump(1) + "\n";
}

}  // namespace rlslab
