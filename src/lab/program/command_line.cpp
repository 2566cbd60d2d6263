// The program's command line: its commands, the messages for lines that are no valid command; a run, and its signals.
#include "src/lab/program/commands.hpp"
#include "src/lab/program/definitions.hpp"
#include "src/lab/program/run.hpp"

#include <rlslab/core/files.hpp>
#include <rlslab/input/suggestion.hpp>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sstream>
#include <unistd.h>

namespace rlslab::program {
using namespace report;
namespace {

/// "rlslab 0.2.0 (v0.2.0-3-g0123abc)": builds of one version differ in the revision.
std::string version_text() {
    std::string const of = revision;
    return fmt::format("rlslab {}{}\n", version, of == "of no repository" ? "" : " (" + of + ")");
}

struct CommandLine {
    CLI::App app{this_program.question, program_name()};
    std::vector<Command> const commands = this_program.commands(app);

    OutputOptions output_options;
    bool version = false, json = false;

    CommandLine() {
        app.add_flag("--version", version,
                     "version and revision of rlslab; with --json also compiler and instruction set");
        app.add_flag("--json", json, "with --version: as JSON");
        app.footer(this_program.more);
        app.require_subcommand(0, 1);  // a file may be called "list"
        app.formatter_fn(
            [](CLI::App const* asked, std::string const&, CLI::AppFormatMode) { return help_text(*asked); });
        define_output_options(app);
        for (Command const& command : commands) {
            command.app->formatter(app.get_formatter());
            define_output_options(*command.app);
        }
    }
    /// Anywhere on the line: before the command and behind it.
    void define_output_options(CLI::App& taker) {
        std::string const everywhere = "With every command";
        taker.set_help_flag("-h,--help", "this help")->group(everywhere);
        taker.add_flag("--quiet", output_options.quiet, "no progress on standard error: answers and errors alone")
            ->group(everywhere);
        taker
            .add_option_function<std::string>(
                "--color",
                [this](std::string const& when) {
                    using enum OutputOptions::Colour;
                    output_options.colour = when == "always" ? always : when == "never" ? never : automatic;
                },
                "colours in the answer; default auto: on a terminal, unless NO_COLOR is set")
            ->check([](std::string const& when) {
                return when == "auto" || when == "always" || when == "never"
                           ? ""
                           : fmt::format("expected auto, always or never, found \"{}\"", printable(when));
            })
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
            ->type_name("auto|always|never")
            ->group(everywhere);
    }

