// How the NIST regressions are scored, the recursive table of docs/literature.md 3.5, and the words of the study's
// claims.
#pragma once

#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include "studies/published/nist_data.hpp"

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/core/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rlslab::studies::strd {

/// NIST's log relative error of the worst parameter against these decimals.
inline double decimal_digits(std::string const& set, Vector<Reference> const& theta) {
    double worst = INFINITY;
    for (Index i = 0; i < theta.size(); ++i) {
        Reference const exact = decimal(set, i);
        worst = std::min(worst, -correctly::log10(static_cast<double>(abs(Reference(theta[i] - exact)) / abs(exact))));
    }
    return worst;
}
inline Records shuffled(Records records, Seed seed) {
    for (Index i = records.rows() - 1; i > 0; --i) {
        Index const j = Index(seed.next() % std::uint64_t(i + 1));
        records.psi.col(i).swap(records.psi.col(j));
        std::swap(records.y[i], records.y[j]);
    }
    return records;
}

/// Judges that each entry is met within 0.7 in file order. Adds the range over other orders of the rows for the entries
/// that are not met.
inline Judgement table_is_met(Table const& t) {
    int met = 0, entries = 0;
    std::string missed;
    for (auto const& [set, row] : listed_digits())
        for (auto const& [variant, digits] : row) {
            std::vector<double> const ours = t.where("set", set).where("variant", variant).numbers("digits");
            bool const close = std::abs(ours.front() - digits) <= 0.7;
            auto const [least, most] = std::minmax_element(ours.begin(), ours.end());
            ++entries, met += close;
            if (!close)
                missed += fmt::format("; {} {}: {}, ours {:.1f} ({:.1f} to {:.1f})", set, variant, digits, ours.front(),
                                      *least, *most);
        }
    return {met == entries, fmt::format("{} of {}{}", met, entries, missed)};
}

inline Table prior_of(Table const& t, double c2) {
    return t.where("c2", [=](double c) { return std::abs(c / c2 - 1) < 0.01; });
}
/// Median digits of one set, less those of another.
inline Statistic fall(std::string from, std::string to) {
    return Statistic(
               [=](Table const& t) {
                   return median("digits")(t.where("set", from)) - median("digits")(t.where("set", to));
               },
               Estimate::middle)
        .over("order");
}
/// Median digits of a variant, less qr's.
inline Statistic lead(std::string variant) {
    return Statistic(
               [=](Table const& t) {
                   return median("digits")(t.where("variant", variant)) - median("digits")(t.where("variant", "qr"));
               },
               Estimate::middle)
        .over("order");
}
inline std::vector<std::string> const plain = words(covariance_forms());
inline std::vector<std::string> const rooted = words(triangular_forms());

}  // namespace rlslab::studies::strd
