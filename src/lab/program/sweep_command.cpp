// rlslab sweep: the variants on a record, over values of forgetting, prior, arithmetic and model order.
#include "src/lab/program/examples.hpp"
#include "src/lab/program/study_options.hpp"
#include "src/lab/program/sweep.hpp"

#include <rlslab/core/files.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace rlslab::program {
using namespace report;
using namespace studies;
namespace {

struct SweepArguments : StudyRun {
    RecordArguments record;
    std::vector<std::string> vary;  // "forgetting=0.9,1"
    std::vector<std::string> from;  // folders of parts
    int row_orders = 1;
    SweepArguments() { out = "sweep"; }
};

Sweep sweep_of(SweepArguments const& a, Provenance& run) {
    RecordArguments const given = with_example(a.record);
    Sweep out{.vary = {}, .order = given.order, .row_orders = a.row_orders, .records = {}};
    bool orders = false;
    for (std::string const& text : a.vary) {
        FactorValues const values = factor_values_from(text, "--vary");
        if (std::ranges::find(out.vary, values.name, &FactorValues::name) != out.vary.end())
            throw InputError(fmt::format("--vary: factor \"{}\" is there twice", printable(values.name)));
        orders = orders || values.name == "order";
        out.vary.push_back(values);
    }
    if (orders && (a.record.order || a.record.na >= 0 || a.record.nb >= 0 || !given.regressors.empty()))
        throw InputError("--vary order: does not go with --order, --na, --nb or --regressors");
    out.records = [given, &run, columns = std::make_shared<std::optional<Columns>>()](int order) {
        RecordArguments record = given;
        if (order > 0) record.order = order;
        bool const first = !columns->has_value();
        Question const question = question_of(record, columns.get());
        if (first)
            for (std::string const& warning : question.model.warnings)
                tell(fmt::format("rlslab: warning: {}\n", warning));
        run.file = question.model.file, run.sha256 = question.sha256, run.rows = question.rows;
        return question.records;
    };
    return out;
}

/// What the parts of a sweep have in common.
std::string run_json(Provenance const& run) {
    nlohmann::ordered_json const out{{"sweep", run.command}, {"sha256", run.sha256}};
    return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';  // a name need not be UTF-8
}

int run_sweep(SweepArguments& a) {
    a.options.out = a.out;
    a.options.budget = Budget::full;
    if (!a.part.whole()) check_part(a);
    if (!a.part.whole() && !a.from.empty()) throw InputError("--from: does not go with --part");
    expect_no_other_run(a.out, "verdicts.json", "study");
    Provenance run{.command = this_run(false).command};
    Study study = study_of(sweep_of(a, run), a.options.seed);
    study.source = fmt::format("{}, {} rows, sha256 {}", run.file, run.rows, run.sha256);
    a.options.run = run;
    std::string const text = run_json(run);
    for (std::string const& folder : a.from)
        if (noted_run(folder) != text)
            throw InputError(
                fmt::format("--from {}: expected a folder with parts of this sweep", printable(folder, 200)));
    if (!a.from.empty()) merge_parts({&study}, a.options, {a.from.begin(), a.from.end()});
    create_folder(a.options.out / ".trials");
    if (!a.part.whole()) {
        FolderLock const lock(a.options.out, a.part);
        note_run(a, text, "another sweep, of other data, or of studies");
        tell(part_text(a, run_share({&study}, a), ""));
        return 0;
    }
    FolderLock const lock(a.options.out);
    std::vector<Outcome> const outcomes = run_whole({&study}, a);
    if (noted_run(a.out) == text) std::filesystem::remove(a.options.out / ".trials" / "run.json");  // its parts are in
    print(fmt::format("{} trials, {} rows: {out}/sweep.csv, figures, and {out}/report.html\n", outcomes[0].trials,
                      outcomes[0].table.rows().size(), fmt::arg("out", a.out)));
    return 0;
}

}  // namespace

Command sweep_command(CLI::App& app) {
    auto const a = std::make_shared<SweepArguments>();
    CLI::App* const sweeping = app.add_subcommand(
        "sweep",
        "The variants on a record, over variant, forgetting, prior, arithmetic, model order and orders of rows.");
    sweeping->footer(
        "Forgetting in two arithmetics:  rlslab sweep data.csv --input u --output y --order 4 --vary "
        "forgetting=0.9,0.99,1 --vary arithmetic=float,p11 --out sweep\n"
        "The model's order:              rlslab sweep data.csv --input u --output y --vary order=1,2,4,8\n"
        "A record of the program:        rlslab sweep --example longley --vary prior=scaled,1e4,1e8\n"
        "Stopped, and started again by the same command, it goes on where it was.\n\n"
        "Factors of --vary: variant (default all), arithmetic (float,double), forgetting (1), prior (scaled: to the "
        "data, as rlslab compare does; or c^2 of P0 = c^2 I), order (of the ARX model, in place of --order). The "
        "folder gets sweep.csv, a row for each variant and combination, figures, and report.html.\n\n"
        "Exit code: 0 it ran; 2 it could not.");
    define_record(*sweeping, a->record);
    define(*sweeping,
           {OptionRow("--vary", a->vary, "FACTOR=A,B", "values of a factor; may be given for several").repeated(),
            OptionRow("--from", a->from, "DIR",
                      "a folder with parts of this sweep, made with --part and their own --out; may be given for "
                      "several")
                .repeated(),
            {"--row-orders", a->row_orders, "N", whole(1, 10000),
             "so many orders of the rows, the record's first, where forgetting = 1; default 1"}});
    define_run(*sweeping, *a, "of stochastic rounding and of the orders of rows; default 1", "");
    return {sweeping, [a] { return run_sweep(*a); }};
}

}  // namespace rlslab::program
