// The manual page: one page for the program and all its commands, in the man macros.
#include "src/lab/program/commands.hpp"
#include "src/lab/program/definitions.hpp"

#include <fmt/format.h>

namespace rlslab::program {
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
