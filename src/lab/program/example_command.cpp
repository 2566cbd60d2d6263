// rlslab example: the records that the program has in it.
#include "src/lab/program/definitions.hpp"
#include "src/lab/program/examples.hpp"

#include <rlslab/input/text.hpp>

#include <fmt/format.h>

namespace rlslab::program {

Command example_command(CLI::App& app) {
    auto const name = std::make_shared<std::string>();
    CLI::App* const c = app.add_subcommand("example", "Records to try this on, as CSV; without a name their list.");
    c->footer(
        "As a file:      rlslab example sales > sales.csv\n"
        "Without one:    rlslab compare --example longley\n\n"
        "compare and sweep take --example NAME in place of FILE, --output and a model.\n\n"
        "Exit code: 0; 2 a name that is no example.");
    c->add_option("NAME", *name, "the example to print")->type_name("");
    return {c, [name] {
                std::string text;
                if (!name->empty()) text = example_named(*name, "example").text;
                else
                    for (Example const& e : examples())
                        text += fmt::format("{:<12} {}\n", e.name,
                                            wrapped(fmt::format("{} ({})", e.what, e.source), 13, 13, help_width));
                print(text);
                return 0;
            }};
}

}  // namespace rlslab::program
