// The rules of draws.hpp.
#include "src/lab/compare/draws.hpp"
#include "src/lab/compare/recommend.hpp"

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
namespace {

constexpr double within = 0.5, hopeless = 2;  // digits

/// Odd numbers over a power of two, of few bits.
constexpr double factors[] = {1,          15. / 16,   31. / 32,   29. / 32,  27. / 32,   63. / 64,
                              61. / 64,   59. / 64,   57. / 64,   55. / 64,  127. / 128, 125. / 128,
                              123. / 128, 121. / 128, 119. / 128, 117. / 128};

/// The median of one run, as the spread has it; counted from row 2 d on.
double median_of(Run const& run, size_t measure, std::vector<Index> const& checkpoints, Index from) {
    std::vector<std::optional<double>> all;
    for (size_t c = 0; c < run.digits.size(); ++c)
        if (checkpoints[c] >= from) all.push_back(run.digits[c].*Digits::all()[measure]);
    return all.empty() ? std::nan("") : spread_of(all).median;
}

}  // namespace

Records drawn(Records records, size_t draw) {
    double const factor = factors[draw % std::size(factors)];
    records.psi *= factor, records.y *= factor;
    return records;
}

size_t most_draws(Index rows, CompareOptions const& options) {
    if (!options.composition.empty()) return 1;
    constexpr Index together = Index(1) << 17;
    return size_t(std::clamp<Index>(together / std::max<Index>(rows, 1), 1, Index(std::size(factors))));
}

bool is_contender(Result const& r, std::vector<Result const*> const& sound) {
    return takes_single_rows(r) && is_sound(r) && loss_of(r, sound).digits <= hopeless;
}

bool settled(std::vector<Result const*> const& results, std::vector<Runs const*> const& runs,
             std::vector<Index> const& checkpoints, std::string const& named, std::string const& before) {
    if (named.empty() || named == before) return true;
    auto const place = [&](auto const& is_it) {
        return size_t(std::ranges::find_if(results, is_it) - results.begin());
    };
    size_t const of_named = place([&](Result const* r) { return r->entry->variant == named; });
    std::vector<Run> const& own = runs[of_named]->own;
    if (own.size() < 2) return false;
    Index const from = std::min(checkpoints.back(), 2 * Index(own.front().theta.size()));
    for (size_t m = 0; m < 3; ++m) {
        size_t best = of_named;
        auto const mid = [&](size_t i) { return ((*results[i]->spread).*PerMeasure<Spread>::all()[m]).median; };
        for (size_t i = 0; i < results.size(); ++i)
            if (takes_single_rows(*results[i]) && is_sound(*results[i]) && runs[i]->own.size() == own.size() &&
                mid(i) > mid(best))
                best = i;
        double mean = 0, squares = 0;
        size_t const n = own.size();
        std::vector<double> lacks;
        for (size_t k = 0; k < n; ++k) {
            double const a = median_of(runs[best]->own[k], m, checkpoints, from),
                         b = median_of(own[k], m, checkpoints, from);
            lacks.push_back(a == b ? 0 : a - b);
            mean += lacks.back() / double(n);
        }
        for (double const x : lacks) squares += (x - mean) * (x - mean);
        if (!(mean + 2 * std::sqrt(squares / double(n * (n - 1))) <= within)) return false;
    }
    return true;
}

}  // namespace rlslab::compare
