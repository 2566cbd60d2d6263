// The rlslab program: list what there is, compare variants on data, run studies.
#include "compare.hpp"
#include "journal.hpp"
#include "report.hpp"

#include <rlslab/model/regression.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <unistd.h>

namespace {

using namespace rlslab;

/// A whole number in [least, most], else one line that says so.
CLI::Validator whole(long least, long most) {
    return {[=](std::string& text) {
                long value = 0;
                auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                bool const good = error == std::errc() && end == text.data() + text.size() && least <= value && value <= most;
                return good ? "" : fmt::format("expected a whole number from {} to {}, found \"{}\"", least, most, printable(text));
            },
            ""};
}

/// A finite number that `holds`, else one line that says what was expected.
CLI::Validator real(char const* expected, bool (*holds)(double)) {
    return {[=](std::string& text) {
                double value = 0;
                auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
                bool const good = error == std::errc() && end == text.data() + text.size() && std::isfinite(value) && holds(value);
                return good ? "" : fmt::format("expected {}, found \"{}\"", expected, printable(text));
            },
            ""};
}

/// The whole answer, or an error: a closed pipe is one too.
void print(std::string const& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw InputError(fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

/// "comparing  42 %, 3 min left" on a terminal's or a log's stderr, from the second second on.
Progress progress_after_a_second(std::string doing) {
    auto const start = std::chrono::steady_clock::now();
    bool const terminal = isatty(STDERR_FILENO);
    return [start, terminal, doing, shown = -1](double part) mutable {
        int const percent = int(100 * part), step = terminal ? 1 : 25;
        double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (seconds < 1 || percent / step == shown / step) return;
        shown = percent;
        double const left = part > 0 ? seconds * (1 - part) / part : 0;
        std::string const line = fmt::format("{} {:3} %{:<14}", doing, percent,
                                             left < 5 ? "" : left < 90 ? fmt::format(", {:.0f} s left", left)
                                                                       : fmt::format(", {:.0f} min left", left / 60));
        std::string const blank(line.size(), ' ');
        if (!terminal)
            std::fprintf(stderr, "%s\n", line.c_str());
        else if (percent == 100)
            std::fprintf(stderr, "\r%s\r", blank.c_str());
        else
            std::fprintf(stderr, "\r%s", line.c_str());
    };
}

struct CompareArguments {
    std::string file, input, output;
    std::vector<std::string> regressors;
    int order = 0, na = -1, nb = -1, delay = 0;
    bool intercept = false, json = false, csv = false;
    CompareOptions options;
};

/// The records the options describe; reads the file once the options make sense.
Records records_of(CompareArguments const& a) {
    if (a.file.empty()) throw InputError("FILE: expected the name of a file");
    if (a.output.empty()) throw InputError("--output: expected the name of the output column");
    if (!a.regressors.empty()) {
        if (!a.input.empty() || a.order || a.na >= 0 || a.nb >= 0 || a.delay)
            throw InputError("--regressors: does not go with --input, --order, --na, --nb or --delay");
        std::vector<std::string> columns = a.regressors;
        columns.push_back(a.output);
        return linear_records(read_columns(a.file, columns), a.regressors, a.output, a.intercept);
    }
    if (a.input.empty()) throw InputError("--input: expected the name of the input column (or --regressors a,b,c)");
    if (a.order && (a.na >= 0 || a.nb >= 0)) throw InputError("--order: does not go with --na and --nb");
    if (!a.order && (a.na < 0 || a.nb < 0)) throw InputError("--order: expected an order (or --na and --nb)");
    Arx model = a.order ? arx_of_order(a.order) : Arx{.na = a.na, .nb = a.nb};
    model.delay = a.delay;
    model.intercept = a.intercept;
    return arx_records(read_columns(a.file, {a.input, a.output}), a.input, a.output, model);
}

void run_compare(CompareArguments const& a) {
    if (a.json && a.csv) throw InputError("--json: does not go with --csv");
    Comparison const comparison = compare(records_of(a), a.options, progress_after_a_second("comparing"));
    bool const colour = isatty(STDOUT_FILENO) && !std::getenv("NO_COLOR");
    print(a.json ? as_json(comparison) : a.csv ? as_csv(comparison) : as_table(comparison, colour));
}

struct StudyArguments {
    std::vector<std::string> names;
    bool all = false, fresh = false;
    std::string budget = "quick", out = "out";
    RunOptions options;
};

/// 1 if a claim failed.
int run_study(StudyArguments a) {
    std::vector<Study const*> chosen;
    std::vector<std::string_view> known;
    for (Study const* study : studies()) known.push_back(study->name);
    for (std::string const& name : a.names)
        if (std::ranges::find(known, name) == known.end())
            throw InputError(fmt::format("study: expected one of {}, found \"{}\"", fmt::join(known, ", "), printable(name)));
    if (a.all == !a.names.empty()) throw InputError("study: expected the names of studies (rlslab list), or --all");
    for (Study const* study : studies())
        if (a.all || std::ranges::find(a.names, study->name) != a.names.end()) chosen.push_back(study);
    a.options.budget = a.budget == "full" ? Budget::full : Budget::quick;
    a.options.out = a.out;
    std::error_code nothing_there;
    if (a.fresh) std::filesystem::remove_all(a.options.out / ".trials", nothing_there);
    std::vector<Outcome> const outcomes = run_studies(chosen, a.options, progress_after_a_second("studying"));
    std::filesystem::create_directories(a.options.out / "figures");
    for (Outcome const& outcome : outcomes)
        for (Figure const& figure : figures(*outcome.study, outcome.table))
            replace_file(a.options.out / "figures" / (figure.name + ".gp"), gnuplot_script(figure));
    replace_file(a.options.out / "verdicts.json", verdicts_json(outcomes, a.options));
    replace_file(a.options.out / "report.html", report_html(outcomes, a.options));
    bool const colour = isatty(STDOUT_FILENO) && !std::getenv("NO_COLOR");
    std::string text;
    size_t failed = 0, claims = 0;
    for (Outcome const& outcome : outcomes) {
        text += verdict_lines(outcome, colour) + '\n';
        claims += outcome.findings.size();
        for (Finding const& finding : outcome.findings) failed += !finding.holds;
    }
    text += fmt::format("{} of {} claims hold; tables, figures and the report are in {}\n", claims - failed, claims, a.out);
    print(text);
    return failed ? 1 : 0;
}

void run_list(bool json) {
    nlohmann::ordered_json out = {{"variants", nlohmann::ordered_json::array()},
                                  {"arithmetics", nlohmann::ordered_json::array()},
                                  {"studies", nlohmann::ordered_json::array()}};
    std::string text = "variants                  propagates    no prior  rows at once  in\n";
    std::vector<Entry const*> variants;
    for (Entry const& e : catalogue())
        if (std::none_of(variants.begin(), variants.end(), [&](Entry const* v) { return v->variant == e.variant; }))
            variants.push_back(&e);
    for (Entry const* v : variants) {
        std::vector<std::string_view> in;
        for (Entry const& e : catalogue())
            if (e.variant == v->variant) in.push_back(e.arithmetic->name);
        text += fmt::format("  {:<23} {:<13} {:<9} {:<13} {}\n", v->variant, v->propagates,
                            v->starts_without_prior ? "yes" : "no", v->block,
                            in.size() == arithmetics().size() ? "every arithmetic" : fmt::format("{}", fmt::join(in, ", ")));
        out["variants"].push_back({{"name", v->variant},
                                   {"propagates", v->propagates},
                                   {"starts_without_prior", v->starts_without_prior},
                                   {"rows_at_once", v->block},
                                   {"arithmetics", in}});
    }
    text += "\narithmetics               bits  digits  exponents                      rounding\n";
    for (Arithmetic const& s : arithmetics()) {
        char const* const rounding = s.stochastic ? "stochastic" : "nearest";
        text += fmt::format("  {:<23} {:>4}  {:>6.1f}  {:<29}  {}\n", s.name, s.digits, s.decimal_digits(),
                            fmt::format("{} ... {}", s.min_exp, s.max_exp), rounding);
        out["arithmetics"].push_back({{"name", s.name},
                                      {"digits", s.digits},
                                      {"min_exp", s.min_exp},
                                      {"max_exp", s.max_exp},
                                      {"rounding", rounding}});
    }
    text += "\nstudies\n";
    for (Study const* study : studies()) {
        text += fmt::format("  {:<23} {}\n", study->name, study->question);
        out["studies"].push_back({{"name", study->name}, {"question", study->question}});
    }
    print(json ? out.dump(2) + '\n' : text);
}

int run(int argc, char** argv) {
    CLI::App app("Which variant of recursive least squares can you trust, on your data, in your arithmetic, at what price?",
                 "rlslab");
    app.set_version_flag("--version", "rlslab " RLSLAB_VERSION);

    CompareArguments a;
    CLI::App* const comparing = app.add_subcommand("compare", "Every variant in every arithmetic on a record.");
    comparing->footer("An ARX model of order 4:  rlslab compare data.csv --input u --output y --order 4\n"
                      "A plain regression:       rlslab compare data.csv --regressors one,x1,x2 --output y --json");
    comparing->add_option("FILE", a.file, "CSV file (-: standard input); empty, NA, N/A, NaN, null, . and ? are missing values")->required()->type_name("");
    comparing->add_option("--input", a.input, "column of the input u of an ARX model")->type_name("COLUMN");
    comparing->add_option("--output", a.output, "column of the output y")->required()->type_name("COLUMN");
    auto const count = [&](char const* name, int& into, long least, long most, char const* help) {
        CLI::Option* const option = comparing->add_option(name, into, help)->check(whole(least, most));
        option->type_name("N");
    };
    count("--order", a.order, 1, 1000, "ARX order: na = nb = N");
    count("--na", a.na, 0, 1000, "past outputs in the ARX model");
    count("--nb", a.nb, 0, 1000, "past inputs besides the first, u[k-delay] ... u[k-delay-nb]");
    count("--delay", a.delay, 0, 1000000, "samples from input to output");
    auto const names = [&](char const* name, std::vector<std::string>& into, char const* help) {
        // One word each: a list must not swallow FILE behind it.
        comparing->add_option(name, into, help)->delimiter(',')->allow_extra_args(false)->type_name("A,B");
    };
    names("--regressors", a.regressors, "columns of a plain regression, instead of --input and an order");
    comparing->add_flag("--intercept", a.intercept, "a constant regressor besides");
    comparing->add_option("--forgetting", a.options.forgetting, "forgetting factor, in (0, 1]; default 1")
        ->check(real("a number in (0, 1]", [](double x) { return 0 < x && x <= 1; }))->type_name("LAMBDA");
    comparing->add_option("--p0", a.options.p0, "c^2 of the prior covariance P0 = c^2 I; default 2^14 = 16384")
        ->check(real("a positive, finite number", [](double x) { return 0 < x; }))->type_name("C2");
    names("--variants", a.options.variants, "only these (rlslab list)");
    names("--arithmetic", a.options.arithmetics, "only these (rlslab list)");
    comparing->add_option("--seed", a.options.seed, "of stochastic rounding; default 1")
        ->check(whole(0, std::numeric_limits<long>::max()))->type_name("N");
    count("--threads", a.options.threads, 1, 4096, "default: all cores; the results are the same");
    comparing->add_flag("--json", a.json, "JSON instead of the table");
    comparing->add_flag("--csv", a.csv, "CSV instead of the table");
    comparing->add_flag_callback("--no-timings", [&a] { a.options.timings = false; },
                                 "leave out nanoseconds, the only column that differs from run to run");

    StudyArguments st;
    CLI::App* const studying = app.add_subcommand("study", "Questions with claims: tables, figures, verdicts and a report.");
    studying->footer("Exit code 1 when a claim fails. Killed and started again it goes on where it was.\n"
                     "Example:  rlslab study --all --budget full --out out");
    studying->add_option("NAME", st.names, "studies (rlslab list)")->type_name("");
    studying->add_flag("--all", st.all, "every study");
    studying->add_option("--budget", st.budget, "quick: seconds each; full: what is quoted; default quick")
        ->check([](std::string const& text) {
            return text == "quick" || text == "full" ? "" : fmt::format("expected quick or full, found \"{}\"", printable(text));
        })->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)->type_name("quick|full");
    studying->add_option("--seed", st.options.seed, "of all random data; default 1")
        ->check(whole(0, std::numeric_limits<long>::max()))->type_name("N");
    studying->add_option("--threads", st.options.threads, "default: all cores; no byte of a table depends on it")
        ->check(whole(1, 4096))->type_name("N");
    studying->add_option("--out", st.out, "folder for tables, figures and the report; default out")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)->type_name("DIR");
    studying->add_flag("--fresh", st.fresh, "run finished trials again");

    bool list_json = false;
    CLI::App* const listing = app.add_subcommand("list", "Variants, arithmetics, studies.");
    listing->add_flag("--json", list_json, "JSON");

    try {
        app.parse(argc, argv);
    } catch (CLI::Success const& success) {
        std::ostringstream text;
        app.exit(success, text, text);
        print(text.str());
        return 0;
    } catch (CLI::ExtrasError const&) {
        std::string const word = app.remaining(true).empty() ? "" : printable(app.remaining(true).front());
        throw InputError((word.starts_with("-") ? fmt::format("no option \"{}\"", word)
                                                : fmt::format("\"{}\" is one word too many", word)) +
                         " (rlslab --help, rlslab compare --help)");
    } catch (CLI::ParseError const& error) {
        throw InputError(printable(error.what(), 200));
    }
    if (comparing->parsed())
        run_compare(a);
    else if (studying->parsed())
        return run_study(st);
    else if (listing->parsed())
        run_list(list_json);
    else
        throw InputError("expected a subcommand: compare, study or list (rlslab --help tells more)");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);    // a closed pipe is then an error like any other, not a silent death
    try {
        return run(argc, argv);
    } catch (std::bad_alloc const&) {
        std::fputs("rlslab: out of memory\n", stderr);
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab: %s\n", error.what());
    }
    return 2;
}
