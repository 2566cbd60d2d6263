// By compare itself and its rules.
#include "studies/published/naming.hpp"

#include <rlslab/catalogue/catalogue.hpp>

#include <rlslab/reference/certified.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::studies::naming {
using namespace compare;
namespace {

/// From the catalogue's list, so that new forms take part.
std::vector<std::string> nameable() {
    std::vector<std::string> out;
    for (CatalogueEntry const* const entry : one_entry_each())
        if (entry->block == 1 && cost(entry->variant, 2)) out.emplace_back(entry->variant);
    return out;
}

}  // namespace

std::optional<Comparison> compared(Records const& records, DrawnProblem const& problem, std::uint64_t orders) {
    if (!determine_theta(records, problem.forgetting)) return {};
    return compare::compare(records, {.forgetting = problem.forgetting,
                                      .p0 = problem.p0,
                                      .variants = nameable(),
                                      .arithmetics = {problem.word},
                                      .seed = orders,
                                      .threads = 1,
                                      .timings = false});
}

std::string named_in(std::optional<Comparison> const& comparison) {
    if (!comparison || comparison->recommendations.front().variant.empty()) return "none";
    return comparison->recommendations.front().variant;
}

Losses::Losses(Comparison const& comparison) {
    for (Result const& r : comparison.results)
        if (takes_single_rows(r) && is_sound(r)) sound.push_back(&r);
    for (Result const* r : sound) least = std::min(least, loss_of(*r, sound).digits);
}
double Losses::of(std::string const& variant) const {
    for (Result const* r : sound)
        if (r->entry->variant == variant) return loss_of(*r, sound).digits;
    return INFINITY;
}

bool determine_theta(Records const& records, double forgetting) {
    Problem<double> const without{.size = records.parameters(), .forgetting = forgetting, .prior = std::nullopt};
    return certified(without, records, {records.rows()}).front().status() != Status::singular;
}

Statistic share(std::string column, bool (*holds)(double), std::string const& over, Estimate estimate) {
    return Statistic(
               [=](Table const& t) {
                   std::vector<double> const x = t.numbers(column);
                   return double(std::ranges::count_if(x, holds)) / double(x.size());
               },
               estimate)
        .over(over);
}

Statistic more_often_than(std::string form) {
    Statistic const out(
        [=](Table const& of) {
            return double(is_half_a_digit(of.number("loss"))) - double(is_half_a_digit(of.number(form)));
        },
        Estimate::mean);
    return out.over("problem");
}

Judge in_band(Selection const& rows, Statistic const& of, double from, double to, std::vector<std::string> const& by) {
    return rows.judged([=](Table const& t) {
        return t.empty() ? Judgement{Verdict::undecided, "none"} : within(t, by, of, from, to);
    });
}

}  // namespace rlslab::studies::naming
