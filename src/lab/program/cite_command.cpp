// rlslab cite: BibTeX of the program and of the sources of variants.
#include "src/lab/program/bibliography.hpp"
#include "src/lab/program/commands.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/input/suggestion.hpp>

#include <algorithm>

namespace rlslab::program {
using namespace report;
namespace {

int run_cite(std::vector<std::string> const& variants) {
    std::vector<std::string_view> known;
    for (CatalogueEntry const* const v : one_entry_each()) known.push_back(v->variant);
    std::string out = bibtex_of_program();
    std::vector<Source const*> said;  // a source of two variants stands once
    for (std::string const& variant : variants) {
        expect_one_of(known, variant, "cite", "variant");
        for (Source const* source : sources_of(variant))
            if (std::ranges::find(said, source) == said.end()) said.push_back(source);
    }
    for (Source const* source : said) out += '\n' + source->bibtex;
    print(out);
    return 0;
}

}  // namespace

Command cite_command(CLI::App& app) {
    auto const variants = std::make_shared<std::vector<std::string>>();
    CLI::App* const c = app.add_subcommand("cite", "BibTeX of this program, and of the sources of variants.");
    c->footer(
        "Example:  rlslab cite ud joseph >> paper.bib\n\n"
        "The program is cited with its version and revision. A DOI stands only where one was found beside the title in "
        "a second place.\n\n"
        "Exit code: 0; 2 a name that is no variant.");
    c->add_option("VARIANT", *variants, "names of variants, as rlslab list shows them")->type_name("");
    return {c, [variants] { return run_cite(*variants); }};
}

}  // namespace rlslab::program
