// The options that every run of trials has, and such a run: whole, or a part of it.
#include "src/lab/program/study_options.hpp"
#include "src/lab/report/svg.hpp"
#include <rlslab/studies/journal.hpp>
#include <rlslab/studies/report.hpp>

#include <rlslab/core/files.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rlslab::program {
using namespace report;
using namespace studies;
namespace {

/// "2/8"; nothing for what is no part.
std::optional<Part> part_of(std::string const& text) {
    Part part;
    char const *const end = text.data() + text.size(), *const slash = std::find(text.data(), end, '/');
    auto const number = std::from_chars(text.data(), slash, part.number);
    if (number.ec != std::errc() || number.ptr != slash || slash == end) return {};
    auto const of = std::from_chars(slash + 1, end, part.of);
    if (of.ec != std::errc() || of.ptr != end || part.number < 1 || part.number > part.of || part.of > 100000)
        return {};
    return part;
}

void keep_when_stopped(StudyRun const& run) {
    when_stopped(fmt::format("{}: stopped. Finished trials are kept in {}: the same command goes on from there.\n",
                             program_name(), printable(run.out, 200)));
}

constexpr char converter[] = "rsvg-convert";
bool converts() {
    std::string const path = std::getenv("PATH") ? std::getenv("PATH") : "";
    for (size_t begin = 0, end; begin <= path.size(); begin = end + 1) {
        end = std::min(path.find(':', begin), path.size());
        if (access((path.substr(begin, end - begin) + '/' + converter).c_str(), X_OK) == 0) return true;
    }
    return false;
}
/// For papers: a PDF beside an SVG.
void convert(std::filesystem::path const& drawing) {
    std::filesystem::path const pdf = std::filesystem::path(drawing).replace_extension(".pdf");
    char const* const words[] = {converter, "--format", "pdf", "--output", pdf.c_str(), drawing.c_str(), nullptr};
    pid_t child = 0;
    int status = -1;
    if (posix_spawnp(&child, converter, nullptr, nullptr, const_cast<char* const*>(words), environ) != 0 ||
        waitpid(child, &status, 0) != child || status != 0)
        refuse("--figures pdf: {}: {} made no PDF of it", printable(drawing.string(), 200), converter);
}

}  // namespace

void define_run(CLI::App& command, StudyRun& run, char const* seed_help, char const* or_merge) {
    define(command, {seed_option(run.options.seed, seed_help),
                     {"--threads", run.options.threads, "N", whole(1, 4096),
                      "how many run at once; default: all cores. No byte of a table depends on it"},
                     OptionRow("--out", run.out, "DIR", named("a folder"),
                               "folder for tables, figures and the report; default: " + run.out)
                         .last(),
                     {"--fresh", run.fresh, "forget what an earlier run of this has finished"},
                     OptionRow("--figures", run.figures, "svg|pdf",
                               CLI::Validator(
                                   [](std::string& text) {
                                       if (text != "svg" && text != "pdf")
                                           return fmt::format("expected svg or pdf, found \"{}\"", printable(text));
                                       return text == "svg" || converts()
                                                  ? ""
                                                  : fmt::format("expected {} in PATH, which makes them", converter);
                                   },
                                   ""),
                               "pdf: each figure also as PDF, by rsvg-convert; default svg")
                         .last()});
    command
        .add_option_function<std::string>(
            "--part", [&run](std::string const& text) { run.part = *part_of(text); },
            fmt::format("run the trials of part I of N alone: on other machines, into one folder that all see{}",
                        or_merge))
        ->check([](std::string const& text) {
            return part_of(text)
                       ? ""
                       : fmt::format("expected I/N with 1 <= I <= N <= 100000, found \"{}\"", printable(text));
        })
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->type_name("I/N");
}

void check_part(StudyRun const& run) {
    if (run.fresh)
        refuse("--fresh: does not go with --part; expected an --out folder of this run's parts alone, or a new one");
}

std::string noted_run(std::string const& folder) {
    std::filesystem::path const path = std::filesystem::path(folder) / ".trials" / "run.json";
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return "";
    if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) > 1'000'000)
        refuse("{}: expected the file that {} study --part writes", printable(path.string(), 200), program_name());
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void expect_no_other_run(std::string const& folder, char const* file, char const* command) {
    if (std::filesystem::exists(std::filesystem::path(folder) / file))
        refuse("--out {}: holds what {} {} made ({}); expected another folder", printable(folder, 200), program_name(),
               command, file);
}

void run_one_part(std::vector<Study const*> const& chosen, StudyRun const& run, std::string const& text,
                  char const* others, std::string const& or_merge) {
    create_folder(run.options.out / ".trials");
    FolderLock const lock(run.options.out, run.part);
    std::string const before = noted_run(run.out);
    if (!before.empty() && before != text)
        refuse("{}: holds parts of {}; expected another --out, or that run finished", printable(run.out, 200), others);
    replace_file(run.options.out / ".trials" / "run.json", text);
    keep_when_stopped(run);
    Share const share = run_part(chosen, run.options, run.part, progress_after_a_second("studying"));
    tell(
        fmt::format("{}: part {} of {}: {} of {} trials, {} of them finished before; the same command without "
                    "--part{} makes the tables\n",
                    program_name(), run.part.number, run.part.of, share.own, share.all, share.resumed, or_merge));
}

std::vector<Outcome> run_whole(std::vector<Study const*> const& chosen, StudyRun const& run) {
    std::filesystem::path const& out = run.options.out;
    create_folder(out / "figures");
    for (char const* part : {"", ".trials", "figures"}) remove_leftovers(out / part);
    keep_when_stopped(run);
    if (run.fresh)
        for (Study const* study : chosen) forget_trials(out / ".trials", study->name);
    std::vector<Outcome> const outcomes = run_studies(chosen, run.options, progress_after_a_second("studying"));
    for (Outcome const& outcome : outcomes)
        for (Figure const& figure : figures(*outcome.study, outcome.table)) {
            std::filesystem::path const drawing = out / "figures" / (figure.name + ".svg");
            replace_file(drawing, svg(figure));
            if (run.figures == "pdf") convert(drawing);
        }
    replace_file(out / "report.html", report_html(outcomes, run.options));
    return outcomes;
}

}  // namespace rlslab::program
