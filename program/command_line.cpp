// The program's command line: its commands, and what a person is told whose words are none.
#include "commands.hpp"

#include <fmt/format.h>
#include <sstream>

namespace rlslab {
namespace {

struct CommandLine {
    CLI::App app{"Which variant of recursive least squares can you trust, on your data, in your arithmetic, at what price?", "rlslab"};
    std::vector<Command> const commands{compare_command(app),  study_command(app),      identify_command(app),
                                        simulate_command(app), excitation_command(app), list_command(app)};

    CommandLine() { app.set_version_flag("--version", "rlslab " RLSLAB_VERSION); }

    std::string names() const {
        std::string out;
        for (size_t i = 0; i < commands.size(); ++i)
            out += (i == 0 ? "" : i + 1 < commands.size() ? ", " : " or ") + commands[i].app->get_name();
        return out;
    }
    [[noreturn]] void refuse_extra_word() const {
        bool const own = !app.remaining(false).empty();    // the program's, not its command's
        std::string const word = printable(own ? app.remaining(false).front() : app.remaining(true).front());
        auto const asked = own ? commands.end() : std::ranges::find_if(commands, [](Command const& c) { return c.app->parsed(); });
        if (own && !word.starts_with("-"))
            throw InputError(fmt::format("no command \"{}\": expected {} (rlslab --help tells more)", word, names()));
        throw InputError((word.starts_with("-") ? fmt::format("no option \"{}\"", word) : fmt::format("\"{}\" is one word too many", word)) +
                         (asked == commands.end() ? " (rlslab --help)" : fmt::format(" (rlslab {} --help)", asked->app->get_name())));
    }
};

}  // namespace

std::function<int()> parse(std::vector<std::string> words) {
    auto const line = std::make_shared<CommandLine>();
    CLI::App& app = line->app;
    std::ranges::reverse(words);    // CLI11 takes them from the back
    try {
        app.parse(std::move(words));
    } catch (CLI::Success const& success) {
        std::ostringstream text;
        app.exit(success, text, text);
        return [text = text.str()] {
            print(text);
            return 0;
        };
    } catch (CLI::ExtrasError const&) {
        line->refuse_extra_word();
    } catch (CLI::ParseError const& error) {
        std::string const text = error.what();
        if (size_t const at = text.find(": At Most 1 required"); at != text.npos) throw InputError(printable(text.substr(0, at), 200) + ": expected once, found again");
        throw InputError(printable(text, 200));
    }
    for (Command const& command : line->commands)
        if (command.app->parsed()) return [line, run = command.run] { return run(); };
    throw InputError(fmt::format("expected a command: {} (rlslab --help tells more)", line->names()));
}

}  // namespace rlslab
