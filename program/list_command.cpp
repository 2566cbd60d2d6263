// rlslab list: the names of variants, arithmetics and studies.
#include "catalogue/catalogue.hpp"
#include "program/commands.hpp"
#include "program/described.hpp"
#include "studies/engine/study.hpp"

#include <rlslab/core/rounding.hpp>
#include <rlslab/core/text.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

void run_list(bool json) {
    nlohmann::ordered_json out = {{"variants", nlohmann::ordered_json::array()},
                                  {"arithmetics", nlohmann::ordered_json::array()},
                                  {"studies", nlohmann::ordered_json::array()}};
    std::string text = "variants                  propagates   a prior   rows at once  in\n";
    for (Entry const* const v : one_entry_each()) {
        std::vector<std::string_view> in;
        for (Entry const& e : catalogue())
            if (e.variant == v->variant) in.push_back(e.arithmetic->name);
        text += fmt::format("  {:<23} {:<12} {:<9} {:<13} {}\n", v->variant, v->propagates, v->starts_without_prior ? "optional" : "needed",
                            v->block, in.size() == arithmetics().size() ? "every arithmetic" : fmt::format("{}", fmt::join(in, ", ")));
        out["variants"].push_back({{"name", v->variant},
                                   {"propagates", v->propagates},
                                   {"starts_without_prior", v->starts_without_prior},
                                   {"rows_at_once", v->block},
                                   {"arithmetics", in}});
    }
    text += "\narithmetics               bits  digits  exponents                    rounding\n";
    for (Arithmetic const& s : arithmetics()) {
        char const* const rounding = s.stochastic ? "stochastic" : "nearest";
        text += fmt::format("  {:<23} {:>4}  {:>6.1f}  {:<27}  {}\n", s.name, s.digits, s.decimal_digits(),
                            fmt::format("{} ... {}", s.min_exp, s.max_exp), rounding);
        out["arithmetics"].push_back(
            {{"name", s.name}, {"digits", s.digits}, {"min_exp", s.min_exp}, {"max_exp", s.max_exp}, {"rounding", rounding}});
    }
    auto const faults = rounding_faults();
    out["rounding_faults"] = faults;
    text += "\nrounding of this program\n  " + (faults.empty() ? "as defined: once an operation, to nearest, subnormal numbers kept\n"
                                                               : fmt::format("{}\n", fmt::join(faults, "\n  and  ")));
    text += "\nstudies\n";
    for (Study const* study : studies()) {
        text += fmt::format("  {:<23} {}\n", study->name, wrapped(study->question, 26, 26, help_width));
        out["studies"].push_back({{"name", study->name}, {"question", study->question}});
    }
    print(json ? out.dump(2) + '\n' : text);
}

}  // namespace

Command list_command(CLI::App& app) {
    auto const json = std::make_shared<bool>(false);
    CLI::App* const listing = app.add_subcommand("list", "What there is: variants, arithmetics, studies.");
    listing->footer("Example:  rlslab list --json\n\nExit code: 0.");
    listing->add_flag("--json", *json, "JSON instead of the tables");
    return {listing, [json] {
                run_list(*json);
                return 0;
            }};
}

}  // namespace rlslab
