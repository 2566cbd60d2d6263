// Other values for factors; the study in words.
#include <rlslab/core/input_error.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>
#include <rlslab/studies/factors.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/verdicts.hpp>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>

namespace rlslab::studies {
namespace {

constexpr std::string_view replicates = "replicate";

std::string texts(std::vector<Cell> const& values) {
    std::string out;
    for (Cell const& value : values) out += (out.empty() ? "" : ", ") + as_text(value);
    return out;
}
/// "1 ... 40" for what counts; of many values the first and the last.
std::string range_of(std::vector<Cell> const& values) {
    bool counts = values.size() > 3;
    for (size_t i = 0; counts && i < values.size(); ++i)
        counts = std::holds_alternative<double>(values[i]) && std::get<double>(values[i]) == double(i + 1);
    if (counts) return fmt::format("1 ... {}", values.size());
    if (values.size() <= 12) return texts(values);
    return fmt::format("{}, {} ... {} ({} values)", as_text(values[0]), as_text(values[1]), as_text(values.back()),
                       values.size());
}

bool all_words(std::vector<Cell> const& values) {
    return std::ranges::all_of(values, [](Cell const& c) { return std::holds_alternative<std::string>(c); });
}
bool all_numbers(std::vector<Cell> const& values, bool (*holds)(double)) {
    return std::ranges::all_of(
        values, [&](Cell const& c) { return std::holds_alternative<double>(c) && holds(std::get<double>(c)); });
}

/// The values that a study gives a factor at either budget.
std::vector<Cell> own_values(Study const& study, std::string const& name) {
    std::vector<Cell> out;
    for (Budget const budget : {Budget::quick, Budget::full})
        for (Factor const& factor : study.factors(budget))
            if (factor.name == name)
                for (Cell const& value : factor.values)
                    if (std::ranges::find(out, value) == out.end()) out.push_back(value);
    return out;
}

/// The words that a factor may have.
std::vector<std::string> admitted_words(std::vector<Cell> const& own, RunOptions const& options) {
    std::vector<std::string> out, variants, arithmetics;
    for (Cell const& value : own)
        if (std::holds_alternative<std::string>(value)) out.push_back(std::get<std::string>(value));
    auto const add = [](std::vector<std::string>& list, std::string_view name) {
        if (std::ranges::find(list, name) == list.end()) list.emplace_back(name);
    };
    for (CatalogueEntry const& e : *options.entries) add(variants, e.variant), add(arithmetics, e.arithmetic->name);
    for (std::vector<std::string> const* known : {&variants, &arithmetics})
        if (std::ranges::all_of(out, [&](auto const& word) { return std::ranges::find(*known, word) != known->end(); }))
            return *known;
    return out;
}

double number_of(std::string const& study, std::string const& factor, std::string const& text,
                 std::vector<Cell> const& own) {
    double value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    bool const number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
    constexpr std::string_view no_counts[] = {"lambda", "forgetting", "kappa", "P0", "c2"};  // though 1 or 100 is one
    bool const forgets = factor == "lambda" || factor == "forgetting";
    bool const whole = std::ranges::find(no_counts, factor) == std::end(no_counts) &&
                       all_numbers(own, [](double x) { return x == std::floor(x); });
    constexpr double most = 1e9;  // of a count
    double least = INFINITY;      // fewer rows or parameters than the study was made for may not be a problem at all
    if (whole)
        for (Cell const& cell : own) least = std::min(least, std::get<double>(cell));
    bool const positive = forgets || all_numbers(own, [](double x) { return x > 0; });
    bool const at_least_0 = positive || all_numbers(own, [](double x) { return x >= 0; });
    bool const below_1 = !whole && all_numbers(own, [](double x) { return x < 1; });
    bool const at_most_1 = forgets || (!whole && all_numbers(own, [](double x) { return x <= 1; }));
    if (number && (!whole || (value == std::floor(value) && value >= least && value <= most)) &&
        (!positive || value > 0) && (!at_least_0 || value >= 0) && (!at_most_1 || value <= 1) &&
        (!below_1 || value < 1))
        return value;
    throw InputError(fmt::format("--set {}: study {} has {} there: expected {}{}{}, found \"{}\"", factor, study,
                                 range_of(own), whole ? fmt::format("whole numbers from {} to 1e9", least) : "numbers",
                                 whole        ? ""
                                 : positive   ? " above 0"
                                 : at_least_0 ? " of at least 0"
                                              : "",
                                 below_1     ? ", below 1"
                                 : at_most_1 ? ", at most 1"
                                             : "",
                                 printable(text)));
}

Cell value_of(Study const& study, std::string const& factor, std::string const& text, RunOptions const& options) {
    std::vector<Cell> const own = own_values(study, factor);
    bool const a_word = std::ranges::any_of(own, [&](Cell const& c) { return as_text(c) == text; });
    if (!all_words(own) && !a_word) return number_of(study.name, factor, text, own);
    for (Cell const& value : own)
        if (as_text(value) == text) return value;
    bool const arithmetics_alone = std::ranges::all_of(own, [](Cell const& cell) {
        return std::ranges::find(arithmetics(), as_text(cell), &Arithmetic::name) != arithmetics().end();
    });
    if (arithmetics_alone)
        if (std::vector<CatalogueEntry> const* const at_run_time = entries_at_run_time(text, "--set " + factor))
            return std::string(at_run_time->front().arithmetic->name);
    std::vector<std::string> const words = admitted_words(own, options);
    expect_one_of(std::vector<std::string_view>(words.begin(), words.end()), text, "--set " + factor, "value");
    return text;
}

/// Throws InputError for a column that would be there twice, and for a factor without values or with one twice.
void expect_a_table(Study const& study, std::vector<Factor> const& factors) {
    auto const refuse = [&](std::string const& what) {
        throw InputError(fmt::format("study {}: {}", study.name, what));
    };
    std::vector<std::string> columns;
    for (Factor const& factor : factors) {
        columns.push_back(factor.name);
        if (factor.values.empty()) refuse(fmt::format("factor \"{}\" has no values", printable(factor.name)));
        for (auto value = factor.values.begin(); value != factor.values.end(); ++value)
            if (std::find(factor.values.begin(), value, *value) != value)
                refuse(fmt::format("factor \"{}\" has {} twice", printable(factor.name), as_text(*value)));
    }
    columns.insert(columns.end(), study.measures.begin(), study.measures.end());
    for (auto column = columns.begin(); column != columns.end(); ++column)
        if (std::find(columns.begin(), column, *column) != column)
            refuse(fmt::format("two factors or measures have the name \"{}\"", printable(*column)));
}

}  // namespace

FactorValues factor_values_from(std::string const& text, std::string_view option) {
    size_t const equals = std::min(text.find('='), text.size());
    FactorValues out{text.substr(0, equals), {}};
    for (size_t from = equals + 1; from <= text.size();) {
        size_t const to = std::min(text.find(',', from), text.size());
        out.values.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    if (out.name.empty() || out.values.empty() || std::ranges::find(out.values, "") != out.values.end())
        throw InputError(fmt::format("{}: expected FACTOR=VALUE[,VALUE], found \"{}\"", option, printable(text)));
    return out;
}

std::vector<Factor> factors_of(Study const& study, RunOptions const& options) {
    std::vector<Factor> out = study.factors(options.budget);
    expect_a_table(study, out);
    std::vector<std::string_view> names;
    for (Factor const& factor : out) names.push_back(factor.name);
    for (auto const& [name, values] : options.set) {
        auto const found = std::ranges::find(out, name, &Factor::name);
        if (found == out.end())
            throw InputError(fmt::format("--set: study {} has no factor \"{}\"; its factors are {}", study.name,
                                         printable(name), fmt::join(names, ", ")));
        found->values.clear();
        for (std::string const& text : values) {
            Cell const value = value_of(study, name, text, options);
            if (std::ranges::find(found->values, value) != found->values.end())
                throw InputError(fmt::format("--set {}: {} is there twice", name, as_text(value)));
            found->values.push_back(value);
        }
    }
    if (options.seeds > 0) {
        if (std::ranges::find(options.set, replicates, &FactorValues::name) != options.set.end())
            throw InputError(fmt::format("--seeds: expected no --set {} beside it", replicates));
        auto const found = std::ranges::find(out, replicates, &Factor::name);
        if (found == out.end())
            throw InputError(
                fmt::format("--seeds: study {} has no factor \"{}\": its data are fixed; its factors are {}",
                            study.name, replicates, fmt::join(names, ", ")));
        found->values = counted(options.seeds);
    }
    return out;
}

std::string changes_of(RunOptions const& options) {
    std::string out;
    for (auto const& [name, values] : options.set)
        out += fmt::format("{}{} = {}", out.empty() ? "" : "; ", name, fmt::join(values, ", "));
    if (options.seeds > 0) out += fmt::format("{}{} = 1 ... {}", out.empty() ? "" : "; ", replicates, options.seeds);
    return out;
}
std::string words_of_changes(RunOptions const& options) {
    std::vector<std::string> words;
    for (auto const& [name, values] : options.set) {
        words.push_back("--set");
        words.push_back(fmt::format("{}={}", name, fmt::join(values, ",")));
    }
    if (options.seeds > 0) {
        words.push_back("--seeds");
        words.push_back(fmt::format("{}", options.seeds));
    }
    return report::shell_text(words);
}

std::string described(Study const& study, size_t width) {
    auto const line = [&](std::string_view head, std::string const& text) {
        return fmt::format("{:<12}{}\n", head, wrapped(text, 12, 12, width));
    };
    std::string out = fmt::format("{}\n", study.name) + line("question", study.question) + line("source", study.source);
    if (!study.data.empty()) out += line("data", study.data);
    std::vector<Factor> const quick = study.factors(Budget::quick), full = study.factors(Budget::full);
    out += "factors\n";
    for (Factor const& factor : full) {
        auto const at_quick = std::ranges::find(quick, factor.name, &Factor::name);
        std::string text = range_of(factor.values);
        if (at_quick != quick.end() && at_quick->values != factor.values)
            text += fmt::format("; quick: {}", range_of(at_quick->values));
        size_t const name = std::max<size_t>(20, factor.name.size() + 1);
        out += fmt::format("  {:<{}}{}\n", factor.name, name, wrapped(text, name + 2, 22, width));
    }
    out += line("measures", fmt::format("{}", fmt::join(study.measures, ", ")));
    out += "claims\n";
    for (Claim const& claim : study.claims) {
        out += fmt::format("  {}\n", wrapped(claim.text, 2, 4, width));
        std::string const proof = claim.basis.proof.empty() ? "" : "; proof: " + claim.basis.proof;
        out += "    " +
               wrapped(fmt::format("{}; band: {}{}", name_of(claim.basis.kind), claim.basis.band, proof), 4, 4, width) +
               '\n';
    }
    return out;
}

// How long a run takes: some trials, run in a child process that can be stopped at any time.
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

/// Runs trials that lie evenly over all of them and writes the seconds of each; the parent reads as long as it wants.
[[noreturn]] void run_some(Study const& study, std::vector<Trial> const& trials, int to) {
    constexpr size_t golden = 0x9e3779b97f4a7c15;  // its multiples modulo the number of trials spread evenly
    for (size_t i = 0; i < trials.size(); ++i) {
        Trial const& trial = trials[(i * golden >> 32) * trials.size() >> 32];  // of fewer than 2^32
        TrialOutput out(trial);
        auto const start = Clock::now();
        try {
            study.measure(trial, out);
        } catch (std::exception const&) {
            break;
        }
        double const took = seconds_since(start);
        if (write(to, &took, sizeof took) != ssize_t(sizeof took)) break;
    }
    _exit(0);
}

}  // namespace

TimeEstimate estimated_time(Study const& study, RunOptions const& options, double seconds) {
    std::vector<Factor> const factors = factors_of(study, options);
    std::vector<Trial> const trials = trials_of(study, factors, options);
    TimeEstimate out{.trials = trials.size(), .of_one = seconds};
    int ends[2];
    if (trials.empty() || pipe(ends) != 0) return out;
    pid_t const child = fork();
    if (child == 0) {
        close(ends[0]);
        run_some(study, trials, ends[1]);
    }
    close(ends[1]);
    double sum = 0, took = 0;
    auto const start = Clock::now();
    for (double left = seconds; child > 0 && left > 0; left = seconds - seconds_since(start)) {
        pollfd one{.fd = ends[0], .events = POLLIN, .revents = 0};
        if (poll(&one, 1, int(1000 * left) + 1) <= 0 || read(ends[0], &took, sizeof took) != ssize_t(sizeof took))
            break;
        sum += took, ++out.tried;
    }
    close(ends[0]);
    if (child > 0) {
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
    }
    if (out.tried > 0) out.of_one = sum / double(out.tried);
    return out;
}

}  // namespace rlslab::studies
