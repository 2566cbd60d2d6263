// The definitions are read from CLI11's structures; exit codes and environment, which it does not know, stand here.
#include "src/lab/program/definitions.hpp"

#include "src/lab/program/commands.hpp"

#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <sstream>

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

// --- rlslab help: the definitions in lines of at most 79 letters -----------------------------------------------------

namespace {

constexpr size_t column = 24;  // where the text beside an option begins

/// "  --order N           ARX order", or the text a line below where the name is too long.
std::string entry(std::string const& name, std::string const& text, size_t beside = column) {
    std::string out = "  " + name;
    if (out.size() + 2 > beside) out += '\n' + std::string(beside, ' ');
    else out.resize(beside, ' ');
    return out + wrapped(text, beside, beside, help_width) + '\n';
}

}  // namespace

std::string notes(std::string const& text, size_t width) {
    std::istringstream in(text);
    std::string out;
    for (std::string line; std::getline(in, line);) {
        size_t const start = std::min(line.size(), line.find_first_not_of(' ')),
                     gap = std::min(line.size(), line.find("  ", start));
        size_t const rest = std::min(line.size(), line.find_first_not_of(' ', gap));
        if (line.size() <= width || rest == line.size()) out += wrapped(line, 0, start, width) + '\n';
        else
            out += wrapped(line.substr(0, gap), 0, start, width) + "\n    " + wrapped(line.substr(rest), 4, 8, width) +
                   '\n';
    }
    return out;
}

std::string help_text(CLI::App const& command) {
    bool const whole = command.get_parent() == nullptr;
    std::string out = wrapped(command.get_description(), 0, 0, help_width) + "\n\n" +
                      wrapped("Usage: " + usage(command), 0, 7, help_width) + "\n\n";
    std::vector<CommandOption> const all = options_of(command);
    std::vector<std::string> groups;
    for (CommandOption const& one : all) {
        if (one.name.empty()) out += entry(one.value, one.text);
        else if (std::ranges::find(groups, one.group) == groups.end()) groups.push_back(one.group);
    }
    if (!all.empty() && all.front().name.empty()) out += '\n';
    if (whole) {
        out += "Commands:\n";
        for (CLI::App const* one : shown_commands(command)) out += entry(one->get_name(), one->get_description(), 14);
        out += '\n';
    }
    std::ranges::stable_sort(groups, {}, [](std::string const& group) { return group == "With every command"; });
    for (std::string const& group : groups) {
        out += group + ":\n";
        for (CommandOption const& one : all)
            if (!one.name.empty() && one.group == group)
                out += entry(one.spelling(), one.text + (one.required ? " (required)" : ""));
        out += '\n';
    }
    if (whole) {
        out += "Exit codes:\n";
        for (Meaning const& code : exit_codes()) out += entry(code.name, code.text, 8);
        out += '\n';
    }
    return out + notes(command.get_footer(), 79);
}

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

// --- the manual page: one page for the program and all its commands, in the man macros -------------------------------

namespace {

/// Text for roff: no letter of it is an instruction, a dash is a dash.
std::string roff(std::string_view text) {
    std::string out;
    bool start = true;
    for (char const c : text) {
        if (start && (c == '.' || c == '\'')) out += "\\&";
        start = c == '\n';
        if (c == '\\') out += "\\e";
        else if (c == '-') out += "\\-";
        else if (c == '^') out += "\\(ha";
        else if (c == '~') out += "\\(ti";
        else if (c == '`') out += "\\(ga";
        else if (c == '\'') out += "\\(aq";
        else out += c;
    }
    return out;
}

/// "\fB\-\-order\fR \fIN\fR"
std::string bold(CommandOption const& one) {
    std::string const text = one.name.empty() ? ""
                                              : "\\fB" + (one.shorter.empty() ? "" : roff(one.shorter) + "\\fR, \\fB") +
                                                    roff(one.name) + "\\fR";
    std::string const value = one.value.empty() ? "" : "\\fI" + roff(one.value) + "\\fR";
    return text + (text.empty() || value.empty() ? "" : " ") + value;
}

std::string listed(std::string const& term, std::string const& text) {
    return ".TP\n" + term + '\n' + roff(text) + '\n';
}

/// Lines that are to stand as they are, beside a margin.
std::string as_written(std::string const& text) {
    if (text.empty()) return "";
    return ".PP\n.nf\n" + roff(notes(text, 72)) + ".fi\n";
}

std::string options(CLI::App const& command, bool everywhere) {
    std::string out;
    for (CommandOption const& one : options_of(command))
        if ((one.group == "With every command") == everywhere)
            out += listed(bold(one), one.text + (one.required && !one.name.empty() ? " (required)" : ""));
    return out;
}

}  // namespace

std::string manual_page(CLI::App const& app) {
    std::string out = fmt::format(
        ".\\\" Written by `rlslab man' from the definitions of the command line.\n"
        ".TH RLSLAB 1 \"\" \"rlslab {}\" \"User Commands\"\n",
        RLSLAB_VERSION);
    out += ".SH NAME\nrlslab \\- which variant of recursive least squares to trust\n.SH SYNOPSIS\n";
    auto const commands = shown_commands(app);
    for (size_t i = 0; i < commands.size(); ++i) {
        std::string const text = usage(*commands[i]), name = "rlslab " + commands[i]->get_name();
        out += (i > 0 ? ".br\n" : "") + ("\\fB" + roff(name) + "\\fR" + roff(text.substr(name.size()))) + '\n';
    }
    out += ".SH DESCRIPTION\n" + roff(app.get_description()) + "\n.PP\n" +
           roff(
               "rlslab holds the textbook variants of recursive least squares, runs them in arithmetics from bfloat16 "
               "to 257 bits, and measures each against a certified reference: the exact minimiser for the very bits "
               "the variant was given, with a proven error bound.") +
           '\n';
    out += ".SH OPTIONS\nThese may stand anywhere on the line.\n" + options(app, false) + options(app, true);
    out += ".SH COMMANDS\n";
    for (CLI::App const* command : commands)
        out += ".SS " + roff(usage(*command)) + '\n' + roff(command->get_description()) + '\n' +
               options(*command, false) + as_written(command->get_footer());
    out += ".SH EXIT STATUS\n";
    for (Meaning const& code : exit_codes()) out += listed("\\fB" + code.name + "\\fR", code.text);
    out += ".SH ENVIRONMENT\n";
    for (Meaning const& variable : environment()) out += listed("\\fB" + variable.name + "\\fR", variable.text);
    out +=
        ".SH FILES\n" +
        listed("\\fI" + roff("DIR/.trials/") + "\\fR",
               "What a study or a sweep has finished, one line for each trial. The next run goes on from there.") +
        listed("\\fI" + roff("DIR/NAME.csv, DIR/verdicts.json, DIR/verdicts.csv, DIR/report.html") + "\\fR",
               "What a study or a sweep found. Each is written beside and then renamed: it is there whole or as it was "
               "before.");
    return out;
}

Command man_command(CLI::App& app) {
    CLI::App* const c = app.add_subcommand("man", "The manual page, in roff.")->group("");
    return {c, [&app] {
                print(manual_page(app));
                return 0;
            }};
}

}  // namespace rlslab::program
