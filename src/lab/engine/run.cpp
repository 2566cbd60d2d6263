// All trials of all studies in one parallel loop; tables are put together in the order of the factors.
#include <rlslab/studies/run.hpp>

#include <rlslab/studies/factors.hpp>

#include <fmt/format.h>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>
#include <tuple>

namespace rlslab::studies {
using namespace report;

Cell const& Trial::value(std::string_view factor) const {
    for (size_t i = 0; i < factors_->size(); ++i)
        if ((*factors_)[i].name == factor) return values_[i];
    throw std::logic_error(fmt::format("study {}: no factor \"{}\"", study_, factor));
}

Seed Trial::seed(std::vector<std::string> const& factors) const {
    std::uint64_t state = hash(study_, seed_ ^ 0xcbf29ce484222325);
    for (std::string const& factor : factors) state = hash(factor + '=' + as_text(value(factor)) + ';', state);
    return Seed{Seed{state}.next()};
}

CatalogueEntry const& Trial::entry(std::string_view variant, std::string_view arithmetic) const {
    if (CatalogueEntry const* const entry = find_entry(*entries_, variant, arithmetic)) return *entry;
    if (std::vector<CatalogueEntry> const* const own = entries_at_run_time(arithmetic, "arithmetic"))
        for (CatalogueEntry const& entry : *own)
            if (entry.variant == variant) return entry;
    throw std::logic_error(fmt::format("study {}: no {} in {}", study_, variant, arithmetic));
}

bool Outcome::holds() const {
    return std::ranges::all_of(judgements, [](Judgement const& judgement) { return judgement.holds(); });
}

namespace {

std::string command_of(std::string const& names, RunOptions const& options) {
    if (options.run) return options.run->command;
    std::string const changes = words_of_changes(options);
    return fmt::format("{} study {} --budget {} --seed {}{}{}", shell_text({options.program}), names,
                       name_of(options.budget), options.seed, changes.empty() ? "" : " ", changes);
}

/// The program as it is: results of another one are not to be mixed with its own.
std::uint64_t identity() {
    static std::uint64_t const value = [] {
        std::ifstream file("/proc/self/exe", std::ios::binary);
        std::ostringstream text;
        text << file.rdbuf();
        return hash(text.str(), hash(revision));
    }();
    return value;
}

/// It does not depend on the machine, the number of threads or the folder, so that the bytes of a table do not either.
std::vector<std::string> provenance(Study const& study, RunOptions const& options) {
    std::string command = command_of(study.name, options);
    for (char& c : command)
        if (c == '\n' || c == '\r') c = ' ';  // a word of it may hold one; each of these is one line
    return {fmt::format("study: {}", study.name),    fmt::format("question: {}", study.question),
            fmt::format("source: {}", study.source), fmt::format("revision: {} {}", RLSLAB_VERSION, revision),
            fmt::format("compiler: {}", compiler),   "command: " + command};
}

/// What a study's own code throws, whatever it is, as a std::runtime_error that begins with its place.
void named_where_it_throws(std::string const& place, std::function<void()> const& own_code) {
    std::string why;
    try {
        return own_code();
    } catch (std::bad_variant_access const&) {
        why = "number() of a factor's value that is a word, or text() of a number (numbers are written without quotes)";
    } catch (std::exception const& failure) {
        why = failure.what();
    } catch (...) {
        why = "it threw what is no std::exception";
    }
    throw std::runtime_error(fmt::format("{}: {}", place, why));
}

/// Throws unless each row has a cell for each factor and measure.
void expect_cells(Study const& study, Trial const& trial, std::vector<std::string> const& lines) {
    auto const factors = std::ptrdiff_t(trial.values().size()), measures = std::ssize(study.measures);
    for (std::string const& line : lines)
        if (auto const cells = std::ranges::count(line, ',') + 1 - factors; cells != measures)
            throw std::logic_error(fmt::format("expected {} cells in a row, one for each of {}, found {}", measures,
                                               fmt::join(study.measures, ", "), cells));
}

/// The trials of one study and their results.
struct Running {
    Study const* study;
    std::vector<Factor> factors;
    std::vector<Trial> trials;
    std::vector<std::vector<std::string>> lines;
    std::vector<bool> done;
    std::unique_ptr<Journal> journal;
    size_t resumed = 0;
};

/// Every combination, the last factor fastest.
std::vector<std::vector<Cell>> combinations(std::vector<Factor> const& factors) {
    std::vector<std::vector<Cell>> out{{}};
    for (Factor const& factor : factors) {
        std::vector<std::vector<Cell>> longer;
        for (auto const& head : out)
            for (Cell const& value : factor.values) {
                longer.push_back(head);
                longer.back().push_back(value);
            }
        out = std::move(longer);
    }
    return out;
}

/// The trials; returns the journal's key.
std::string prepare(Running& run, RunOptions const& options) {
    Study const& study = *run.study;
    run.factors = factors_of(study, options);
    run.trials = trials_of(study, run.factors, options);
    run.lines.resize(run.trials.size());
    run.done.assign(run.trials.size(), false);
    std::string key =
        fmt::format("{} {} {:016x}", run.trials.size(), fmt::join(provenance(study, options), "\n"), identity());
    for (CatalogueEntry const& e : *options.entries) key += fmt::format(" {}/{}", e.variant, e.arithmetic->name);
    return key;
}

void start(Running& run, RunOptions const& options, Part part) {
    std::string const key = prepare(run, options);
    run.journal = std::make_unique<Journal>(options.out / ".trials", run.study->name, key, part);
    for (auto const& [trial, lines] : run.journal->finished())
        if (trial < run.trials.size()) {
            run.lines[trial] = lines;
            run.done[trial] = true;
            ++run.resumed;
        }
}

Outcome finish(Running const& run, RunOptions const& options) {
    Study const& study = *run.study;
    std::vector<std::string> columns;
    for (Factor const& factor : run.factors) columns.push_back(factor.name);
    columns.insert(columns.end(), study.measures.begin(), study.measures.end());
    Outcome out{&study,      Table(columns),     {}, provenance(study, options), run.trials.size(),
                run.resumed, changes_of(options)};
    std::string csv;
    for (std::string const& line : out.provenance) csv += "# " + line + '\n';
    csv += fmt::format("{}\n", fmt::join(columns, ","));
    for (auto const& lines : run.lines)
        for (std::string const& line : lines) {
            csv += line + '\n';
            out.table.add_line(line);
        }
    replace_file(options.out / (study.name + ".csv"), csv);
    if (options.changed()) {  // no verdict, and every number there is; a judge may ask for a value that was left out
        for (Claim const& claim : study.claims) try {
                out.numbers.push_back(claim.judge(out.table).measured);
            } catch (std::exception const&) {
                out.numbers.push_back("no number: it asks for other values of the factors");
            }
        return out;
    }
    for (Claim const& claim : study.claims) {
        named_where_it_throws(fmt::format("study {}: claim \"{}\"", study.name, claim.text),
                              [&] { out.judgements.push_back(claim.judge(out.table)); });
        Judgement const& judgement = out.judgements.back();
        if (judgement.proven == claim.basis.proof.empty() && (judgement.proven || judgement.verdict != Verdict::fails))
            throw std::logic_error(
                fmt::format("study {}: a proof is used or named, not both: {}", study.name, claim.text));
    }
    return out;
}

std::vector<Running> started(std::vector<Study const*> const& chosen, RunOptions const& options, Part part) {
    create_folder(options.out);
    create_folder(options.out / ".trials");
    std::vector<Running> out(chosen.size());
    for (size_t i = 0; i < chosen.size(); ++i) {
        out[i].study = chosen[i];
        start(out[i], options, part);
    }
    return out;
}

/// A trial of one of the studies.
using Work = std::pair<Running*, size_t>;

std::vector<Work> all_trials(std::vector<Running>& running) {
    std::vector<Work> out;
    for (Running& run : running)
        for (size_t k = 0; k < run.trials.size(); ++k) out.emplace_back(&run, k);
    return out;
}
std::vector<Work> unfinished(std::vector<Work> work) {
    std::erase_if(work, [](Work const& w) { return bool(w.first->done[w.second]); });
    return work;
}
std::vector<Work> dealt(std::vector<Work> work, Part part) {
    std::ranges::sort(work, {}, [](Work const& w) {
        return std::tuple(Seed{hash(w.first->study->name) + w.second}.next(), std::string_view(w.first->study->name),
                          w.second);
    });
    std::vector<Work> out;
    for (size_t i = size_t(part.number - 1); i < work.size(); i += size_t(part.of)) out.push_back(work[i]);
    return out;
}

void run_trials(std::vector<Work> const& work, RunOptions const& options, Progress const& progress) {
    std::mutex one_at_a_time;
    size_t done = 0;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        tbb::parallel_for_each(work.begin(), work.end(), [&](Work const& one) {
            Running* const run = one.first;
            size_t const k = one.second;
            TrialOutput measured(run->trials[k]);
            named_where_it_throws(
                fmt::format("study {}, trial {}", run->study->name, csv_line(run->trials[k].values())), [&] {
                    run->study->measure(run->trials[k], measured);
                    expect_cells(*run->study, run->trials[k], measured.lines());
                });
            std::lock_guard const lock(one_at_a_time);
            run->lines[k] = measured.lines();
            run->journal->add(k, measured.lines());
            if (progress) progress(double(++done) / double(work.size()));
        });
    });
}

}  // namespace

