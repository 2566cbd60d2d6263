// rlslab list: the names of variants, arithmetics and studies.
#include <rlslab/catalogue/catalogue.hpp>
#include "program/commands.hpp"
#include "program/definitions.hpp"
#include "studies/engine/study.hpp"

#include <rlslab/core/rounding.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab::program {
using namespace report;
using namespace studies;
namespace {

using Json = nlohmann::ordered_json;

std::string variants_text(Json& out) {
    std::string text = "variants                  propagates   a prior   rows at once  in\n";
    for (CatalogueEntry const* const v : one_entry_each()) {
        std::vector<std::string_view> in;
        for (CatalogueEntry const& e : catalogue())
            if (e.variant == v->variant) in.push_back(e.arithmetic->name);
        text += fmt::format(
            "  {:<23} {:<12} {:<9} {:<13} {}\n", v->variant, v->propagates,
            v->starts_without_prior ? "optional" : "needed", v->block,
            in.size() == arithmetics().size() ? "every arithmetic" : fmt::format("{}", fmt::join(in, ", ")));
        out["variants"].push_back({{"name", v->variant},
                                   {"propagates", v->propagates},
                                   {"starts_without_prior", v->starts_without_prior},
                                   {"rows_at_once", v->block},
                                   {"arithmetics", in}});
    }
    return text;
}

std::string arithmetics_text(Json& out) {
    std::string text = "arithmetics               bits  digits  exponents                    rounding\n";
    for (Arithmetic const& s : arithmetics()) {
        char const* const rounding = s.stochastic ? "stochastic" : "nearest";
        text += fmt::format("  {:<23} {:>4}  {:>6.1f}  {:<27}  {}\n", s.name, s.digits, s.decimal_digits(),
                            fmt::format("{} ... {}", s.min_exp, s.max_exp), rounding);
        out["arithmetics"].push_back({{"name", s.name},
                                      {"digits", s.digits},
                                      {"min_exp", s.min_exp},
                                      {"max_exp", s.max_exp},
                                      {"rounding", rounding}});
    }
    return text;
}

std::string rounding_text(Json& out) {
    auto const faults = rounding_faults();
    out["rounding_faults"] = faults;
    return "rounding of this program\n  " + (faults.empty()
                                                 ? "as defined: once an operation, to nearest, subnormal numbers kept\n"
                                                 : fmt::format("{}\n", fmt::join(faults, "\n  and  ")));
}

std::string studies_text(Json& out) {
    std::string text = "studies\n";
    for (Study const* study : studies::studies()) {
        text += fmt::format("  {:<23} {}\n", study->name, wrapped(study->question, 26, 26, help_width));
        out["studies"].push_back({{"name", study->name}, {"question", study->question}});
    }
    return text;
}

/// All parts, or the one that is named.
void run_list(std::string const& part, bool json) {
    static constexpr std::pair<std::string_view, std::string (*)(Json&)> parts[] = {{"variants", variants_text},
                                                                                    {"arithmetics", arithmetics_text},
                                                                                    {"rounding", rounding_text},
                                                                                    {"studies", studies_text}};
    std::vector<std::string_view> names;
    for (auto const& [name, text] : parts) names.push_back(name);
    if (!part.empty()) expect_one_of(names, part, "list", "part");
    Json out;
    std::string text;
    for (auto const& [name, text_of] : parts)
        if (part.empty() || part == name) text += (text.empty() ? "" : "\n") + text_of(out);
    out["run"] = Json::parse(as_json(this_run(false)));
    print(json ? out.dump(2) + '\n' : text);
}

}  // namespace

Command list_command(CLI::App& app) {
    auto const json = std::make_shared<bool>(false);
    auto const part = std::make_shared<std::string>();
    CLI::App* const listing = app.add_subcommand("list", "What there is: variants, arithmetics, studies.");
    listing->footer("Example:  rlslab list variants --json\n\nExit code: 0.");
    listing->add_option("PART", *part, "variants, arithmetics, rounding or studies; default: all")->type_name("");
    listing->add_flag("--json", *json, "JSON instead of the tables");
    return {listing, [part, json] {
                run_list(*part, *json);
                return 0;
            }};
}

}  // namespace rlslab::program
