// rlslab list: the names of variants, arithmetics and studies.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/program/bibliography.hpp"
#include "src/lab/program/commands.hpp"
#include "src/lab/program/definitions.hpp"
#include "src/lab/report/json.hpp"
#include <rlslab/studies/factors.hpp>
#include <rlslab/studies/verdicts.hpp>

#include <rlslab/core/rounding.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace rlslab::program {
using namespace report;
using namespace studies;
namespace {

std::string small(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

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
        out["variants"].push_back(object("name propagates starts_without_prior rows_at_once arithmetics",
                                         {v->variant, v->propagates, v->starts_without_prior, v->block, in}));
    }
    return text;
}

std::string arithmetics_text(Json& out) {
    std::string text = "arithmetics               bits  digits  exponents                    rounding\n";
    for (Arithmetic const& s : arithmetics()) {
        char const* const rounding = s.stochastic ? "stochastic" : "nearest";
        text += fmt::format("  {:<23} {:>4}  {:>6.1f}  {:<27}  {}\n", s.name, s.digits, s.decimal_digits(),
                            fmt::format("{} ... {}", s.min_exp, s.max_exp), rounding);
        out["arithmetics"].push_back(
            object("name digits min_exp max_exp rounding", {s.name, s.digits, s.min_exp, s.max_exp, rounding}));
    }
    text +=
        "  and pN, N bits with double's exponents, as p11; pN:EMIN:EMAX with a range, as\n"
        "  p8:-126:127; and with :stochastic or :toward_zero after it\n";
    return text;
}

std::string rounding_text(Json& out) {
    auto const faults = rounding_faults();
    out["rounding_faults"] = faults;
    return "rounding of this program\n  " + (faults.empty()
                                                 ? "as defined: once an operation, to nearest, subnormal numbers kept\n"
                                                 : fmt::format("{}\n", fmt::join(faults, "\n  and  ")));
}

/// Everything that a study says of itself and its sources, in small letters.
std::string said_of(Study const& study) {
    std::string out = fmt::format("{} {} {} {} {} {}", study.name, subject_of(study), study.question, study.source,
                                  study.data, study.interpretation);
    for (Claim const& claim : study.claims)
        out += fmt::format(" {} {} {}", claim.text, claim.basis.band, claim.basis.data);
    for (Source const* source : sources_of(study.name)) out += ' ' + source->bibtex;
    return small(out);
}
bool is_about(Study const& study, std::vector<std::string> const& words) {
    if (words.empty()) return true;
    std::string const said = said_of(study);
    return std::ranges::all_of(words, [&](std::string const& word) { return said.find(small(word)) != said.npos; });
}

std::string studies_text(Json& out, std::vector<std::string> const& words) {
    std::string text = "studies\n";
    out["studies"] = Json::array();
    for (Study const* study : studies::studies()) {
        if (!is_about(*study, words)) continue;
        text += fmt::format("  {:<23} {}\n", study->name, wrapped(study->question, 26, 26, help_width));
        out["studies"].push_back(object("name question subject", {study->name, study->question, subject_of(*study)}));
    }
    if (out["studies"].empty())
        refuse(
            "list studies: none has \"{}\" in its text; expected a paper (Bierman 1977) or a "
            "subject (gain, forgetting)",
            printable(fmt::format("{}", fmt::join(words, " "))));
    return text;
}

/// A claim a line, its parts apart by tabs: what a hash of the whole list is taken of before a run.
std::string claims_text(Json& out) {
    std::string text;
    out["claims"] = Json::array();
    for (Study const* study : studies::studies())
        for (size_t i = 0; i < study->claims.size(); ++i) {
            Claim const& claim = study->claims[i];
            std::string const& data = data_of(*study, claim);
            text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}\n", study->name, i + 1, name_of(claim.basis.kind),
                                claim.text, claim.basis.band, data, claim.basis.proof);
            out["claims"].push_back(object("study number kind claim band data proof",
                                           {study->name, i + 1, name_of(claim.basis.kind), claim.text, claim.basis.band,
                                            data, claim.basis.proof}));
        }
    return text;
}

/// All parts but the claims, or the one that is named; of the studies those that are about all the words.
void run_list(std::string const& part, std::vector<std::string> const& words, bool json) {
    std::pair<std::string_view, std::function<std::string(Json&)>> const parts[] = {
        {"variants", variants_text},
        {"arithmetics", arithmetics_text},
        {"rounding", rounding_text},
        {"studies", [&](Json& out) { return studies_text(out, words); }},
        {"claims", claims_text}};
    std::vector<std::string_view> names;
    for (auto const& [name, text] : parts) names.push_back(name);
    if (!part.empty()) expect_one_of(names, part, "list", "part");
    if (!words.empty() && part != "studies")
        refuse("\"{}\" is one word too many ({} list --help)", printable(words.front()), program_name());
    Json out;
    std::string text;
    for (auto const& [name, text_of] : parts)
        if (part.empty() ? name != "claims" : part == name) text += (text.empty() ? "" : "\n") + text_of(out);
    out["run"] = Json::parse(as_json(this_run(false)));
    print(json ? out.dump(2) + '\n' : text);
}

}  // namespace

Command list_command(CLI::App& app) {
    auto const json = std::make_shared<bool>(false);
    auto const part = std::make_shared<std::string>();
    auto const words = std::make_shared<std::vector<std::string>>();
    CLI::App* const listing = app.add_subcommand("list", "What there is: variants, arithmetics, studies.");
    listing->footer(fmt::format(
        "Example:          {0} list variants --json\n"
        "By paper:         {0} list studies Bierman 1977\n"
        "By subject:       {0} list studies forgetting\n"
        "A hash of bands:  {0} list claims | sha256sum\n\n"
        "Studies are found by their text: name, subject, question, source, data, result and claims. All words have to "
        "be there.\n\n"
        "Exit code: 0; 2 no study has these words.",
        program_name()));
    define(*listing,
           {{"PART", *part, "", "variants, arithmetics, rounding, studies or claims; default: all but claims"},
            {"WORD", *words, "", "behind studies: those about all these words, such as an author and a year"},
            {"--json", *json, "JSON instead of the tables"}});
    return {listing, [part, words, json] {
                run_list(*part, *words, *json);
                return 0;
            }};
}

}  // namespace rlslab::program
