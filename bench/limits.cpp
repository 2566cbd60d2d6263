// The limits by name, and the bootstrap.
#include "bench/limits.hpp"
#include "bench/shapes.hpp"

#include <rlslab/core/random.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <numeric>
#include <optional>

namespace rlslab::bench {
namespace {

using Names = std::vector<std::string>;
using NamesAt = std::function<Names(int size)>;

double median(std::vector<double> x) {
    std::ranges::sort(x);
    size_t const half = x.size() / 2;
    return x.size() % 2 ? x[half] : (x[half - 1] + x[half]) / 2;
}
double sum_of_medians(std::vector<std::vector<double>> const& rows) {
    return std::transform_reduce(rows.begin(), rows.end(), 0.0, std::plus(), median);
}
std::vector<std::vector<double>> drawn_again(std::vector<std::vector<double>> rows, Seed& seed) {
    for (std::vector<double>& row : rows) {
        std::vector<double> const all = row;
        for (double& x : row) x = all[seed.next() % all.size()];
    }
    return rows;
}

// --- the rows, by size -----------------------------------------------------------------------------------------------

NamesAt row(std::string const& group, std::string const& name, std::string const& arithmetic = "double") {
    return [=](int size) { return Names{fmt::format("{}/{}/{}/{}", group, name, arithmetic, size)}; };
}
/// One read and one read-modify-write pass over size^2 doubles.
Names two_passes(int size) {
    int const bytes = size * size * 8;
    return {fmt::format("limit/read/{}", bytes), fmt::format("limit/read_modify_write/{}", bytes)};
}
NamesAt batch(std::string const& name) {
    return [=](int size) { return Names{name + "/" + shape(batch_rows(size), size)}; };
}

struct Line {
    std::string what;
    NamesAt rows, over;
    std::vector<int> sizes;
    std::vector<double> limits;  // one for all sizes, or one for each
    bool least = false;
    NamesAt or_over = nullptr;  // another row to compare with: the faster one counts
};

std::vector<Line> lines() {
    NamesAt const dlib = row("peer", "dlib"), conventional = row("update", "conventional"),
                  qr_block = batch("batch/qr_block");
    std::vector<int> const sizes{8, 16, 24, 32, 64, 128}, from_16{16, 24, 32, 64, 128};
    std::vector<int> const& columns = batch_sizes;
    std::vector<Line> out{{"`conventional` / dlib", conventional, dlib, sizes, {.2, .2, .2, .2, .22, .24}},
                          {"`symmetric` / dlib", row("update", "symmetric"), dlib, sizes, {.25}},
                          {"`ud` / dlib", row("update", "ud"), dlib, sizes, {.25}}};
    for (char const* name : {"potter", "carlson", "inverse_qr", "gentleman"})
        out.push_back({fmt::format("`{}` / dlib", name), row("update", name), dlib, from_16, {.33}});
    for (char const* name : {"qr", "extended_qr"})
        out.push_back({fmt::format("`{}` / dlib", name), row("update", name), dlib, from_16, {.45}});
    out.push_back({"`conventional` / the two passes", conventional, two_passes, {64, 128}, {1.3, 1.2}});
    for (char const* name : {"conventional", "symmetric", "potter", "carlson", "inverse_qr", "ud", "qr", "gentleman"})
        out.push_back({fmt::format("`{}` in `float` / in `double`", name),
                       row("update", name, "float"),
                       row("update", name),
                       {64, 128},
                       {.6}});
    // OpenBLAS with AVX-512 is faster than with AVX2, for which these limits are 0.3.
    out.push_back({"`qr_block` / GSL's TSQR", qr_block, batch("peer/gsl_tsqr"), columns, {.5}});
    out.push_back({"`qr_block` / LAPACK's dgels", qr_block, batch("peer/lapack_dgels"), columns, {.5}});
    out.push_back(
        {"`qr_block` / Eigen's Householder QR", qr_block, batch("peer/eigen_householder"), {10, 20, 40}, {.6, .5, .5}});
    out.push_back({"`qr_block` / the normal equations",
                   qr_block,
                   batch("peer/normal_equations"),
                   columns,
                   {1.7, 1.7, 1.7, 2.4, 2.4},
                   false,
                   batch("peer/normal_equations_openblas")});
    out.push_back({"`fold_all`, one thread / two",
                   batch("fold_all/1_thread"),
                   batch("fold_all/2_threads"),
                   columns,
                   {1.8},
                   true});
    for (char const* name : {"conventional", "symmetric", "potter", "ud", "inverse_qr"})
        out.push_back({fmt::format("`{}` under a guard / alone", name),
                       row("guard", name),
                       row("update", name),
                       {32, 64, 128},
                       {1.1}});
    out.push_back({"`qr` under a guard / alone", row("guard", "qr"), row("update", "qr"), {16, 32, 64, 128}, {1.15}});
    for (char const* name : {"conventional", "symmetric", "ud", "qr", "gentleman"})
        out.push_back({fmt::format("`{}` over a window / alone", name),
                       row("window", name),
                       row("update", name),
                       {16, 32, 64, 128},
                       {2.2}});
    return out;
}

/// The repetitions of these rows; nothing if one of them is not in the run.
std::optional<std::vector<std::vector<double>>> found(Times const& times, Names const& names) {
    std::vector<std::vector<double>> out;
    for (std::string const& name : names) {
        auto const at = times.find(name);
        if (at == times.end()) return std::nullopt;
        out.push_back(at->second);
    }
    return out;
}
std::optional<Interval> measured(Times const& times, Line const& line, int size) {
    auto const rows = found(times, line.rows(size));
    auto over = found(times, line.over(size));
    if (auto const other = line.or_over ? found(times, line.or_over(size)) : std::nullopt;
        over && other && sum_of_medians(*other) < sum_of_medians(*over))
        over = other;
    if (!rows || !over) return std::nullopt;
    return ratio_of(*rows, *over);
}

/// "0.2", or "0.2, at 128 0.26" for the sizes with another limit than the first.
std::string words(Line const& line) {
    std::string out = fmt::format("at {} {}", line.least ? "least" : "most", line.limits.front());
    for (size_t i = 1; i < line.limits.size(); ++i)
        if (line.limits[i] != line.limits.front()) out += fmt::format(", at {} {}", line.sizes[i], line.limits[i]);
    return out;
}

}  // namespace

Interval ratio_of(std::vector<std::vector<double>> const& rows, std::vector<std::vector<double>> const& over) {
    constexpr int draws = 4000, outside = draws / 40;  // on each side
    Seed seed{1};
    std::vector<double> ratios(draws);
    for (double& ratio : ratios) {
        double const above = sum_of_medians(drawn_again(rows, seed));
        ratio = above / sum_of_medians(drawn_again(over, seed));
    }
    std::ranges::sort(ratios);
    return {sum_of_medians(rows) / sum_of_medians(over), ratios[outside], ratios[draws - 1 - outside]};
}

Verdict verdict(Interval const& interval, Limit const& limit) {
    bool const low = limit.least ? interval.low < limit.value : interval.low <= limit.value;
    bool const high = limit.least ? interval.high < limit.value : interval.high <= limit.value;
    bool const all_good = limit.least ? !low : high, all_bad = limit.least ? high : !low;
    return all_good ? Verdict::held : all_bad ? Verdict::missed : Verdict::open;
}

std::string table_of_limits(Times const& times) {
    std::string out = "| ratio of times, and its limit | measured | |\n|---|---|---|\n";
    for (Line const& line : lines()) {
        std::string cells, by_verdict[3];
        for (size_t i = 0; i < line.sizes.size(); ++i) {
            std::optional<Interval> const ratio = measured(times, line, line.sizes[i]);
            if (!ratio) continue;
            double const limit = line.limits[line.limits.size() == 1 ? 0 : i];
            cells += fmt::format("{}{}: {:.2f} [{:.2f}, {:.2f}]", cells.empty() ? "" : ", ", line.sizes[i],
                                 ratio->middle, ratio->low, ratio->high);
            std::string& where = by_verdict[int(verdict(*ratio, {limit, line.least}))];
            where += fmt::format("{}{}", where.empty() ? "" : ", ", line.sizes[i]);
        }
        if (cells.empty()) continue;
        std::string verdicts;
        for (auto const& [name, which] : {std::pair("held", 0), std::pair("open", 1), std::pair("**missed**", 2)})
            if (!by_verdict[which].empty())
                verdicts += fmt::format("{}{} {}", verdicts.empty() ? "" : "; ", name, by_verdict[which]);
        out += fmt::format("| {}: {} | {} | {} |\n", line.what, words(line), cells, verdicts);
    }
    return out;
}

}  // namespace rlslab::bench
