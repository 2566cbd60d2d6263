// Edit distance with swapped neighbours (optimal string alignment).
#include <rlslab/input/suggestion.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace rlslab {
namespace {

char lower(char c) { return 'A' <= c && c <= 'Z' ? char(c - 'A' + 'a') : c; }
bool same(char a, char b) { return lower(a) == lower(b); }

/// D_ij, the distance between the first i letters of a and the first j of b:
///   min(D_i-1,j + 1, D_i,j-1 + 1, D_i-1,j-1 + [a_i != b_j], and where the last two letters are swapped D_i-2,j-2 + 1).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> D(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                D[i][j] = i + j;
                continue;
            }
            D[i][j] = std::min({D[i - 1][j] + 1, D[i][j - 1] + 1, D[i - 1][j - 1] + !same(a[i - 1], b[j - 1])});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                D[i][j] = std::min(D[i][j], D[i - 2][j - 2] + 1);
        }
    return D[a.size()][b.size()];
}

}  // namespace

std::string_view nearest(std::string_view requested, std::vector<std::string_view> const& names) {
    constexpr std::size_t longest = 64;  // a longer word is no mistyped name
    if (requested.size() > longest) return {};
    std::size_t least = 1 + requested.size() / 3;
    std::string_view found;
    for (std::string_view const name : names) {
        if (name.size() > longest) continue;
        std::size_t const distance = edit_distance(requested, name);
        if (distance >= std::max(name.size(), requested.size()) || distance >= least) continue;
        least = distance;
        found = name;
    }
    if (!found.empty() || requested.size() < 2) return found;
    auto const begins = [&](std::string_view name) {
        return name.size() > requested.size() && std::ranges::equal(name.substr(0, requested.size()), requested, same);
    };
    auto const first = std::ranges::find_if(names, begins);
    return std::ranges::count_if(names, begins) == 1 ? *first : std::string_view();
}

std::string did_you_mean(std::string_view requested, std::vector<std::string_view> const& names) {
    std::string_view const name = nearest(requested, names);
    if (!name.empty()) return fmt::format(" (did you mean \"{}\"?)", printable(name));
    // "josef": those that begin most like it
    constexpr std::size_t at_least = 3, shown = 4;
    auto const common = [&](std::string_view other) {
        return std::size_t(std::ranges::mismatch(requested, other, same).in1 - requested.begin());
    };
    std::size_t longest = std::max(at_least, (requested.size() + 1) / 2);
    std::vector<std::string> like;
    for (std::string_view const other : names) {
        if (common(other) < longest) continue;
        if (common(other) > longest) like.clear();
        longest = common(other);
        like.push_back(fmt::format("\"{}\"", printable(other)));
    }
    if (like.empty()) return "";
    bool const more = like.size() > shown;
    like.resize(std::min(like.size(), shown));
    return fmt::format(" (did you mean {}{}?)", fmt::join(like, ", "), more ? " ..." : "");
}

void expect_one_of(std::vector<std::string_view> const& names, std::string_view requested, std::string_view where,
                   std::string_view what) {
    if (std::ranges::find(names, requested) != names.end()) return;
    std::string const meant = did_you_mean(requested, names);
    throw InputError(fmt::format("{}no {} \"{}\"{}", where.empty() ? "" : fmt::format("{}: ", where), what,
                                 printable(requested),
                                 meant.empty() ? fmt::format("; expected one of {}", fmt::join(names, ", ")) : meant));
}

}  // namespace rlslab
