// rlslab help.
#include "src/lab/program/commands.hpp"
#include "src/lab/program/definitions.hpp"

#include <rlslab/input/suggestion.hpp>

namespace rlslab::program {
using namespace report;

Command help_command(CLI::App& app) {
    auto const name = std::make_shared<std::string>();
    CLI::App* const c = app.add_subcommand("help", "This help, or that of a command.");
    c->add_option("COMMAND", *name, "as in the list of commands")->type_name("");
    return {c, [name, &app] {
                std::vector<std::string_view> names;
                for (CLI::App const* command : shown_commands(app)) names.push_back(command->get_name());
                if (!name->empty()) expect_one_of(names, *name, "", "command");
                print(help_text(name->empty() ? app : *app.get_subcommand(*name)));
                return 0;
            }};
}

}  // namespace rlslab::program
