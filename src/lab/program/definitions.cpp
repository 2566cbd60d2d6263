// The definitions are read from CLI11's structures. The exit codes and the environment, which CLI11 does not know, are
// written here.
#include "src/lab/program/definitions.hpp"

#include "src/lab/program/commands.hpp"

#include <fmt/format.h>

namespace rlslab::program {

std::string CommandOption::spelling() const {
    std::string const bare = name.empty() ? value + (many ? "..." : "") : "";
    if (name.empty()) return required ? bare : '[' + bare + ']';
    return (shorter.empty() ? "" : shorter + ", ") + name + (value.empty() ? "" : ' ' + value);
}

bool takes_nothing(CLI::Option const& option) { return option.get_items_expected_max() == 0; }

std::vector<CommandOption> options_of(CLI::App const& command) {
    std::vector<CommandOption> out, options;
    for (CLI::Option const* option : command.get_options()) {
        if (option->get_group().empty()) continue;
        bool const bare = option->get_positional();
        CommandOption one{.name = bare || option->get_lnames().empty() ? "" : "--" + option->get_lnames().front(),
                          .shorter = bare || option->get_snames().empty() ? "" : "-" + option->get_snames().front(),
                          .value = bare                     ? option->get_name(true)
                                   : takes_nothing(*option) ? ""
                                                            : option->get_type_name(),
                          .text = option->get_description(),
                          .group = option->get_group(),
                          .required = option->get_required(),
                          .many = bare && option->get_items_expected_max() > 1};
        (bare ? out : options).push_back(std::move(one));
    }
    out.insert(out.end(), options.begin(), options.end());
    return out;
}

std::vector<CLI::App const*> shown_commands(CLI::App const& app) {
    return app.get_subcommands([](CLI::App const* command) { return !command->get_group().empty(); });
}

std::string usage(CLI::App const& command) {
    std::string needed, instead;
    for (CommandOption const& one : options_of(command)) {
        if (one.name.empty() || one.required) needed += ' ' + one.spelling();
        if (one.name == "--example") instead = one.spelling();
    }
    if (!instead.empty()) needed = fmt::format(" ({} | {})", needed.substr(1), instead);
    return program_name() + ' ' + (command.get_parent() ? command.get_name() : "COMMAND") + needed + " [OPTION...]";
}

std::vector<Meaning> const& exit_codes() {
    static std::vector<Meaning> const list{
        {"0", "Answered."},
        {"1", fmt::format("Answered, and the answer is no: {}.", this_program.answer_is_no)},
        {"2",
         "Not answered: words or data that make no sense, a file that cannot be read or written. One line on standard "
         "error says what was expected."},
        {"130", "Stopped by Ctrl-C. A study goes on from there when the same command is run again."},
        {"141", fmt::format("Whoever read the answer has closed the pipe ({} list | head -1). Nothing is said.",
                            program_name())},
    };
    return list;
}

std::vector<Meaning> const& environment() {
    static std::vector<Meaning> const list{
        {"NO_COLOR", "If set and not empty, answers on a terminal are not coloured. --color goes before it."},
        {"TERM", "A terminal called dumb gets no colours."},
    };
    return list;
}

}  // namespace rlslab::program
