// All trials of all studies in one parallel loop; tables are put together in the order of the factors.
#include "studies/engine/run.hpp"

#include "studies/engine/journal.hpp"
#include "studies/engine/revision.hpp"

#include <rlslab/core/input_error.hpp>

#include <fmt/format.h>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tbb/parallel_for_each.h>
#include <tbb/task_arena.h>

namespace rlslab {

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

Entry const& Trial::entry(std::string_view variant, std::string_view arithmetic) const {
    if (Entry const* const entry = find_entry(*entries_, variant, arithmetic)) return *entry;
    throw std::logic_error(fmt::format("study {}: no {} in {}", study_, variant, arithmetic));
}

bool Outcome::holds() const {
    return std::ranges::all_of(findings, [](Finding const& finding) { return finding.holds; });
}

namespace {

std::string_view name_of(Budget budget) { return budget == Budget::quick ? "quick" : "full"; }

/// Identifies the program: results of another program are not mixed with its own.
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
    return {fmt::format("study: {}", study.name),
            fmt::format("question: {}", study.question),
            fmt::format("source: {}", study.source),
            fmt::format("revision: {} {}", RLSLAB_VERSION, revision),
            fmt::format("compiler: {}", compiler),
            fmt::format("command: rlslab study {} --budget {} --seed {}", study.name, name_of(options.budget), options.seed)};
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

void start(Running& run, RunOptions const& options) {
    Study const& study = *run.study;
    run.factors = study.factors(options.budget);
    for (auto& values : combinations(run.factors)) {
        Trial const trial(study.name, run.factors, std::move(values), options.seed, *options.entries, options.budget);
        if (!study.admits || study.admits(trial)) run.trials.push_back(trial);
    }
    run.lines.resize(run.trials.size());
    run.done.assign(run.trials.size(), false);
    std::string key = fmt::format("{} {} {:016x}", run.trials.size(), fmt::join(provenance(study, options), "\n"), identity());
    for (Entry const& e : *options.entries) key += fmt::format(" {}/{}", e.variant, e.arithmetic->name);
    run.journal = std::make_unique<Journal>(options.out / ".trials" / study.name, key);
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
    Outcome out{&study, Table(columns), {}, provenance(study, options), run.trials.size(), run.resumed};
    std::string csv;
    for (std::string const& line : out.provenance) csv += "# " + line + '\n';
    csv += fmt::format("{}\n", fmt::join(columns, ","));
    for (auto const& lines : run.lines)
        for (std::string const& line : lines) {
            csv += line + '\n';
            out.table.add_line(line);
        }
    replace_file(options.out / (study.name + ".csv"), csv);
    for (Claim const& claim : study.claims) out.findings.push_back(claim.holds(out.table));
    return out;
}

}  // namespace

std::vector<Outcome> run_studies(std::vector<Study const*> const& chosen, RunOptions const& options, Progress const& progress) {
    create_folder(options.out);
    create_folder(options.out / ".trials");

    std::vector<Running> running(chosen.size());
    std::vector<std::pair<Running*, size_t>> pending;
    size_t all = 0;
    for (size_t i = 0; i < chosen.size(); ++i) {
        running[i].study = chosen[i];
        start(running[i], options);
        all += running[i].trials.size();
        for (size_t k = 0; k < running[i].trials.size(); ++k)
            if (!running[i].done[k]) pending.emplace_back(&running[i], k);
    }

    std::mutex one_at_a_time;
    size_t const to_do = pending.size();
    size_t done = 0;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        tbb::parallel_for_each(pending.begin(), pending.end(), [&](std::pair<Running*, size_t> const& work) {
            auto const [run, k] = work;
            TrialOutput measured(run->trials[k]);
            try {
                run->study->measure(run->trials[k], measured);
            } catch (std::exception const& failure) {
                throw std::runtime_error(
                    fmt::format("study {}, trial {}: {}", run->study->name, csv_line(run->trials[k].values()), failure.what()));
            }
            std::lock_guard const lock(one_at_a_time);
            run->lines[k] = measured.lines();
            run->journal->add(k, measured.lines());
            if (progress) progress(double(++done) / double(to_do));
        });
    });

    std::vector<Outcome> out;
    for (Running const& run : running) out.push_back(finish(run, options));
    return out;
}

std::string verdict_lines(Outcome const& outcome, bool colour) {
    auto const painted = [&](std::string_view text, int code) {
        return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
    };
    std::string out = fmt::format("{}  {}\n", painted(outcome.study->name, 1), outcome.study->question);
    for (size_t i = 0; i < outcome.findings.size(); ++i) {
        Finding const& finding = outcome.findings[i];
        out += fmt::format("  {}  {}: {}\n", finding.holds ? painted("holds", 32) : painted("FAILS", 31), outcome.study->claims[i].text,
                           finding.measured);
    }
    return out;
}

std::string verdicts_json(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    using Json = nlohmann::ordered_json;
    Json out = {{"version", RLSLAB_VERSION},
                {"revision", revision},
                {"budget", name_of(options.budget)},
                {"seed", options.seed},
                {"studies", Json::array()}};
    for (Outcome const& outcome : outcomes) {
        Json claims = Json::array();
        for (size_t i = 0; i < outcome.findings.size(); ++i) {
            Claim const& claim = outcome.study->claims[i];
            claims.push_back({{"claim", claim.text},
                              {"source", claim.source.empty() ? outcome.study->source : claim.source},
                              {"holds", outcome.findings[i].holds},
                              {"measured", outcome.findings[i].measured}});
        }
        out["studies"].push_back(
            {{"name", outcome.study->name}, {"question", outcome.study->question}, {"holds", outcome.holds()}, {"claims", claims}});
    }
    return out.dump(2) + '\n';
}

}  // namespace rlslab
