// rlslab study: questions with claims; tables, figures, verdicts, a report. rlslab merge: the same from parts of a run.
#include "src/lab/program/definitions.hpp"
#include "src/lab/program/study_options.hpp"
#include <rlslab/studies/factors.hpp>
#include <rlslab/studies/journal.hpp>
#include <rlslab/studies/verdicts.hpp>

#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

namespace rlslab::program {
using namespace report;
using namespace studies;
namespace {

struct StudyArguments : StudyRun {
    std::vector<std::string> names;
    bool all = false, describe = false;
    std::string budget = "quick", record, against;
    std::vector<std::string> set;      // "kappa=1e2,1e4"
    std::vector<Study const*> chosen;  // from names and all
    Record known;                      // what the verdicts are compared with
};
struct MergeArguments {
    std::vector<std::string> from;
    std::string out = "out";
};

std::string listed(std::string_view head, std::vector<std::string> const& lines) {
    std::string out;
    for (std::string const& line : lines) out += "  " + line + '\n';
    return out.empty() ? "" : fmt::format("{}\n{}", head, out);
}

/// The record of verdicts in a file. Throws InputError for what cannot be read or is none.
Record record_in(std::string const& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code none;
    if (!file || std::filesystem::is_directory(path, none))
        refuse("--against: {}: cannot be read", printable(path, 200));
    constexpr size_t most = 1 << 24;  // those of the tree have 70 kB
    std::string text(most + 1, '\0');
    file.read(text.data(), std::streamsize(text.size()));
    text.resize(size_t(file.gcount()));
    if (text.size() > most)
        refuse("--against: {}: expected a record of verdicts, found more than 16 MB", printable(path, 200));
    try {
        Record const out = record_from(text);
        if (out.empty()) refuse("expected a record of verdicts, found none in it");
        return out;
    } catch (InputError const& error) {
        refuse("--against: {}: {}", printable(path, 200), printable(std::string(error.what()), 200));
    }
}

constexpr size_t shown_at_most = 20;  // names of studies on one line

/// Takes the words into what the engine asks for. Throws InputError for an unknown name, or none.
void resolve(StudyArguments& a) {
    a.options.budget = a.budget == "full" ? Budget::full : Budget::quick;
    a.options.out = a.out;
    a.options.program = program_name();
    std::vector<std::string_view> known;
    for (Study const* study : studies::studies()) known.push_back(study->name);
    for (std::string const& name : a.names)
        if (std::ranges::find(known, name) == known.end() && known.size() > shown_at_most &&
            did_you_mean(name, known).empty())
            refuse("study: no study \"{}\"; {} list studies shows the {}", printable(name), program_name(),
                   known.size());
        else expect_one_of(known, name, "study", "study");
    if (a.all == !a.names.empty()) refuse("study: expected the names of studies ({} list), or --all", program_name());
    for (Study const* study : studies::studies())
        if (a.all || std::ranges::find(a.names, study->name) != a.names.end()) a.chosen.push_back(study);
    a.options.set.clear();
    for (std::string const& text : a.set) {
        FactorValues const values = factor_values_from(text);
        if (std::ranges::find(a.options.set, values.name, &FactorValues::name) != a.options.set.end())
            refuse("--set: factor \"{}\" is set twice", printable(values.name));
        a.options.set.push_back(values);
    }
    for (Study const* study : a.chosen) factors_of(*study, a.options);  // before anything is written
    for (auto const& [option, file] : {std::pair("--record", &a.record), std::pair("--against", &a.against)})
        if (!file->empty() && (a.options.changed() || !a.part.whole()))
            refuse("{}: does not go with {}", option,
                   a.options.changed() ? "--set and --seeds: claims are then not judged"
                                       : "--part: a part has no verdicts");
    if (!a.options.changed()) a.known = a.against.empty() ? recorded(a.options.budget) : record_in(a.against);
}

std::string duration_text(double seconds) {
    return seconds < 1      ? "1 s"
           : seconds < 90   ? fmt::format("{:.0f} s", seconds)
           : seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60)
                            : fmt::format("{:.1f} h", seconds / 3600);
}

/// What the studies are; how long they take is tried here.
int describe(StudyArguments const& a) {
    size_t const width = line_width(terminal_columns(), help_width);
    std::string text;
    for (Study const* study : a.chosen) {
        text += (text.empty() ? "" : "\n") + described(*study, width) + "time here\n";
        for (Budget const budget : {Budget::quick, Budget::full}) {
            RunOptions options = a.options;
            options.budget = budget;
            TimeEstimate const t = estimated_time(*study, options, 2);
            int const threads =
                options.threads > 0 ? options.threads : std::max(1, int(std::thread::hardware_concurrency()));
            double const seconds = t.of_one * std::max(1.0, double(t.trials) / threads);
            text += fmt::format("  {:<6}{} trials: {} {} on {} cores{}\n", name_of(budget), t.trials,
                                t.tried > 0 ? "about" : "more than", duration_text(seconds), threads,
                                t.tried > 0 ? fmt::format(" ({} of them tried)", t.tried) : "");
        }
    }
    print(text);
    return 0;
}

/// What the parts of a run have in common, as `rlslab merge` reads it in DIR/.trials/run.json.
std::string run_json(StudyArguments const& a) {
    std::vector<std::string> names;
    for (Study const* study : a.chosen) names.push_back(study->name);
    nlohmann::ordered_json out{{"studies", names}, {"budget", a.budget}, {"seed", a.options.seed}};
    if (!a.set.empty()) out["set"] = a.set;
    if (a.options.seeds > 0) out["seeds"] = a.options.seeds;
    return out.dump(1) + '\n';
}

/// 1 if a verdict changed against the record, or a verification failed.
int study_whole(StudyArguments const& a) {
    create_folder(a.options.out / "figures");
    create_folder(a.options.out / "tables");
    if (!a.record.empty()) expect_replaceable(a.record);
    FolderLock const lock(a.options.out);
    remove_leftovers(a.options.out / "tables");
    std::vector<Outcome> const outcomes = run_whole(a.chosen, a);
    std::error_code error;
    std::filesystem::remove(a.options.out / ".trials" / "run.json", error);  // its parts are in this run now
    for (Outcome const& outcome : outcomes)
        replace_file(a.options.out / "tables" / (outcome.study->name + ".tex"), table_tex(outcome, a.options));
    replace_file(a.options.out / "numbers.tex", numbers_tex(outcomes, a.options));
    replace_file(a.options.out / "verdicts.json", verdicts_json(outcomes, a.options));
    replace_file(a.options.out / "verdicts.csv", as_comments(run_of(outcomes, a.options)) + verdicts_csv(outcomes));
    std::string text;
    size_t const columns = terminal_columns(), width = columns > 0 ? line_width(columns, 120) : text.npos;
    for (Outcome const& outcome : outcomes) text += verdict_lines(outcome, colour(), width) + '\n';
    if (!a.record.empty()) replace_file(a.record, record_json(outcomes, a.known));
    std::vector<std::string> const changed = changes(outcomes, a.known), broken = failed_verifications(outcomes);
    text += listed("Changed against the recorded verdicts (of seed 1):", changed);
    text += listed("Verifications that fail:", broken);
    if (a.record.empty() && !a.known.empty()) text += listed("Not in the record:", unrecorded(outcomes, a.known));
    if (a.options.changed())
        return print(text + fmt::format("tables, figures and the report are in {}\n", printable(a.out, 200))), 0;
    text += count_lines(outcomes);
    size_t undecided = 0;
    for (Count const& count : counted(outcomes)) undecided += count.undecided;
    if (undecided > 0 && a.options.budget == Budget::quick) {
        std::string names = a.all ? "--all" : "";
        for (std::string const& name : a.names) names += (names.empty() ? "" : " ") + name;
        text += fmt::format("{} undecided at the quick budget, of few seeds: {} study {} --budget full has more\n",
                            undecided, program_name(), names);
    }
    double const wrong = expected_errors(outcomes);
    text += fmt::format("{} of these verdicts are expected to be wrong\ntables, figures and the report are in {}\n",
                        wrong < 0.01 ? "less than 0.01" : fmt::format("at most {:.2f}", wrong), printable(a.out, 200));
    print(text);
    return changed.empty() && broken.empty() ? 0 : 1;
}

int run_study(StudyArguments& a) {
    resolve(a);
    if (a.describe) return describe(a);
    expect_no_other_run(a.out, "sweep.csv", "sweep");
    if (a.part.whole()) return study_whole(a);
    check_part(a);
    run_one_part(a.chosen, a, run_json(a), "other studies, another budget or seed",
                 fmt::format(" (or {} merge)", program_name()));
    return 0;
}

/// The options of the parts of a run.
StudyArguments arguments_of(std::string const& run, std::string const& folder, std::string const& out_folder) {
    StudyArguments out;
    out.out = out_folder;
    try {
        auto const said = nlohmann::json::parse(run);
        auto const& seed = said.at("seed");
        said.at("studies").get_to(out.names);
        said.at("budget").get_to(out.budget);
        seed.get_to(out.options.seed);
        if (said.contains("set")) said.at("set").get_to(out.set);
        if (said.contains("seeds")) said.at("seeds").get_to(out.options.seeds);
        if (!seed.is_number_unsigned() || (out.budget != "quick" && out.budget != "full")) refuse("");
        resolve(out);
    } catch (std::exception const&) {
        refuse("{}/.trials/run.json: expected studies, budget and seed as {} study --part writes them",
               printable(folder, 200), program_name());
    }
    return out;
}

int run_merge(MergeArguments const& m) {
    std::string run;
    for (std::string const& folder : m.from) {
        std::string const text = noted_run(folder);
        if (text.empty())
            refuse("{}: expected the --out folder of {} study --part, found no .trials/run.json there",
                   printable(folder, 200), program_name());
        if (run.empty()) run = text;
        if (text != run)
            refuse("{}: expected parts of the same run as {}: the same studies, budget and seed",
                   printable(folder, 200), printable(m.from.front(), 200));
    }
    StudyArguments const a = arguments_of(run, m.from.front(), m.out);
    merge_parts(a.chosen, a.options, {m.from.begin(), m.from.end()});
    return study_whole(a);
}

}  // namespace