    std::vector<std::string> names() const {
        std::vector<std::string> out;
        for (CLI::App const* command : shown_commands(app)) out.push_back(command->get_name());
        return out;
    }
    /// The words as CLI11 is to take them: "--variants ud,qr" as "--variants=ud --variants=qr". It takes any word as a
    /// value, so that -1.5 can be one; an option of the same command was not meant as one.
    std::vector<std::string> with_lists_apart(std::vector<std::string> const& words) const {
        std::vector<std::string> out;
        CLI::App const* taker = &app;
        for (size_t i = 0; i < words.size(); ++i) {
            out.push_back(words[i]);
            if (words[i] == "--") return out.insert(out.end(), words.begin() + long(i) + 1, words.end()), out;
            if (taker == &app) {
                auto const named =
                    std::ranges::find(commands, words[i], [](Command const& c) { return c.app->get_name(); });
                if (named != commands.end()) taker = named->app;
            }
            std::string const name = words[i].substr(0, words[i].find('='));
            CLI::Option const* const option = name.starts_with("--") ? taker->get_option_no_throw(name) : nullptr;
            bool const apart = name == words[i];
            if (option != nullptr && takes_nothing(*option) && !apart) refuse("{}: expected no value behind it", name);
            if (option == nullptr || takes_nothing(*option)) continue;
            if (apart && ++i == words.size()) break;
            std::string const value = apart ? words[i] : words[i].substr(name.size() + 1);
            if (!apart && value.empty()) refuse("{}: expected {}, found nothing", name, option->get_type_name());
            if (apart && value.starts_with("--") &&
                taker->get_option_no_throw(value.substr(0, value.find('='))) != nullptr)
                refuse("{}: expected {}, found the option {}", name, option->get_type_name(), printable(value));
            bool const several = option->get_items_expected_max() > 1;
            if (several && option->get_multi_option_policy() != CLI::MultiOptionPolicy::TakeAll && !value.empty()) {
                out.pop_back();
                for (std::string const& part : parts_of(value)) {
                    if (part.empty())
                        refuse("{}: expected {}, no part of it empty, found \"{}\"", name, option->get_type_name(),
                               printable(value));
                    out.push_back(name + '=' + part);
                }
            } else if (apart) out.push_back(value);
        }
        return out;
    }
    /// "\"u,1\",v" is the two names u,1 and v, as in CSV; "x(:,2),v" the names x(:,2) and v. Blanks around a part go.
    static std::vector<std::string> parts_of(std::string const& list) {
        std::vector<std::string> out{""};
        bool quoted = false;
        for (size_t i = 0; i < list.size(); ++i) {
            std::string& part = out.back();
            size_t const next = list.find_first_not_of(' ', i + 1);
            bool const last = next == list.npos || list[next] == ',';
            if (quoted && list.compare(i, 2, "\"\"") == 0) part += list[i++];
            else if (list[i] == '"' && (quoted ? last : part.empty())) quoted ^= true;
            else if (list[i] == ',' && !quoted && !part.ends_with("(:")) out.emplace_back();
            else if (list[i] != ' ' || quoted || (!last && !part.empty())) part += list[i];
        }
        if (quoted) out.back().insert(0, 1, '"');  // none closes it
        return out;
    }
    /// What CLI11 found wrong, in our words.
    std::string complaint(CLI::ParseError const& error) const {
        std::string const text = error.what(), missing = " missing", required = " is required";
        if (size_t const at = text.find(": 1 required "); at != text.npos && text.ends_with(missing))
            return fmt::format("{}: expected {}, found nothing", text.substr(0, at),
                               text.substr(at + 13, text.size() - at - 13 - missing.size()));
        if (size_t const at = text.find(": At Most 1 required"); at != text.npos)
            return text.substr(0, at) + ": expected once, found again";
        if (!text.ends_with(required)) return text;
        std::string const name = text.substr(0, text.size() - required.size());
        auto const asked = app.get_subcommands().front();  // the program itself requires nothing
        for (CommandOption const& one : options_of(*asked))
            if (one.name == name || one.value == name)
                return fmt::format("{0}: expected {1} ({2} {0} --help)", asked->get_name(), one.spelling(),
                                   program_name());
        return text;
    }
    /// An unknown word is reported before anything else: a missing option is often a misspelt one.
    void refuse_extra_word() const {
        std::vector<std::string> const own = app.remaining(false),
                                       all = app.remaining(true);  // of the program; of its command besides
        if (all.empty()) return;
        auto const asked = std::ranges::find_if(commands, [](Command const& c) { return c.app->parsed(); });
        CLI::App const& misled = own.empty() && asked != commands.end() ? *asked->app : app;
        std::string const word = own.empty() ? all.front() : own.front();
        if (word.starts_with("-")) refuse_option(misled, word.substr(0, word.find('=')));
        std::vector<std::string> const known = names();
        bool const compares = &misled == &app && std::ranges::find(known, "compare") != known.end();
        if (std::error_code no_file; compares && std::filesystem::is_regular_file(word, no_file))
            refuse(
                "\"{0}\" is a file: rlslab compare {0} --input U --output Y --order N, or identify; rlslab state {0} "
                "if it is a filter's state",
                printable(word, 1000));
        if (compares && word == "advise") refuse("advise: it is rlslab compare --digits N now, with the same options");
        if (&misled == &app) expect_one_of(views(known), word, "", "command");
        refuse("\"{}\" is one word too many ({} {} --help)", printable(word), program_name(), misled.get_name());
    }
    /// Names without their dashes are compared: these would make short ones alike.
    [[noreturn]] static void refuse_option(CLI::App const& misled, std::string const& word) {
        std::vector<std::string> known;
        for (CLI::Option const* option : misled.get_options())
            known.insert(known.end(), option->get_lnames().begin(), option->get_lnames().end());
        std::string_view const meant =
            nearest(std::string_view(word).substr(std::min(word.size(), word.find_first_not_of('-'))), views(known));
        std::string const help = program_name() + (misled.get_parent() ? ' ' + misled.get_name() : "") + " --help";
        refuse("no option \"{}\" ({})", printable(word),
               meant.empty() ? help : fmt::format("did you mean \"--{}\"?", meant));
    }
    static std::vector<std::string_view> views(std::vector<std::string> const& names) {
        return {names.begin(), names.end()};
    }
};

}  // namespace

std::function<int()> parse(std::vector<std::string> words) {
    auto const line = std::make_shared<CommandLine>();
    CLI::App& app = line->app;
    auto const end = std::ranges::find(words, "--");  // behind it stand names of files
    if (std::none_of(words.begin(), end, [](std::string const& word) { return word == "--help" || word == "-h"; }))
        words = line->with_lists_apart(words);
    std::ranges::reverse(words);  // CLI11 takes them from the back
    try {
        app.parse(std::move(words));
    } catch (CLI::Success const& success) {
        std::ostringstream text;
        app.exit(success, text, text);
        return [text = text.str()] { return print(text), 0; };
    } catch (CLI::ParseError const& error) {
        for (CLI::App const* asked : app.get_subcommands())
            if (asked->get_help_ptr()->count() > 0)
                return [line, asked] { return print(help_text(*asked)), 0; };  // whatever else is wrong
        line->refuse_extra_word();
        throw InputError(printable(line->complaint(error), 200));
    }
    if (line->version)
        return [json = line->json] {
            return print(json ? as_json({.instruction_set = instruction_set()}) + '\n' : version_text()), 0;
        };
    if (line->json) refuse("--json: expected behind --version or a command");
    for (Command const& command : line->commands)
        if (command.app->parsed())
            return [line, run = command.run] {
                set_output_options(line->output_options);
                return run();
            };
    refuse("expected a command: {} ({} --help has more)", fmt::join(line->names(), ", "), program_name());
}

// --- from words to the exit code; signals end it as in git: a handler cleans up and raises the signal again ----------

namespace {

char advice[512];
std::atomic<size_t> length = 0;
std::atomic<bool> terminal = false;

/// Calls only functions that a signal handler may call: unlink, write, raise.
void clean_up(int signal) {
    remove_unfinished_file();
    if (terminal) (void)!::write(STDERR_FILENO, "\n", 1);  // the line of progress, and ^C, end here
    if (length > 0) (void)!::write(STDERR_FILENO, advice, length);
    ::raise(signal);  // the handler is gone (SA_RESETHAND): its default comes when this one returns
}

}  // namespace

void when_stopped(std::string const& text) {
    terminal = ::isatty(STDERR_FILENO) == 1;
    length = 0;
    size_t const fits = std::min(text.size(), sizeof advice);
    std::memcpy(advice, text.data(), fits);
    length = fits;
    struct sigaction act {};
    act.sa_handler = clean_up;
    act.sa_flags = SA_RESETHAND;
    for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        ::sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) ::sigaction(signal, &act, nullptr);  // with nohup it stays ignored
    }
}

void prepare_process() {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    sigprocmask(SIG_UNBLOCK, &pipe, nullptr);
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_IGN);
    when_stopped("");
    // A file that is opened takes the least free number: one that is closed gets a file that cannot be used that way.
    for (int const file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (::fcntl(file, F_GETFD) < 0) (void)!::open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

int run(std::vector<std::string> const& words, int rank, std::string const& name) {
    bool understood = false;
    try {
        set_command(words, name);
        auto const command = parse(words);
        understood = true;
        return command();
    } catch (std::bad_alloc const&) {
        std::fprintf(stderr, "%s: out of memory\n", name.c_str());
    } catch (std::exception const& error) {
        std::string line = error.what();
        for (char& c : line)
            if (c == '\n' || c == '\r') c = ' ';
        if (understood || rank == 0) std::fprintf(stderr, "%s: %s\n", name.c_str(), line.c_str());
    } catch (...) {
        std::fprintf(stderr, "%s: something was thrown that is no std::exception\n", name.c_str());
    }
    return 2;
}

}  // namespace rlslab::program
