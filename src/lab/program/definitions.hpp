// The command line's definitions as data: help, manual page and the shells' completions are written from them.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace rlslab::program {

/// An option, or with an empty `name` an argument without one.
struct CommandOption {
    std::string name;     ///< "--variants"
    std::string shorter;  ///< "-h", or empty
    std::string value;    ///< "A,B", "auto|always|never", "FILE"; empty for a flag
    std::string text, group;
    bool required, many;  ///< many: may stand on the line several times
    /// "--variants A,B", "-h, --help", "FILE", "[NAME...]".
    std::string spelling() const;
};

/// A flag.
bool takes_nothing(CLI::Option const& option);
/// Arguments without a name first, then the options in the order of their definition. Hidden ones are left out.
std::vector<CommandOption> options_of(CLI::App const& command);
/// Those that are not hidden, in the order of their definition.
std::vector<CLI::App const*> shown_commands(CLI::App const& app);
/// "rlslab compare FILE --output COLUMN [OPTION...]"
std::string usage(CLI::App const& command);

/// The exit codes and the environment, each with what it means.
struct Meaning {
    std::string name, text;
};
std::vector<Meaning> const& exit_codes();
std::vector<Meaning> const& environment();

/// Of --help and `rlslab list`: the letters in a line.
inline constexpr size_t help_width = 79;
std::string help_text(CLI::App const& command);
/// The lines as they were written, but one that is too long is broken at its first gap ("Example:  rlslab ...").
std::string notes(std::string const& text, size_t width);
/// man rlslab, in roff.
std::string manual_page(CLI::App const& app);
/// The scripts by which bash and zsh complete commands, options, names of variants, arithmetics, studies and columns.
std::string bash_completion(CLI::App const& app);
std::string zsh_completion(CLI::App const& app);

}  // namespace rlslab::program
