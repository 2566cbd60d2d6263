// One colour a family of variants; mark and dash by the place in it.
#include "src/lab/report/figure.hpp"

#include <array>

namespace rlslab::report {
namespace {

constexpr std::array marks{"circle", "square", "diamond", "triangle-up", "triangle-down", "star", "cross", "x"};

Look look(char const* colour, size_t mark, bool hollow) {
    return {colour, hollow, std::string(marks[mark % marks.size()]) + (hollow ? "-open" : "")};
}

struct FamilyLook {
    char const* colour;
    size_t mark;
};
/// In the order of Family::Kind.
constexpr FamilyLook families[] = {{"#000000", 0},   // conventional
                                   {"#0072b2", 1},   // symmetric
                                   {"#d55e00", 2},   // joseph
                                   {"#b8860b", 3},   // root
                                   {"#009e73", 5},   // ud
                                   {"#cc79a7", 7},   // normal_equations
                                   {"#56b4e9", 4},   // qr
                                   {"#6a3d9a", 6},   // wide_qr
                                   {"#7f7f7f", 1}};  // other
static_assert(std::size(families) == size_t(Family::other) + 1);

}  // namespace

Look look_of(std::optional<Family> const& family, size_t place) {
    if (family) {
        auto const [colour, mark] = families[family->kind];
        size_t const pair = size_t(family->place) / 2;  // a third and a fourth member have the next mark but two
        return look(colour, mark + 3 * pair, family->place % 2 == 1);
    }
    constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                 "#b8860b", "#56b4e9", "#000000", "#6a3d9a"};
    return look(colours[place % colours.size()], place, place / colours.size() % 2 == 1);
}

}  // namespace rlslab::report
