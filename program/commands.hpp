// What the program's subcommands share: checks of options, and the one way out.
#pragma once

#include "report/progress.hpp"

#include <rlslab/model/csv.hpp>

#include <CLI/CLI.hpp>
#include <string>

namespace rlslab {

/// A whole number in [least, most], else one line that says so.
CLI::Validator whole(long least, long most);
/// A finite number that `holds`, else one line that says what was expected.
CLI::Validator real(char const* expected, bool (*holds)(double));
/// --forgetting of the commands that estimate.
void take_forgetting(CLI::App& command, double& forgetting);

/// A name that is not empty, else one line that says what was expected.
CLI::Validator named(char const* expected);
/// What a list split at commas holds: "\"u,1\",v" is the two columns u,1 and v, as in CSV.
std::vector<std::string> unquoted(std::vector<std::string> const& parts);

/// --separator and --decimal, of every command that reads a file.
void take_format(CLI::App& command, CsvFormat& format);

/// The whole answer to standard output. Throws InputError when it cannot be written; a closed pipe ends the program instead.
void print(std::string const& text);

/// "comparing  42 %, 3 min left" on standard error from the second second on, where that is a terminal and --quiet was not said.
/// The line is wiped off when the last copy of the function goes.
Progress progress_after_a_second(std::string doing);

/// Whether standard output is to be coloured: --color, then NO_COLOR, then whether it is a terminal that can.
bool colour();

/// What every command takes: how the program behaves towards who sees its output.
struct Manners {
    enum class Colour { automatic, always, never } colour = Colour::automatic;
    bool quiet = false;
};
/// Of this process, from now on.
void behave(Manners const& manners);

/// What SIGINT, SIGTERM or SIGHUP leave: no half-written file, nothing of the progress, this advice on standard error ("" for none).
/// The process then dies of the signal, as who started it expects.
void when_stopped(std::string const& advice);

/// A subcommand: its options, and what to do once it was asked for; gives the exit code.
struct Command {
    CLI::App* app;
    std::function<int()> run;
};
Command compare_command(CLI::App& app);
Command study_command(CLI::App& app);
Command identify_command(CLI::App& app);
Command simulate_command(CLI::App& app);
Command excitation_command(CLI::App& app);
Command list_command(CLI::App& app);
Command help_command(CLI::App& app);
Command man_command(CLI::App& app);         ///< not shown: for the build
Command completion_command(CLI::App& app);  ///< not shown: for the build

/// What the words of a command line (the program's name left out) ask for: parsed and checked, not yet run. Called, it answers
/// and gives the exit code. Throws InputError for words that ask for nothing.
std::function<int()> parse(std::vector<std::string> words);

}  // namespace rlslab
