// Rules of forgetting, windows and guards by name: which there are, and which variant they go around.
#include <rlslab/catalogue/composition.hpp>
#include <rlslab/catalogue/compose.hpp>

#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace rlslab {

std::vector<Control> const& controls() {
    constexpr double given = std::numeric_limits<double>::quiet_NaN(), any = std::numeric_limits<double>::max();
    static std::vector<Control> const all{
        {"constant", "lambda of --forgetting at every row, as without a control", {}},
        {"fortescue",
         "lambda chosen at every row so that the sum of squares stays at VARIANCE times MEMORY rows, and not below LEAST; "
         "VARIANCE is the noise's, of the residuals where it is not given",
         {{"VARIANCE", given, 0, any, true}, {"MEMORY", 100, 1, any, false}, {"LEAST", 0.5, 0, 1, true}}},
        {"kulhavy",
         "forgets along the gain alone, after the row; rows of |psi|^2 < EXCITATION forget nothing",
         {{"LAMBDA", 0.98, 0, 1, true}, {"EXCITATION", 0, 0, any, false}}},
        {"cao_schwartz",
         "forgets along the regressor alone, before the row; rows of |psi|^2 < EXCITATION forget nothing",
         {{"LAMBDA", 0.98, 0, 1, true}, {"EXCITATION", 0, 0, any, false}}},
        {"ridge", "information that --forgetting below 1 does not wear down: P^-1 >= about RIDGE I", {{"RIDGE", 0.001, 0, any, true}}},
        {"reset",
         "P = VARIANCE I every PERIOD rows; VARIANCE is the largest of P0 where it is not given",
         {{"PERIOD", 1000, 1, 1e7, false}, {"VARIANCE", given, 0, any, true}}},
        {"random_walk",
         "theta walks at random: Q = VARIANCE I a row on average, in units of the noise's; a coordinate a row by turns (kalman: all of Q)",
         {{"VARIANCE", given, 0, any, false}}},
    };
    return all;
}

std::vector<std::string_view> const& guard_names() {
    static std::vector<std::string_view> const all{"report", "reset", "rebuild", "hand_over"};
    return all;
}

std::vector<std::string_view> const& composed_arithmetics() {
    static std::vector<std::string_view> const all{"float", "double"};
    return all;
}

std::string contradiction(Composition const& c) {
    if (c.window > 0 && !c.keeps_the_problem()) return "a window takes rows back, whose weight a rule has changed";
    if (c.guard == "hand_over" && c.window > 0) return "a window cannot take back rows from the filter that goes on";
    if (c.guard == "hand_over" && !c.keeps_the_problem()) return "a rule of forgetting does not go along to the filter that goes on";
    return "";
}

std::string obstacle(Composition const& c, std::string_view variant) {
    VariantAbilities const can = abilities_of(variant);
    Abilities const& a = can.abilities;
    bool const ruled = !c.keeps_the_problem();
    if (!ruled && c.window == 0 && c.guard.empty()) return can.single_rows ? "" : "takes rows in blocks, or is another library's";
    if (can.walks && c.control == "random_walk" && c.guard.empty()) return "";
    if (!a.form) return "shows no state that could be discounted, reset or relieved of a row";
    if (c.window > 0 && !a.downdates) return "takes no row back";
    if (c.guard == "hand_over" && !can.relays) return "does not tell how near to singular its P is";
    if ((c.control == "kulhavy" || c.control == "cao_schwartz" || c.control == "random_walk") && !a.inflates)
        return "takes no P + c a a': its square root of P is no triangle";
    if (c.control == "cao_schwartz" && !a.information) return "has psi'P^-1 psi not at hand: it stores P, or no triangle";
    if (!c.guard.empty() && !a.guardable) return "cannot be restarted by a guard";
    return "";
}

Composition completed(Composition composition, Problem<double> const& problem, double noise_variance) {
    bool const fortescue = composition.control == "fortescue";
    for (double& x : composition.parameters) {
        if (std::isnan(x))
            x = fortescue                   ? noise_variance
                : problem.prior->covariance ? problem.prior->covariance->diagonal().maxCoeff()
                                            : problem.prior->variance;
        if (!std::isfinite(x) || (fortescue && !(x > 0)))
            throw InputError(
                fmt::format("--control {}: expected its number: none follows from a record that the model fits exactly, or of "
                            "whose residuals double cannot hold the squares",
                            composition.control));
    }
    return composition;
}

std::vector<std::string> warnings_of(Composition const& c, Index rows, Index parameters) {
    std::vector<std::string> out;
    if (c.window >= std::max<Index>(rows, 1))
        out.push_back(fmt::format("the window of {} rows is as long as the record, or longer: no row leaves it", c.window));
    if (c.control == "reset" && c.parameters[0] > double(rows))
        out.emplace_back("the control resets P after the record's end: it did nothing");
    if (c.window > 0 && c.window < parameters)
        out.push_back(fmt::format("the window of {} does not determine {} parameters: the prior does",
                                  c.window == 1 ? "1 row" : fmt::format("{} rows", c.window), parameters));
    return out;
}

}  // namespace rlslab
