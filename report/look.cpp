// One colour a family of variants, hollow and dashed for its second member.
#include "report/figure.hpp"

#include <array>

namespace rlslab::report {
namespace {

struct Named {
    std::string_view name;
    Look look;
};
std::vector<Named> const& variants() {
    static std::vector<Named> const looks{{"conventional", {"#000000", false, "circle"}},
                                          {"conventional_two_sided", {"#000000", true, "circle-open"}},
                                          {"symmetric", {"#0072b2", false, "square"}},
                                          {"kalman", {"#0072b2", true, "square-open"}},
                                          {"joseph", {"#d55e00", false, "diamond"}},
                                          {"joseph_rank_two", {"#d55e00", true, "diamond-open"}},
                                          {"potter", {"#b8860b", false, "triangle-up"}},
                                          {"carlson", {"#b8860b", true, "triangle-up-open"}},
                                          {"ud", {"#009e73", false, "star"}},
                                          {"inverse_qr", {"#009e73", true, "star-open"}},
                                          {"information", {"#cc79a7", false, "x"}},
                                          {"cholesky_sparse", {"#cc79a7", true, "x-open"}},
                                          {"qr", {"#56b4e9", false, "triangle-down"}},
                                          {"gentleman", {"#56b4e9", true, "triangle-down-open"}},
                                          {"extended_qr", {"#6a3d9a", true, "cross-open"}},
                                          {"qr_block", {"#6a3d9a", false, "cross"}},
                                          {"qr_sparse", {"#7f7f7f", true, "square-open"}},
                                          {"order_recursive", {"#7f7f7f", false, "square"}}};
    return looks;
}

}  // namespace

Look look_of(std::string_view series, size_t place) {
    for (Named const& named : variants())
        if (named.name == series) return named.look;
    constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#000000", "#6a3d9a"};
    constexpr std::array marks{"circle", "square", "diamond", "triangle-up", "triangle-down", "star", "cross", "x"};
    bool const again = place / colours.size() % 2 == 1;
    return {colours[place % colours.size()], again, std::string(marks[place % marks.size()]) + (again ? "-open" : "")};
}

}  // namespace rlslab::report
