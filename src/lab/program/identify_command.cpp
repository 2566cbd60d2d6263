// rlslab identify, simulate and excitation: from a record to a model, and from a model to a record.
#include "src/lab/identify/identify.hpp"
#include "src/lab/identify/text.hpp"
#include "src/lab/program/record_options.hpp"
#include "src/lab/report/json.hpp"

#include <rlslab/core/files.hpp>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>

namespace rlslab::program {
using namespace identify;
using namespace report;
namespace {

/// "1,-0.7" as numbers. Throws InputError that names the option.
std::vector<double> numbers_of(std::string const& option, std::string const& text) {
    std::vector<double> out;
    for (size_t from = 0; from <= text.size();) {
        size_t const to = std::min(text.find(',', from), text.size());
        double value = 0;
        auto const [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
        if (error != std::errc() || end != text.data() + to || !std::isfinite(value))
            refuse("{}: expected numbers with commas between, found \"{}\"", option, printable(text));
        out.push_back(value);
        from = to + 1;
    }
    return out;
}

/// The input that "prbs:10", "prbs:10:4", "white", "coloured:-0.9", "multisine:40" or "steps:5:50" describes.
Signal input_of(std::string const& text, Index samples, Seed seed) {
    std::string const name = text.substr(0, text.find(':'));
    std::vector<double> p;
    if (name.size() < text.size()) {
        std::string rest = text.substr(name.size() + 1);
        std::ranges::replace(rest, ':', ',');
        p = numbers_of("--input", rest);
    }
    auto const whole_number = [&](size_t i, double least, double most) {
        if (i >= p.size() || p[i] != std::floor(p[i]) || p[i] < least || p[i] > most)
            refuse("--input: {}: expected a whole number from {} to {}", printable(text), least, most);
        return Index(p[i]);
    };
    double const longest = double(samples);
    if (name == "white" && p.empty()) return white_noise(samples, seed);
    if (name == "prbs" && p.size() <= 2)
        return prbs(int(whole_number(0, 2, 20)), samples, p.size() > 1 ? whole_number(1, 1, longest) : 1);
    if (name == "coloured" && !p.empty()) return coloured_noise(samples, p, seed);
    if (name == "multisine" && p.size() == 1)
        return multisine(samples, int(whole_number(0, 1, std::max(1.0, std::floor((longest - 1) / 2)))));
    if (name == "steps" && p.size() == 2)
        return random_steps(samples, whole_number(0, 1, longest), whole_number(1, p[0], longest), seed);
    refuse(
        "--input: expected white, prbs:CELLS[:HOLD], coloured:A1,..., multisine:HARMONICS or "
        "steps:SHORTEST:LONGEST, found \"{}\"",
        printable(text));
}

struct IdentifyArguments {
    CsvFormat format;
    std::string file, out;
    bool json = false, keep_mean = false, dated = true;
    int na = -1;
    CompositionArguments composition;
    IdentifyOptions options;
};

int run_identify(IdentifyArguments a) {
    a.options.detrend = !a.keep_mean;
    if (a.na >= 0) a.options.na = a.na;
    a.options.composition = composition_of(a.composition, a.options.forgetting);
    DataFile file{a.file, a.format};
    a.options.regressors = names_before_lags(a.options.regressors, file);
    Identified model = identify::identify(file, a.options, progress_after_a_second("looking at the excitation"));
    model.run = this_run(a.dated, model.file, model.sha256, model.samples);
    std::string written;
    if (!a.out.empty()) {
        create_folder(a.out);
        replace_file(std::filesystem::path(a.out) / "model.json", as_json(model));
        replace_file(std::filesystem::path(a.out) / "model.html", as_page(model));
        written = fmt::format("\n{0}/model.html, {0}/model.json", printable(a.out, 200));
        if (model.tracked) {
            replace_file(std::filesystem::path(a.out) / "tracked.csv",
                         as_comments(*model.run) + tracked_csv(*model.tracked, parameter_names(model)));
            written += fmt::format(", {}/tracked.csv", printable(a.out, 200));
        }
        written += "\n";
    }
    print(a.json ? as_json(model) : as_table(model, terminal_columns()) + written);
    return model.failure || (model.tracked && model.tracked->broken > 0) ? 1 : 0;
}

struct SimulateArguments {
    std::string a, b = "1", input = "prbs:10", noise_colour;
    long samples = 1000;
    std::uint64_t seed = 1;
    int delay = 0;
    double noise = 0;
};

int run_simulate(SimulateArguments const& s) {
    if (s.delay >= s.samples)
        refuse(
            "--delay: expected less than the {} --samples: of an input that comes later the record shows "
            "nothing, found {}",
            s.samples, s.delay);
    if (!s.noise_colour.empty() && s.noise == 0) refuse("--noise-colour: expected --noise, too");
    DifferenceEquation model;
    if (!s.a.empty()) model.a = numbers_of("--a", s.a);
    model.b = {numbers_of("--b", s.b)};
    model.delay = s.delay;
    Seed seed{s.seed};
    Signal const u = input_of(s.input, s.samples, Seed{seed.next()});
    Seed const of_noise{seed.next()};
    Signal xi = s.noise_colour.empty()
                    ? white_noise(s.samples, of_noise)
                    : coloured_noise(s.samples, numbers_of("--noise-colour", s.noise_colour), of_noise);
    for (double& x : xi) x *= s.noise;
    auto const check = [](char const* option, Signal const& x, char const* what) {
        if (!std::ranges::all_of(x, [](double v) { return std::abs(v) <= largest_value; }))
            refuse("{}: the {} grows beyond 2^500: expected a stable filter, and moderate numbers", option, what);
    };
    check("--input", u, "input");
    check(s.noise_colour.empty() ? "--noise" : "--noise-colour, --noise", xi, "noise");
    Signal const y = simulate(model, {u}, xi);
    check("--a, --b", y, "output");
    auto const constant = [](Signal const& x) {
        return x.size() > 1 && std::ranges::all_of(x, [&](double v) { return v == x[0]; });
    };
    if (constant(y) && constant(u))
        refuse(
            "--samples: the input is {} over all {} of them, and nothing can be learnt from it: expected more samples, "
            "or another --input or --seed",
            u[0], u.size());
    if (constant(y))
        refuse(
            "--b: the output is {} throughout, and nothing can be learnt from it: expected numbers that "
            "pass the input on, or --noise",
            y[0]);
    if (std::ranges::all_of(y, [](double v) { return std::abs(v) < 1 / largest_value; }))
        refuse("--b: the output stays below 2^-500, where squares vanish: expected moderate numbers");
    std::string text = as_comments(this_run(false)) + "u,y\n";
    for (size_t k = 0; k < y.size(); ++k) text += fmt::format("{},{}\n", u[k], y[k]);
    print(text);
    return 0;
}

struct ExcitationArguments {
    CsvFormat format;
    std::string file, input;
    int most = 20;
    bool json = false, dated = true;
};

/// A column. Throws InputError with file, line and column where a value is missing.
Signal const& without_missing(Columns const& columns, std::string const& name) {
    Signal const& values = columns[name];
    auto const missing = std::ranges::find_if(values, [](double x) { return x != x; });
    if (missing != values.end())
        refuse("{}:{}: column \"{}\": expected a number in every row, found a missing value", columns.file,
               columns.lines[size_t(missing - values.begin())], printable(name));
    return values;
}

int run_excitation(ExcitationArguments const& a) {
    Columns const columns = read_data({a.file, a.format}, {a.input});
    Signal const& u = without_missing(columns, a.input);
    Excitation const e = excitation(u, a.most, {.progress = progress_after_a_second("looking at the excitation")});
    std::string text = fmt::format("{}: input {}, {} samples, resolution {:.3g}\n\n", printable(a.file, 200),
                                   printable(a.input), u.size(), e.resolution) +
                       "  order  least eigenvalue   kappa(U)  definite  above rounding  carried by rows\n";
    Json orders = Json::array();
    for (ExcitationOrder const& n : e.orders) {
        text += fmt::format("  {:>5}  {:>16.4g}  {:>9}  {:<8}  {:<14}  {:.0f}\n", n.order, n.least,
                            std::isfinite(n.condition) ? fmt::format("{:.3g}", n.condition) : "-",
                            n.definite ? "yes" : "no", n.resolved ? "yes" : "no", n.carried);
        orders.push_back(object("order least_eigenvalue condition definite resolved rows_that_carry",
                                {n.order, n.least, n.condition, n.definite, n.resolved, n.carried}));
    }
    if (e.constant_at_start > 0)
        text += fmt::format("\nthe input does not change over its first {} samples\n", e.constant_at_start);
    std::string const order =
        fmt::format("\nexciting of order {}{}", e.order, e.order == Index(a.most) ? " at least" : "");
    if (e.persistent < e.order)
        text += fmt::format(
            "{}, but persistently of order {} only:\n{:.0f} of {} rows carry the least eigenvalue of order {} (the "
            "input changes {}),\nand their noise decides what is identified\n",
            order, e.persistent, e.orders[size_t(e.persistent)].carried, Index(u.size()) - e.persistent,
            e.persistent + 1, e.changes == 1 ? "once" : fmt::format("{} times", e.changes));
    else if (e.order < 2) text += order + ": no dynamic model can be identified\n";
    else if (e.order == Index(a.most))
        text += fmt::format("{}: a model of order {} can be identified\n", order, e.order - 1);
    else text += fmt::format("{}: models up to order {} can be identified\n", order, e.order - 1);
    if (e.exact_order > e.order)
        text += fmt::format("(of order {} for exactly the numbers stored: beyond {} that is their rounding)\n",
                            e.exact_order, e.order);
    Json out = object("file input samples exciting_of_order exact_order persistent_order changes resolution",
                      {a.file, a.input, u.size(), e.order, e.exact_order, e.persistent, e.changes, e.resolution});
    out.update(object("constant_at_start orders", {e.constant_at_start, orders}));
    out["run"] = Json::parse(as_json(this_run(a.dated, printable(a.file, 200), columns.sha256, columns.rows())));
    print(a.json ? out.dump(2, ' ', false, Json::error_handler_t::replace) + '\n' : text);
    return e.order >= 2 ? 0 : 1;
}

}  // namespace

Command identify_command(CLI::App& app) {
    auto const a = std::make_shared<IdentifyArguments>();
    CLI::App* const c =
        app.add_subcommand("identify", "An ARX model of a record: order, parameters, and whether to believe them.");
    c->footer(
        "The model:  y[k] + a1 y[k-1] + ... + a_na y[k-na] = b0 u[k-delay] + ... + b_nb u[k-delay-nb] + c + e[k]\n"
        "(nb counts from b0: MATLAB's arx calls this [na nb+1 delay].)\n\n"
        "The order is chosen:      rlslab identify data.csv --input u --output y --max-order 8 --out model\n"
        "A structure of your own:  rlslab identify data.csv --input u,v --output y --na 2 --nb 2,3 --delay 1,0\n"
        "Any set of regressors:    rlslab identify data.csv --output y --regressors 'y[k-1],y[k-2],u[k-3..k-5]'\n"
        "A series alone:           rlslab identify data.csv --output y --order 3\n"
        "In seconds and hertz:     rlslab identify data.csv --input u --output y --sample-time 0.01 --out model\n"
        "Parameters that drift:    rlslab identify data.csv --input u --output y --order 2 --control random_walk:1e-4 "
        "--out model\n\n"
        "With --control, --window or --guard the variant also tracks theta so over all rows: at each the noise "
        "variance, theta and the prediction made before the row, with standard deviations (tracked.csv). The model "
        "above it stays that of --forgetting alone.\n\n" +
        control_notes() +
        "\n"
        "Exit code: 0 a model; 1 the variant broke down, alone or in its composition, and is named; 2 options or a "
        "record that do not make sense.");
    IdentifyOptions& o = a->options;
    OptionRow("FILE", a->file, "", named("the name of a file"), file_with_missing_values).required().define(*c);
    define_format(*c, a->format);
    define(*c,
           {{"--input", o.inputs, "U[,V]", "column of the input, or several; none: y is predicted from its own past"},
            OptionRow("--output", o.output, "COLUMN", "column of the output").required(),
            {"--order", o.order, "N", whole(1, 200), "na = nb = N instead of a choice"},
            {"--max-order", o.max_order, "N", whole(1, 200), "the largest order to choose from; default 10"},
            {"--na", a->na, "N", whole(0, 200), "past outputs, y[k-1] ... y[k-N]; with --nb, instead of a choice"},
            {"--nb", o.nb, "N[,N]", whole(0, 200), "inputs u[k-delay] ... u[k-delay-N], for all inputs or for each"},
            {"--delay", o.delay, "N[,N]", whole(0, 100000),
             "samples from input to output, for all inputs or for each; default 0"},
            time_option(o.time),
            {"--sample-time", o.sample_time, "T", real("seconds from 1e-15 to 1e15", 1e-15, 1e15),
             "seconds from one sample to the next: times in seconds, frequencies in hertz; default: in samples"},
            {"--regressors", o.regressors, "A,B",
             "a list of regressors instead: y[k-1], u[k-3], u[k-3..k-5]; inputs are what it names"},
            {"--variant", o.variant, "NAME", "of recursive least squares, in double; default ud"},
            forgetting_option(o.forgetting)});
    define_composition(*c, a->composition);
    define(*c, {prior_option(o.p0, "c^2 of a prior covariance P0 = c^2 I; default: scaled to the data, and printed"),
                {"--validate", o.validate, "PART", real("a number from 0 to 0.9", 0, 0.9),
                 "part at the end that is held out, in [0, 0.9]; default 1/3"},
                {"--confidence", o.confidence, "P", real("a number from 0.001 to 0.999999", 0.001, 0.999999),
                 "of the intervals; default 0.95"},
                {"--noise-model", o.noise_model, "N", whole(1, 200),
                 "N of the noise's C = 1 + c1 q^-1 + ... + cN q^-N: the parameters again, without the bias of "
                 "coloured residuals"},
                {"--instruments", o.instruments, "N", whole(1, 1000),
                 "the same without a model of the noise: N further past lags of each input as instruments"},
                {"--intercept", o.intercept, "a constant regressor besides"},
                {"--keep-mean", a->keep_mean, "do not take the means off first"},
                {"--json", a->json, "JSON instead of the table"}});
    define_undated(*c, a->dated);
    define(*c, {folder_option(a->out, "folder for model.html, model.json and, with a composition, tracked.csv")});
    return {c, [a] { return run_identify(*a); }};
}

Command simulate_command(CLI::App& app) {
    auto const s = std::make_shared<SimulateArguments>();
    CLI::App* const c = app.add_subcommand("simulate", "A record of a known system: columns u and y as CSV.");
    c->footer(
        "The system:  y[k] + a1 y[k-1] + ... = b0 u[k-delay] + b1 u[k-delay-1] + ... + e[k]\n"
        "Example:     rlslab simulate --a -1.5,0.7 --b 1,0.5 --noise 0.1 > data.csv\n\n"
        "Exit code: 0 a record; 2 one that grows beyond 2^500, or options that make no sense.");
    define(
        *c,
        {{"--a", s->a, "A1,...", "coefficients a1,a2,...; default none"},
         {"--b", s->b, "B0,...", "coefficients b0,b1,...; default 1"},
         {"--delay", s->delay, "N", whole(0, 100000), "samples from input to output; default 0"},
         {"--input", s->input, "SIGNAL",
          "the signal u: white, prbs:CELLS[:HOLD], coloured:A1,..., multisine:HARMONICS or "
          "steps:SHORTEST:LONGEST; default prbs:10"},
         {"--samples", s->samples, "N", whole(1, 10000000), "rows of the record; default 1000"},
         {"--noise", s->noise, "SD", real("a number of at least 0", 0), "standard deviation of the noise e; default 0"},
         {"--noise-colour", s->noise_colour, "A1,...", "colours e: it becomes the output of 1 / (1 + a1 z^-1 + ...)"},
         seed_option(s->seed, "of the random input and noise; default 1")});
    return {c, [s] { return run_simulate(*s); }};
}

Command excitation_command(CLI::App& app) {
    auto const a = std::make_shared<ExcitationArguments>();
    CLI::App* const c = app.add_subcommand("excitation", "Up to which order an input can identify a system.");
    c->footer(
        "Example:  rlslab excitation data.csv --input u\n\n"
        "Exit code: 0 some order; 1 none: no dynamic model can be identified; 2 options or a record that make no "
        "sense.");
    OptionRow("FILE", a->file, "", named("the name of a file"),
              "CSV file (-: standard input), plain or by gzip, or MATLAB's")
        .required()
        .define(*c);
    define_format(*c, a->format);
    define(*c, {OptionRow("--input", a->input, "COLUMN", "column of the input").required(),
                {"--max-order", a->most, "N", whole(1, 200), "the largest order that is tried; default 20"},
                {"--json", a->json, "JSON instead of the table"}});
    define_undated(*c, a->dated);
    return {c, [a] { return run_excitation(*a); }};
}

}  // namespace rlslab::program
