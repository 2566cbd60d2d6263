// rlslab state: what a saved filter's file says of itself.
#include "src/lab/program/commands.hpp"

#include <rlslab/state/state_file.hpp>

namespace rlslab::program {
using namespace report;

Command state_command(CLI::App& app) {
    auto const file = std::make_shared<std::string>();
    CLI::App* const c = app.add_subcommand("state", "What is in the file of a saved filter.");
    c->footer(
        "Example:  rlslab state controller.state\n\n"
        "Prints the variant, its arithmetic and number of parameters, what is around it (a guard, a window, a rule of "
        "forgetting), and "
        "their editions, options and counts of rows. C++ reads and writes such files with "
        "<rlslab/state/state_file.hpp>.\n\n"
        "Exit code: 0 a state; 2 a file that cannot be read, is no state, or is damaged.");
    c->add_option("FILE", *file, "a state that was saved")->required()->type_name("");
    return {c, [file] {
                std::vector<std::byte> const bytes = detail::bytes_of(*file);
                try {
                    print(described_state(bytes));
                } catch (InputError const& error) {
                    detail::refuse_state(*file, error.what());
                }
                return 0;
            }};
}

}  // namespace rlslab::program