Provenance run_of(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    if (options.run) return *options.run;
    std::vector<std::string> words;
    for (Outcome const& outcome : outcomes) words.push_back(outcome.study->name);
    return {.command = command_of(words.size() == studies().size() ? "--all" : shell_text(words), options)};
}

std::string_view name_of(Budget budget) { return budget == Budget::quick ? "quick" : "full"; }

std::vector<Trial> trials_of(Study const& study, std::vector<Factor> const& factors, RunOptions const& options) {
    std::vector<Trial> out;
    for (auto& values : combinations(factors)) {
        Trial const trial(study.name, factors, std::move(values), options.seed, *options.entries, options.budget);
        if (!study.admits || study.admits(trial)) out.push_back(trial);
    }
    if (out.empty() && options.changed())
        refuse("--set: study {} admits none of these combinations: {}", study.name, changes_of(options));
    return out;
}

std::vector<Outcome> run_studies(std::vector<Study const*> const& chosen, RunOptions const& options,
                                 Progress const& progress) {
    std::vector<Running> running = started(chosen, options, {});
    run_trials(unfinished(all_trials(running)), options, progress);
    std::vector<Outcome> out;
    for (Running const& run : running) out.push_back(finish(run, options));
    return out;
}

Share run_part(std::vector<Study const*> const& chosen, RunOptions const& options, Part part,
               Progress const& progress) {
    std::vector<Running> running = started(chosen, options, part);
    std::vector<Work> const all = all_trials(running), own = dealt(all, part), work = unfinished(own);
    run_trials(work, options, progress);
    return {all.size(), own.size(), own.size() - work.size()};
}

