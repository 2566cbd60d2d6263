// Reads a record, tests whether it can be modelled, and subtracts the means.
#include "src/lab/identify/record.hpp"

#include "src/lab/identify/structure.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/input/constant.hpp>
#include <rlslab/input/counting.hpp>
#include <rlslab/input/times.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <span>

namespace rlslab::identify {
using namespace report;
namespace {

double largest(Signal const& x, Index count) {
    double out = 0;
    for (Index k = 0; k < count; ++k)
        if (std::abs(x[size_t(k)]) > out) out = std::abs(x[size_t(k)]);
    return out;
}

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
            throw InputError(fmt::format("{}: column \"{}\" is named twice", name_of_file(file.path), printable(name)));
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
        throw InputError(fmt::format("{}: column \"{}\" does not change: there is nothing to model", record.file,
                                     printable(options.output)));
    if (!changes(record.y, record.fitted))
        throw InputError(fmt::format(
            "{}: column \"{}\" does not change over the {} samples that are fitted: expected a smaller --validate",
            record.file, printable(options.output), record.fitted));
    int const order = widest_order(options);
    std::vector<Term> const widest = terms_of(options, order);
    Index const needed = presample(widest) + Index(widest.size()) + 1;
    if (record.fitted < needed)
        throw InputError(fmt::format(
            "{}: {} has {} parameters and needs at least {} samples to fit, found {}: expected a lower {}{}{}",
            record.file, structure_text(options, order), widest.size(), needed, record.fitted,
            structure_given(options) ? "order" : "--max-order",
            std::ranges::max(options.delay.empty() ? std::vector{0} : options.delay) > 0 ? ", a smaller --delay" : "",
            record.fitted < record.samples ? ", or a smaller --validate" : ""));
}

Record centred(Record record, IdentifyOptions const& options) {
    record.inputs_with_means = record.inputs;
    for (size_t j = 0; j <= options.inputs.size(); ++j) {
        bool const input = j < options.inputs.size();
        Signal& x = input ? record.inputs[j] : record.y;
        std::string const name = printable(input ? options.inputs[j] : options.output);
        if (longest_run(x, record.fitted).empty())
            throw InputError(fmt::format(
                "{}: column \"{}\": expected a number in the part that is fitted, found missing values alone",
                record.file, name));
        record.means.push_back(options.detrend ? subtract_mean(x, record.fitted) : 0.0);
        // Squares of the rest must not underflow.
        if (double const size = largest(x, record.fitted); size > 0 && size < 0x1p-400)
            throw InputError(fmt::format(
                "{}: column \"{}\" is {:.2g} in size at most: expected moderate numbers; multiply it by a power of ten",
                record.file, name, size));
    }
    return record;
}

}  // namespace

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
