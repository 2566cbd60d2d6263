// A record to columns without their means; options to terms; terms to rows, words and an equation.
#include "src/lab/identify/structure.hpp"

#include <rlslab/input/constant.hpp>
#include <rlslab/input/counting.hpp>
#include <rlslab/input/times.hpp>
#include <rlslab/model/lags.hpp>

#include <algorithm>
#include <span>

namespace rlslab::identify {
namespace {

constexpr int longest = 200;  // the cost of poles and zeros grows with its third power

/// One for each input, where one or as many were given.
std::vector<int> for_each_input(char const* option, std::vector<int> const& given, size_t inputs, int otherwise) {
    if (given.empty()) return std::vector<int>(inputs, otherwise);
    if (given.size() == 1) return std::vector<int>(inputs, given[0]);
    if (given.size() != inputs)
        refuse("{}: expected one number, or one for each of the {} inputs, found {}", option, inputs, given.size());
    return given;
}

std::vector<Lagged> listed(IdentifyOptions const& o) { return lagged_of("--regressors", o.regressors, o.output); }

std::string joined(std::vector<int> const& numbers) {
    bool const same = std::ranges::count(numbers, numbers[0]) == std::ssize(numbers);
    return same ? fmt::format("{}", numbers[0]) : fmt::format("{}", fmt::join(numbers, ","));
}

// --- the record -----------------------------------------------------------------------------------------------------

/// Subtracts the mean of the first `count` samples from all, and returns it.
double subtract_mean(Signal& x, Index count) {
    double mean = 0, known = 0;
    for (Index k = 0; k < count; ++k) known += !std::isnan(x[size_t(k)]);
    for (Index k = 0; k < count; ++k)
        if (!std::isnan(x[size_t(k)])) mean += x[size_t(k)] / known;
    mean = constant_value(std::span(x).first(size_t(count))).value_or(mean);
    for (double& v : x) v -= mean;
    return mean;
}

bool changes(Signal const& x, Index count) {
    auto const first = std::span(x).first(size_t(count));
    return !constant_value(first) && std::ranges::any_of(first, [](double v) { return !std::isnan(v); });
}

Record read_columns_of(DataFile const& file, IdentifyOptions const& options) {
    std::vector<std::string> names = options.inputs;
    names.push_back(options.output);
    for (std::string const& name : names)
        if (std::ranges::count(names, name) > 1)
            refuse("{}: column \"{}\" is named twice", name_of_file(file.path), printable(name));
    expect_times_apart(options.time, options.output, options.inputs);
    Columns columns = read_data(file, names, options.time);
    std::string const of_times = options.time.empty() ? sentence_on_times(columns).value_or("") : "";
    if (!options.time.empty())
        columns = in_order_of_time(std::move(columns),
                                   std::max<Index>(1000, presample(terms_of(options, widest_order(options)))));
    Record out{.file = printable(file.path, 200), .y = columns[options.output], .lines = std::move(columns.lines)};
    out.sha256 = columns.sha256;
    for (std::string const& name : options.inputs) out.inputs.push_back(columns[name]);
    out.samples = Index(out.y.size());
    out.fitted = out.samples - Index(std::floor(options.validate * double(out.samples)));
    for (std::string const& name : names) {
        Signal known(columns[name].begin(), columns[name].begin() + out.fitted);
        std::erase_if(known, [](double v) { return std::isnan(v); });
        // Computed numbers that carry some dozens of roundings: columns of condition 1e14 or so.
        out.resolutions.push_back(known.empty() ? 0 : resolution_of(known, 0x1p-46));
    }
    out.warnings = counting_warnings(columns, options.inputs);
    out.of_times = of_times, out.time = columns.time;
    return out;
}

void expect_enough_samples(Record const& record, IdentifyOptions const& options) {
    if (!changes(record.y, record.samples))
        refuse("{}: column \"{}\" {}: there is nothing to model", record.file, printable(options.output),
               std::ranges::all_of(record.y, [](double v) { return std::isnan(v); }) ? "misses all values"
                                                                                     : "does not change");
    if (!changes(record.y, record.fitted))
        refuse("{}: column \"{}\" does not change over the {} samples that are fitted: expected a smaller --validate",
               record.file, printable(options.output), record.fitted);
    int const order = widest_order(options);
    std::vector<Term> const widest = terms_of(options, order);
    Index const needed = presample(widest) + Index(widest.size()) + 1;
    if (record.fitted < needed)
        refuse(
            "{}: {} has {} parameters and needs at least {} samples to fit, found {}: expected a lower {}{}{}",
            record.file, structure_text(options, order), widest.size(), needed, record.fitted,
            structure_given(options) ? "order" : "--max-order",
            std::ranges::max(options.delay.empty() ? std::vector{0} : options.delay) > 0 ? ", a smaller --delay" : "",
            record.fitted < record.samples ? ", or a smaller --validate" : "");
}

Record centred(Record record, IdentifyOptions const& options) {
    record.inputs_with_means = record.inputs;
    for (size_t j = 0; j <= options.inputs.size(); ++j) {
        bool const input = j < options.inputs.size();
        Signal& x = input ? record.inputs[j] : record.y;
        std::string const name = printable(input ? options.inputs[j] : options.output);
        if (longest_run(x, record.fitted).empty())
            refuse("{}: column \"{}\": expected a number in the part that is fitted, found missing values alone",
                   record.file, name);
        record.means.push_back(options.detrend ? subtract_mean(x, record.fitted) : 0.0);
        double size = 0;
        for (double const v : std::span(x).first(size_t(record.fitted)))
            if (std::abs(v) > size) size = std::abs(v);
        if (size > 0 && size < 0x1p-400)  // squares of the rest must not underflow
            refuse(
                "{}: column \"{}\" is {:.2g} in size at most: expected moderate numbers; multiply it by a power of ten",
                record.file, name, size);
    }
    return record;
}

}  // namespace

bool structure_given(IdentifyOptions const& o) { return o.order > 0 || o.na || !o.regressors.empty(); }

int widest_order(IdentifyOptions const& o) { return structure_given(o) ? 0 : o.max_order; }

Structure choose_structure(Record const& record, IdentifyOptions const& options, Index supported) {
    int const widest = widest_order(options);
    std::vector<Term> const terms = terms_of(options, widest);
    Records const rows = rows_of(terms, record.inputs, record.y).before(record.fitted).records;
    if (rows.rows() <= rows.parameters())
        refuse(
            "{}: {} has {} parameters, and {} of its rows in the fitted part miss no value: expected more, "
            "or a lower order",
            record.file, structure_text(options, widest), terms.size(), rows.rows());
    Structure out;
    bool const given = structure_given(options);
    if (!given) out.largest_order = int(std::min<Index>(widest, supported));
    if (options.regressors.empty() && !options.na) {
        int const most = given ? options.order : out.largest_order;
        OrderColumns const columns = order_columns(record.inputs, record.y, most, options.delay, options.intercept);
        Index const held_out = columns.samples.end() - std::ranges::lower_bound(columns.samples, record.fitted);
        out.choice = choose_order(columns, most, held_out);
        if (out.choice.fits.size() < 2 && constant_value(columns.y.head(out.choice.rows)))
            refuse(
                "{}: column \"{}\" does not change from row {} on, where a choice up to order {} begins to fit: "
                "expected a lower --max-order, or --order",
                record.file, printable(options.output), columns.samples.front() + 1, most);
        if (out.choice.fits.size() < 2)
            refuse("{}: {} linearly dependent already at order 1", record.file,
                   record.inputs.empty() ? "the past outputs and the constant are"
                                         : "the output, the inputs and their past are");
    }
    out.terms = given ? terms : terms_of(options, out.choice.order);
    out.order = given ? order_of(terms, options.delay) : out.choice.order;
    out.structure = structure_text(options, given ? 0 : out.order);
    out.why = given ? "given" : out.choice.why;
    return out;
}

IdentifyOptions completed(IdentifyOptions o) {
    if (o.output.empty()) refuse("--output: expected the name of the output column");
    if (!o.regressors.empty()) {
        if (!o.inputs.empty() || o.order || o.max_order || o.na || !o.nb.empty() || !o.delay.empty())
            refuse("--regressors: does not go with --input, --order, --max-order, --na, --nb or --delay");
        for (Lagged const& r : listed(o))
            if (r.column != o.output && std::ranges::count(o.inputs, r.column) == 0) o.inputs.push_back(r.column);
        std::vector<int> nearest(o.inputs.size(), largest_lag), furthest(o.inputs.size(), 0);
        for (Lagged const& r : listed(o))
            if (r.column == o.output) {
                if (r.lag > longest)
                    refuse("--regressors: {}: expected a lag of at most {} for the output", text_of(r), longest);
            } else {
                size_t const j = size_t(std::ranges::find(o.inputs, r.column) - o.inputs.begin());
                nearest[j] = std::min(nearest[j], r.lag), furthest[j] = std::max(furthest[j], r.lag);
                if (furthest[j] - nearest[j] > longest)
                    refuse("--regressors: {}: expected the lags of an input within {} of one another", text_of(r),
                           longest);
            }
    } else if (o.inputs.empty()) {
        for (auto const& [option, given] : {std::pair("--nb", !o.nb.empty()), {"--delay", !o.delay.empty()}})
            if (given) refuse("{}: expected --input, too: it counts samples of an input", option);
        if (o.na && *o.na == 0)
            refuse("--na: expected 1 or more, or --input, too: without an input y is predicted from its past");
    }
    if (o.order && (o.na || !o.nb.empty())) refuse("--order: does not go with --na and --nb");
    if (o.max_order && (o.order || o.na || !o.nb.empty()))
        refuse("--max-order: does not go with --order, --na and --nb");
    if (o.na && o.nb.empty() && !o.inputs.empty()) refuse("--na: expected --nb, too");
    if (!o.na && !o.nb.empty()) refuse("--nb: expected --na, too");
    if (o.na) o.nb = for_each_input("--nb", o.nb, o.inputs.size(), 0);
    if (o.sample_time && !(1e-15 <= *o.sample_time && *o.sample_time <= 1e15))
        refuse("--sample-time: expected seconds from 1e-15 to 1e15, found {}", *o.sample_time);
    o.delay = for_each_input("--delay", o.delay, o.inputs.size(), 0);
    if (!o.max_order) o.max_order = 10;
    // The means of a window are not those of the equation: without them a constant remains.
    o.intercept = o.intercept || o.detrend;
    return o;
}

std::vector<Term> terms_of(IdentifyOptions const& o, int order) {
    std::vector<Term> out;
    auto const output = [&](int lag) { out.push_back({fmt::format("a{}", lag), text_of({o.output, lag}), -1, lag}); };
    auto const input = [&](size_t j, int lag, int number) {
        std::string const which = o.inputs.size() > 1 ? fmt::format("[{}]", printable(o.inputs[j])) : "";
        out.push_back({fmt::format("b{}{}", number, which), text_of({o.inputs[j], lag}), int(j), lag});
    };
    if (order == 0 && !o.regressors.empty()) {
        std::vector<Lagged> const list = listed(o);
        for (Lagged const& r : list)
            if (r.column == o.output) output(r.lag);
        for (size_t j = 0; j < o.inputs.size(); ++j)
            for (Lagged const& r : list)
                if (r.column == o.inputs[j]) input(j, r.lag, r.lag);
    } else {
        int const na = order > 0 ? order : o.order > 0 ? o.order : *o.na;
        for (int i = 1; i <= na; ++i) output(i);
        for (size_t j = 0; j < o.inputs.size(); ++j)
            for (int i = 0; i <= (order > 0 ? order : o.order > 0 ? o.order : o.nb[j]); ++i)
                input(j, o.delay[j] + i, i);
    }
    if (o.intercept) out.push_back({"c", "1", -2, 0});
    return out;
}

std::string structure_text(IdentifyOptions const& o, int order) {
    std::string const delay =
        std::ranges::any_of(o.delay, [](int d) { return d > 0; }) ? ", delay " + joined(o.delay) : "";
    if (order > 0 || o.order > 0) return fmt::format("order {}{}", order > 0 ? order : o.order, delay);
    if (!o.na) return fmt::format("{} regressors", listed(o).size());
    return o.inputs.empty() ? fmt::format("na = {}", *o.na)
                            : fmt::format("na = {}, nb = {}{}", *o.na, joined(o.nb), delay);
}

Index presample(std::vector<Term> const& terms) {
    int out = 0;
    for (Term const& t : terms) out = std::max(out, t.lag);
    return out;
}

int order_of(std::vector<Term> const& terms, std::vector<int> const& delay) {
    int out = 0;
    for (Term const& t : terms) out = std::max(out, t.input >= 0 ? t.lag - delay[size_t(t.input)] : t.lag);
    return out;
}

int delay_of(std::vector<Term> const& terms, int input) {
    int out = largest_lag;
    for (Term const& t : terms)
        if (t.input == input) out = std::min(out, t.lag);
    return out == largest_lag ? 0 : out;
}

Index past_outputs(std::vector<Term> const& terms) {
    return std::ranges::count_if(terms, [](Term const& t) { return t.input == -1; });
}

Rows rows_of(std::vector<Term> const& terms, std::vector<Signal> const& inputs, Signal const& y) {
    Index const first = presample(terms), last = Index(y.size()), d = Index(terms.size());
    expects(last >= first, "more samples than the longest lag");
    Rows out{{.psi = Matrix<double>(d, last - first), .y = Vector<double>(last - first), .presample = first}, {}};
    Records& r = out.records;
    for (Term const& t : terms) r.names.push_back(t.name);
    for (Index at = first; at < last; ++at) {
        Index const k = Index(out.samples.size());
        r.y[k] = y[size_t(at)];
        for (Index i = 0; i < d; ++i) {
            Term const& t = terms[size_t(i)];
            size_t const then = size_t(at - t.lag);
            r.psi(i, k) = t.input >= 0 ? inputs[size_t(t.input)][then] : t.input == -1 ? -y[then] : 1.0;
        }
        if (!std::isnan(r.y[k]) && !r.psi.col(k).hasNaN()) out.samples.push_back(at);
    }
    r.skipped = last - first - Index(out.samples.size());
    r.psi.conservativeResize(Eigen::NoChange, Index(out.samples.size()));
    r.y.conservativeResize(Index(out.samples.size()));
    return out;
}

Rows Rows::before(Index sample) const {
    Index const count = std::ranges::lower_bound(samples, sample) - samples.begin();
    return {{.psi = records.psi.leftCols(count),
             .y = records.y.head(count),
             .names = records.names,
             .presample = records.presample},
            {samples.begin(), samples.begin() + count}};
}

std::string equation_text(std::vector<Term> const& terms, std::string const& output) {
    std::string left = fmt::format("{}[k]", printable(output)), right;
    for (size_t i = 0; i < terms.size();) {
        size_t end = i + 1;  // of a run of neighbouring lags of one signal
        while (end < terms.size() && terms[end].input == terms[i].input && terms[end].lag == terms[end - 1].lag + 1)
            ++end;
        auto const term = [&](size_t at) {
            return terms[at].input == -2 ? terms[at].name : terms[at].name + " " + terms[at].regressor;
        };
        std::string part = term(i);
        if (end - i > 3) part += " + ... + " + term(end - 1);
        else
            for (size_t at = i + 1; at < end; ++at) part += " + " + term(at);
        std::string& side = terms[i].input == -1 ? left : right;
        side += (side.empty() ? "" : " + ") + part;
        i = end;
    }
    return left + " = " + right + (right.empty() ? "e[k]" : " + e[k]");
}

DifferenceEquation equation_of(std::vector<Term> const& terms, Vector<double> const& theta, size_t inputs) {
    std::vector<EquationTerm> places;
    for (Term const& t : terms) places.push_back({t.input, t.lag});
    return DifferenceEquation::of(places, theta, inputs);
}

Record read_record(DataFile const& file, IdentifyOptions const& options) {
    Record record = read_columns_of(file, options);
    expect_enough_samples(record, options);
    return centred(std::move(record), options);
}

Signal zero_filled(Signal const& x, Index first, Index end) {
    Signal out(x.begin() + first, x.begin() + end);
    for (double& v : out)
        if (std::isnan(v)) v = 0;
    return out;
}

Signal longest_run(Signal const& x, Index count) {
    Index begin = 0, best = 0, length = 0;
    for (Index k = 0; k <= count; ++k)
        if (k == count || std::isnan(x[size_t(k)])) {
            if (k - begin > length) best = begin, length = k - begin;
            begin = k + 1;
        }
    return Signal(x.begin() + best, x.begin() + best + length);
}

}  // namespace rlslab::identify