Command study_command(CLI::App& app) {
    auto const st = std::make_shared<StudyArguments>();
    CLI::App* const studying =
        app.add_subcommand("study", "Questions with claims: tables, figures, verdicts and a report.");
    studying->footer(fmt::format(
        "One study:    {0} study {1}\n"
        "What it is:   {0} study {1} --describe\n"
        "Varied:       {0} study {1} --set FACTOR=A,B --seeds 20 --out mine\n"
        "All of them:  {0} study --all --budget full --out out\n"
        "Stopped, and started again by the same command, it goes on where it was.\n\n"
        "A claim is a verification (the code does what the formula says), a reproduction (an earlier number) or a "
        "finding (ours). It holds when its interval over the seeds lies inside its band, fails when it lies outside, "
        "and is undecided otherwise. {2}\n\n"
        "Exit code: 0 no verdict changed against the record and no verification fails; 1 otherwise; 2 the study could "
        "not be run.",
        program_name(), studies::studies().front()->name,
        recorded(Budget::quick).empty()
            ? "Verdicts are compared with the record that --against names."
            : "The verdicts of seed 1 are recorded in the tree (studies/verdicts.json, studies/verdicts-full.json) and "
              "in this program."));
    CLI::Validator const known_budget(
        [](std::string& text) {
            return text == "quick" || text == "full"
                       ? ""
                       : fmt::format("expected quick or full, found \"{}\"", printable(text));
        },
        "");
    define(*studying,
           {{"NAME", st->names, "", fmt::format("names of studies, as {} list shows them", program_name())},
            {"--all", st->all, "every study"},
            {"--describe", st->describe,
             "do not run it: its question, factors with their values, measures, claims, and the time it takes"},
            OptionRow("--set", st->set, "FACTOR=A,B",
                      "other values for a factor (--describe has them); may be given for several. Claims are then not "
                      "judged")
                .repeated(),
            {"--seeds", st->options.seeds, "N", whole(1, 100000), "so many replicates; claims are then not judged"},
            OptionRow("--budget", st->budget, "quick|full", known_budget,
                      "quick: seconds a study; full: minutes, for numbers to quote; default quick")
                .last()});
    define_run(*studying, *st, "of all random data; default 1",
               fmt::format(", or into folders for {} merge", program_name()).c_str());
    define(
        *studying,
        {OptionRow("--record", st->record, "FILE",
                   "write the record with the verdicts of this run to FILE, as studies/verdicts.json is")
             .last(),
         OptionRow("--against", st->against, "FILE", named("a file"),
                   "compare the verdicts with those in FILE: a record that --record wrote, or the verdicts.json of a "
                   "folder of --out; default: this program's own record")
             .last()});
    return {studying, [st] { return run_study(*st); }};
}

Command merge_command(CLI::App& app) {
    auto const mt = std::make_shared<MergeArguments>();
    CLI::App* const merging =
        app.add_subcommand("merge", "Parts of a run of studies put together: tables, figures, verdicts and a report.");
    merging->footer(fmt::format(
        "Four machines:  {0} study --all --budget full --part 1/4 --out part1    and so on, to part4\n"
        "Then:           {0} merge part1 part2 part3 part4 --out out\n"
        "The bytes are those of one run on one machine. Parts that share a folder need no merging: the command without "
        "--part makes the tables there.\n\n"
        "Exit code: as of {0} study; 2 if a trial is missing, or the parts are of different programs, studies, budgets "
        "or seeds.",
        program_name()));
    define(*merging, {OptionRow("DIR", mt->from, "", named("folders"), "the --out folders of the parts").required(),
                      OptionRow("--out", mt->out, "DIR", named("a folder"),
                                "folder for tables, figures and the report; default: out")
                          .last()});
    return {merging, [mt] { return run_merge(*mt); }};
}

}  // namespace rlslab::program
