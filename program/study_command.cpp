// rlslab study: questions with claims; tables, figures, verdicts, a report.
#include "program/commands.hpp"
#include "report/svg.hpp"
#include "studies/engine/journal.hpp"
#include "studies/engine/report.hpp"
#include "studies/engine/verdicts.hpp"

#include <rlslab/core/suggestion.hpp>

#include <fmt/format.h>

namespace rlslab {
namespace {

struct StudyArguments {
    std::vector<std::string> names;
    bool all = false, fresh = false;
    std::string budget = "quick", out = "out", record;
    RunOptions options;
};

std::string listed(std::string_view head, std::vector<std::string> const& lines) {
    std::string out;
    for (std::string const& line : lines) out += "  " + line + '\n';
    return out.empty() ? "" : fmt::format("{}\n{}", head, out);
}

/// 1 if a verdict changed against the record, or a verification failed.
int run_study(StudyArguments a) {
    std::vector<Study const*> chosen;
    std::vector<std::string_view> known;
    for (Study const* study : studies()) known.push_back(study->name);
    for (std::string const& name : a.names) expect_one_of(known, name, "study", "study");
    if (a.all == !a.names.empty()) throw InputError("study: expected the names of studies (rlslab list), or --all");
    for (Study const* study : studies())
        if (a.all || std::ranges::find(a.names, study->name) != a.names.end()) chosen.push_back(study);
    a.options.budget = a.budget == "full" ? Budget::full : Budget::quick;
    a.options.out = a.out;
    create_folder(a.options.out / "figures");
    FolderLock const lock(a.options.out);
    for (char const* part : {"", ".trials", "figures"}) remove_leftovers(a.options.out / part);
    when_stopped(
        fmt::format("rlslab: stopped. Finished trials are kept in {}: the same command goes on from there.\n", printable(a.out, 200)));
    std::error_code error;
    if (a.fresh)
        for (Study const* study : chosen) std::filesystem::remove(a.options.out / ".trials" / study->name, error);
    std::vector<Outcome> const outcomes = run_studies(chosen, a.options, progress_after_a_second("studying"));
    for (Outcome const& outcome : outcomes)
        for (Figure const& figure : figures(*outcome.study, outcome.table))
            replace_file(a.options.out / "figures" / (figure.name + ".svg"), svg(figure));
    replace_file(a.options.out / "verdicts.json", verdicts_json(outcomes, a.options));
    replace_file(a.options.out / "verdicts.csv", verdicts_csv(outcomes));
    replace_file(a.options.out / "report.html", report_html(outcomes, a.options));
    std::string text;
    for (Outcome const& outcome : outcomes) text += verdict_lines(outcome, colour()) + '\n';
    Record const& record = recorded(a.options.budget);
    if (!a.record.empty()) replace_file(a.record, record_json(outcomes, record));
    std::vector<std::string> const changed = changes(outcomes, record), broken = failed_verifications(outcomes);
    text += listed("Changed against the recorded verdicts (of seed 1):", changed);
    text += listed("Verifications that fail:", broken);
    text += listed("Not in the record:", record.empty() ? std::vector<std::string>{} : unrecorded(outcomes, record));
    text += count_lines(outcomes);
    text += fmt::format("at most {:.2f} of these verdicts are expected to be wrong; tables, figures and the report are in {}\n",
                        expected_errors(outcomes), a.out);
    print(text);
    return changed.empty() && broken.empty() ? 0 : 1;
}

}  // namespace

Command study_command(CLI::App& app) {
    auto const st = std::make_shared<StudyArguments>();
    CLI::App* const studying = app.add_subcommand("study", "Questions with claims: tables, figures, verdicts and a report.");
    studying->footer(
        "One study:    rlslab study gain_error\n"
        "All of them:  rlslab study --all --budget full --out out\n"
        "Stopped, and started again by the same command, it goes on where it was.\n\n"
        "A claim is a verification (the code does what the formula says), a reproduction (a published number) or a finding (ours). It "
        "holds when its interval over the seeds lies inside its band, fails when it lies outside, and is undecided otherwise. The "
        "verdicts of seed 1 are recorded in the tree (studies/verdicts.json, studies/verdicts-full.json) and in this program.\n\n"
        "Exit code: 0 no verdict changed against the record and no verification fails; 1 otherwise; 2 the study could not be run.");
    studying->add_option("NAME", st->names, "names of studies, as rlslab list shows them")->type_name("");
    studying->add_flag("--all", st->all, "every study");
    studying->add_option("--budget", st->budget, "quick: seconds a study; full: minutes, for numbers to quote; default quick")
        ->check([](std::string const& text) {
            return text == "quick" || text == "full" ? "" : fmt::format("expected quick or full, found \"{}\"", printable(text));
        })
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->type_name("quick|full");
    studying->add_option("--seed", st->options.seed, "of all random data; default 1")
        ->check(whole(0, std::numeric_limits<long>::max()))
        ->type_name("N");
    studying->add_option("--threads", st->options.threads, "how many run at once; default: all cores. No byte of a table depends on it")
        ->check(whole(1, 4096))
        ->type_name("N");
    studying->add_option("--out", st->out, "folder for tables, figures and the report; default: out")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->type_name("DIR");
    studying->add_option("--record", st->record, "write the record with the verdicts of this run to FILE, as studies/verdicts.json is")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
        ->type_name("FILE");
    studying->add_flag("--fresh", st->fresh, "forget what an earlier run of these studies has finished");
    return {studying, [st] { return run_study(*st); }};
}

}  // namespace rlslab
