// Options checked in one line, and answers written whole.
#include "src/lab/program/commands.hpp"

#include <rlslab/linalg/isa_name.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace rlslab::program {
using namespace report;

namespace {

template <class T>
CLI::Validator number(std::string const& expected, T least, T most) {
    return {[=](std::string& text) {
                T value = 0;
                auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                bool const good =
                    error == std::errc() && end == text.data() + text.size() && least <= value && value <= most;
                return good ? "" : fmt::format("expected {}, found \"{}\"", expected, printable(text));
            },
            ""};
}

OutputOptions output_options;

/// A line that is written over itself, and wiped off in the end.
class ProgressLine {
    using Clock = std::chrono::steady_clock;
    static double seconds_since(Clock::time_point then) {
        return std::chrono::duration<double>(Clock::now() - then).count();
    }
    Clock::time_point const start_ = Clock::now();
    Clock::time_point stage_start_ = start_;
    std::string stage_;
    size_t width_ = 0;
    int shown_ = -1;

public:
    ProgressLine() = default;
    ~ProgressLine() {
        if (width_ > 0) std::fprintf(stderr, "\r%s\r", std::string(width_, ' ').c_str());
    }
    ProgressLine(ProgressLine const&) = delete;
    ProgressLine& operator=(ProgressLine const&) = delete;
    void show(std::string_view stage, double part) {
        if (stage != stage_) {
            if (!stage_.empty()) stage_start_ = Clock::now();
            stage_ = stage, shown_ = -1;
        }
        int const percent = int(100 * part);
        if (seconds_since(start_) < 1 || percent == shown_) return;
        shown_ = percent;
        std::string const line = progress_text(stage, part, seconds_since(stage_start_));
        width_ = std::max(width_, line.size());
        std::fprintf(stderr, "\r%-*s", int(width_), line.c_str());
    }
};

std::vector<std::string> command_words{"rlslab"};

}  // namespace

CLI::Validator whole(long least, long most) {
    return number(fmt::format("a whole number from {} to {}", least, most), least, most);
}
CLI::Validator real(char const* expected, double least, double most) { return number<double>(expected, least, most); }

CLI::Option* OptionRow::define(CLI::App& command) const {
    CLI::Option* const out = add_(command);
    if (!value_) return out;
    out->required(required_)->type_name(value_)->check(check_);
    if (given_ == Given::last) out->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    if (given_ == Given::listed || given_ == Given::repeated) out->allow_extra_args(false);
    if (given_ == Given::repeated) out->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    return out;
}
void define(CLI::App& command, std::initializer_list<OptionRow> rows) {
    for (OptionRow const& row : rows) row.define(command);
}

OptionRow forgetting_option(double& forgetting) {
    return {"--forgetting", forgetting, "LAMBDA", real("a number in (0, 1]", above_zero, 1),
            "forgetting factor, in (0, 1]; default 1"};
}
OptionRow seed_option(std::uint64_t& seed, char const* help) {
    return {"--seed", seed, "N", whole(0, std::numeric_limits<long>::max()), help};
}
OptionRow prior_option(std::optional<double>& p0, char const* help) {
    return {"--p0", p0, "C2", real("a positive, finite number", above_zero), help};
}
OptionRow folder_option(std::string& folder, char const* help) {
    return {"--out", folder, "DIR", named("the name of a folder"), help};
}

CLI::Validator named(char const* expected) {
    return {[=](std::string& text) { return text.empty() ? fmt::format("expected {}", expected) : ""; }, ""};
}

OptionRow time_option(std::string& column) {
    return {"--time", column, "COLUMN", named("the name of a column"),
            "column of times, numbers or as 2024-05-17 08:15:30: rows in their order, and none across a gap"};
}

void define_format(CLI::App& command, CsvFormat& format) {
    using Words = std::vector<std::pair<std::string_view, char>>;
    auto const take = [&](char const* name, char& into, Words const& known, char const* choices, char const* help,
                          char const* expected) {
        auto const meant = [known](std::string const& text) {  // a word, or the character itself
            for (auto const& [word, character] : known)
                if (text == word || text == std::string(1, character)) return character;
            return '\0';
        };
        command
            .add_option_function<std::string>(
                name, [meant, &into](std::string const& text) { into = meant(text); }, help)
            ->check([=](std::string const& text) {
                return meant(text) ? "" : fmt::format("expected {}, found \"{}\"", expected, printable(text));
            })
            ->type_name(choices);
    };
    take("--separator", format.separator,
         {{"comma", ','}, {"semicolon", ';'}, {"tab", '\t'}, {"bar", '|'}, {"blank", ' '}},
         "comma|semicolon|tab|bar|blank", "between the file's cells (blank: any number of them); default: detected",
         "comma, semicolon, tab, bar or blank");
    take("--decimal", format.decimal, {{"point", '.'}, {"comma", ','}}, "point|comma",
         "decimal mark of the file's numbers; default: detected", "point or comma");
    define(command, {{"--missing", format.missing, "WORD[,WORD]",
                      "further words or numbers that stand for a missing value: \"No Data\",-999"}});
}

void print(std::string const& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        refuse("standard output: cannot write: {}", std::strerror(errno));
}

void set_output_options(OutputOptions const& options) { output_options = options; }

std::string const& program_name() { return command_words.front(); }

void set_command(std::vector<std::string> const& words, std::string const& name) {
    static constexpr std::string_view with_value[] = {"--out", "--threads", "--color", "--figures", "--part", "--from"},
                                      alone[] = {"--json", "--csv", "--quiet", "--fresh"};
    command_words = {name};
    for (size_t i = 0; i < words.size(); ++i) {
        std::string_view const option = std::string_view(words[i]).substr(0, words[i].find('='));
        if (std::ranges::find(alone, words[i]) != std::end(alone)) continue;
        if (std::ranges::find(with_value, option) == std::end(with_value)) command_words.push_back(words[i]);
        else if (option == words[i]) ++i;
    }
}

char const* instruction_set() { return name_of(kernels::isa); }

report::Provenance this_run(bool dated) {
    report::Provenance out{.command = shell_text(command_words)};
    if (dated) out.instruction_set = instruction_set(), out.date = date_now();
    return out;
}
report::Provenance this_run(bool dated, std::string const& file, std::string const& sha256, long rows) {
    report::Provenance out = this_run(dated);
    out.file = file, out.sha256 = sha256, out.rows = rows;
    return out;
}

void define_undated(CLI::App& command, bool& dated) {
    command.add_flag_callback(
        "--no-timings", [&dated] { dated = false; },
        "leave out the date and the instruction set, which differ from run to run");
}

void tell(std::string const& line) {
    if (!output_options.quiet) std::fputs(line.c_str(), stderr);
}

StagedProgress stages_after_a_second() {
    if (output_options.quiet || !isatty(STDERR_FILENO)) return [](std::string_view, double) {};
    return [line = std::make_shared<ProgressLine>()](std::string_view stage, double part) { line->show(stage, part); };
}
Progress progress_after_a_second(std::string doing) {
    return [stages = stages_after_a_second(), doing = std::move(doing)](double part) { stages(doing, part); };
}

size_t terminal_columns() {
    winsize size{};
    return isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

bool colour() {
    if (output_options.colour != OutputOptions::Colour::automatic)
        return output_options.colour == OutputOptions::Colour::always;
    auto const environment = [](char const* name) {
        return std::string_view(std::getenv(name) ? std::getenv(name) : "");
    };
    return isatty(STDOUT_FILENO) && environment("NO_COLOR").empty() && environment("TERM") != "dumb";
}

}  // namespace rlslab::program
