// A program of somebody's own studies: what stands in it in place of the tree's list, record and commands.
#include <rlslab/studies/study_main.hpp>

#include <rlslab/studies/factors.hpp>
#include "src/lab/program/commands.hpp"
#include "src/lab/program/run.hpp"

#include <filesystem>
#include <set>
#include <stdexcept>

namespace rlslab {
namespace studies {
namespace {
std::vector<Study const*> own;
}

std::vector<Study const*> const& studies() { return own; }
std::string_view subject_of(Study const&) { return {}; }

extern char const* const recorded_quick;
extern char const* const recorded_full;
char const* const recorded_quick = "{}";
char const* const recorded_full = "{}";

}  // namespace studies

namespace program {

ThisProgram const this_program{
    .question = "Studies of recursive least squares: tables, figures, verdicts and a report.",
    .more = "--help behind a command has more about it.",
    .answer_is_no = "a verdict changed or a verification failed",
    .commands =
        [](CLI::App& app) {
            return std::vector<Command>{study_command(app), merge_command(app), list_command(app), help_command(app)};
        },
};

}  // namespace program

int study_main(int argc, char const* const* argv, std::vector<studies::Study> const& studies) {
    std::set<std::string> names;
    for (studies::Study const& study : studies) {
        if (study.name.empty() || study.name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                                               "0123456789_-") != std::string::npos)
            throw std::invalid_argument("study_main: \"" + study.name +
                                        "\": expected letters, digits, _ and - in a study's name");
        if (!names.insert(study.name).second)
            throw std::invalid_argument("study_main: two studies have the name \"" + study.name + '"');
    }
    if (studies.empty()) throw std::invalid_argument("study_main: expected a study");
    studies::own.clear();
    for (studies::Study const& study : studies) studies::own.push_back(&study);
    program::prepare_process();
    return program::run({argv + (argc > 0), argv + argc}, 0,
                        argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "studies");
}

}  // namespace rlslab