void merge_parts(std::vector<Study const*> const& chosen, RunOptions const& options,
                 std::vector<std::filesystem::path> const& folders) {
    struct Merged {
        std::string name, key;
        Trials finished;
    };
    std::optional<FolderLock> lock;  // before anything is read; what is not there yet nobody else is writing
    if (std::filesystem::is_directory(options.out)) lock.emplace(options.out);
    std::vector<std::filesystem::path> from;
    for (auto const& folder : folders) from.push_back(folder / ".trials");
    from.push_back(options.out / ".trials");
    std::vector<Merged> all;
    size_t trials = 0, missing = 0;
    std::string first;
    for (Study const* study : chosen) {
        Running run;
        run.study = study;
        std::string const key = prepare(run, options);
        all.push_back({study->name, key, finished_trials(from, study->name, key)});
        size_t found = 0;
        for (auto const& [trial, lines] : all.back().finished) found += trial < run.trials.size();
        trials += run.trials.size();
        missing += run.trials.size() - found;
        if (first.empty() && found < run.trials.size()) first = study->name;
    }
    if (missing > 0) refuse("merge: {} of {} trials are missing, the first of {}", missing, trials, first);
    create_folder(options.out / ".trials");
    if (!lock) lock.emplace(options.out);
    for (Merged const& merged : all) write_journal(options.out / ".trials", merged.name, merged.key, merged.finished);
}

}  // namespace rlslab::studies
