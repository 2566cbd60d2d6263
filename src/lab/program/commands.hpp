// Functions that the program's subcommands share: checks of options, and output.
#pragma once

#include "src/lab/report/messages.hpp"
#include "src/lab/report/provenance.hpp"

#include <rlslab/input/formats/open.hpp>

#include <CLI/CLI.hpp>
#include <concepts>
#include <initializer_list>
#include <limits>
#include <optional>
#include <ranges>
#include <string>

namespace rlslab::program {

/// A check for a whole number, or a finite one, in [least, most]; its message, one line, says what was expected.
CLI::Validator whole(long least, long most);
CLI::Validator real(char const* expected, double least, double most = std::numeric_limits<double>::max());
inline constexpr double above_zero = std::numeric_limits<double>::denorm_min();
/// The same for a name that is not empty.
CLI::Validator named(char const* expected);

/// An option of a command as a row {name, variable, value, check, help}. The command line, its checks, help, manual and
/// completion are made from it. A variable that is a list takes names in one word: it must not swallow FILE behind it.
class OptionRow {
    enum class Given { once, last, listed, repeated } given_ = Given::once;
    bool required_ = false;
    char const* value_ = nullptr;  // none: a flag
    CLI::Validator check_;
    std::function<CLI::Option*(CLI::App&)> add_;

public:
    template <class T>
    OptionRow(std::string name, T& into, char const* value, CLI::Validator check, std::string help)
        : value_(value), check_(std::move(check)) {
        if (std::ranges::range<T> && !std::same_as<T, std::string> && name.starts_with("--")) given_ = Given::listed;
        add_ = [=, &into](CLI::App& command) { return command.add_option(name, into, help); };
    }
    template <class T>
    OptionRow(std::string name, T& into, char const* value, std::string help)
        : OptionRow(std::move(name), into, value, CLI::Validator(), std::move(help)) {}
    OptionRow(std::string name, bool& into, std::string help)
        : add_([=, &into](CLI::App& command) { return command.add_flag(name, into, help); }) {}

    OptionRow required() && { return required_ = true, std::move(*this); }
    OptionRow last() && { return given_ = Given::last, std::move(*this); }  ///< may be given again: the last one counts
    OptionRow repeated() && { return given_ = Given::repeated, std::move(*this); }  ///< may be given for several
    CLI::Option* define(CLI::App& command) const;
};
void define(CLI::App& command, std::initializer_list<OptionRow> rows);

/// --forgetting, --seed, --p0 and --out of several commands.
OptionRow forgetting_option(double& forgetting);
OptionRow seed_option(std::uint64_t& seed, char const* help);
OptionRow prior_option(std::optional<double>& p0, char const* help);
OptionRow folder_option(std::string& folder, char const* help);

/// Of FILE, of every command that leaves out rows that miss a value.
inline constexpr char file_with_missing_values[] =
    "CSV file (-: standard input), plain or by gzip, or MATLAB's; empty, NA, N/A, NaN, null, . and ? are missing "
    "values, and rows that miss one are skipped";

/// --separator, --decimal and --missing, of every command that reads a file.
void define_format(CLI::App& command, CsvFormat& format);

/// --time, of the commands that take rows for samples.
OptionRow time_option(std::string& column);

/// Writes the whole answer to standard output. InputError when it cannot be written; a closed pipe ends the program.
void print(std::string const& text);

/// Writes a line to standard error, unless --quiet was said.
void tell(std::string const& line);

/// progress_text() on standard error from the second second on, where it is a terminal and --quiet was not said. The
/// line is erased when the last copy of the function is destroyed.
report::StagedProgress stages_after_a_second();
report::Progress progress_after_a_second(std::string doing);

/// The columns of the terminal that standard output is; 0: it is none, or does not say.
size_t terminal_columns();

/// Whether standard output is to be coloured: --color, then NO_COLOR, then whether it is a terminal that can.
bool colour();

/// The options of every command that concern its output.
struct OutputOptions {
    enum class Colour { automatic, always, never } colour = Colour::automatic;
    bool quiet = false;
};
/// Sets them for this process.
void set_output_options(OutputOptions const& options);

/// The words of this process's command line, without the program's name, and that name.
void set_command(std::vector<std::string> const& words, std::string const& name = "rlslab");
/// "rlslab", or that of a program of somebody's own studies.
std::string const& program_name();
/// Of the kernels that run here: "baseline", "avx2", "avx512".
char const* instruction_set();
/// The run that an answer is from: the command without the words that change no byte of it (--out, --threads, --json,
/// --csv, --color, --quiet) and, if `dated`, the instruction set and the date. Without them the bytes of an answer are
/// the same on every machine.
report::Provenance this_run(bool dated);
/// The same of an answer about the columns that were read from a file.
report::Provenance this_run(bool dated, std::string const& file, std::string const& sha256, long rows);
/// --no-timings of commands that measure no time.
void define_undated(CLI::App& command, bool& dated);

/// After this call SIGINT, SIGTERM and SIGHUP leave no half-written file and no line of progress, and print this advice
/// on standard error ("" for none). The process then ends by the signal, as its parent expects.
void when_stopped(std::string const& advice);

/// A subcommand: its options, and the function that runs it and returns the exit code.
struct Command {
    CLI::App* app;
    std::function<int()> run;
};
Command compare_command(CLI::App& app);
Command sweep_command(CLI::App& app);
/// What --vary names, in the order of the table.
inline constexpr std::string_view sweep_factors[] = {"order", "forgetting", "prior", "arithmetic", "variant"};
Command study_command(CLI::App& app);
Command merge_command(CLI::App& app);
Command identify_command(CLI::App& app);
Command simulate_command(CLI::App& app);
Command excitation_command(CLI::App& app);
Command state_command(CLI::App& app);
Command export_command(CLI::App& app);
Command list_command(CLI::App& app);
Command example_command(CLI::App& app);
Command cite_command(CLI::App& app);
Command help_command(CLI::App& app);
Command man_command(CLI::App& app);         ///< not shown: for the build
Command completion_command(CLI::App& app);  ///< not shown: for the build

/// What a command line is for, and its commands. A program links one: rlslab's, or that of somebody's own studies.
struct ThisProgram {
    char const* question;                             ///< the first line of its help
    char const* more;                                 ///< the last
    char const* answer_is_no;                         ///< what exit code 1 says
    std::vector<Command> (*commands)(CLI::App& app);  ///< in the order of the help
};
extern ThisProgram const this_program;

/// Parses and checks the words of a command line (without the program's name). The function returned runs the command
/// and returns the exit code. Throws InputError for words that are no valid command.
std::function<int()> parse(std::vector<std::string> words);

}  // namespace rlslab::program
