// The excitation of each input, and remarks about it.
#include "src/lab/identify/inputs.hpp"

#include "src/lab/identify/structure.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/input/times.hpp>
#include <rlslab/model/outliers.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

using Rank = Remark::Rank;

std::string times(Index changes) { return changes == 1 ? "once" : fmt::format("{} times", changes); }

/// Remarks about an input of so many coefficients. u: with its mean, of which the first `fitted` samples count.
std::vector<Remark> remarks_on_input(std::string const& name, Signal const& u, Index fitted, Excitation const& e,
                                     Index coefficients) {
    std::vector<Remark> out;
    if (e.order < coefficients)
        out.push_back(
            {Rank::excitation,
             e.order >= 2
                 ? fmt::format("input {} is exciting of order {} only: it supports a model of order {}. An input that "
                               "changes more often, or at more frequencies, supports a higher one",
                               name, e.order, e.order - 1)
                 : fmt::format("input {} is exciting of order {} only", name, e.order),
             "a richer input"});
    else if (auto const spike = largest_spike(u, fitted); e.persistent < coefficients && spike.deviations > 10)
        out.push_back(
            {Rank::outlier,
             fmt::format("one value of input {}, in row {}, is {:.2g} standard deviations of the others off their "
                         "mean, and the estimate rests on the rows that have it. If it is wrong, empty its cell, and "
                         "it is skipped",
                         name, spike.row, spike.deviations),
             fmt::format("look at row {}", spike.row)});
    else if (e.persistent < coefficients)
        out.push_back({Rank::excitation,
                       fmt::format("input {} changes {}: its coefficients beyond {} rest on a few rows, and the noise "
                                   "there decides them. An input that changes more often says more",
                                   name, times(e.changes), e.persistent),
                       "a richer input"});
    constexpr Index long_enough = 20;  // a PRBS of long levels may well begin with one
    if (e.constant_at_start > long_enough && e.changes > 1 && e.order > 0)
        out.push_back({Rank::whiteness,
                       fmt::format("input {} stands still over the first {} of {} fitted samples: they say nothing of "
                                   "the dynamics; cut them off",
                                   name, e.constant_at_start, fitted),
                       fmt::format("cut off the first {} samples", e.constant_at_start)});
    return out;
}

void expect_supported(Record const& record, IdentifyOptions const& options, InputCheck const& check, Index needed) {
    if (structure_given(options) ? check.supported >= needed : check.supported >= 1) return;
    std::vector<std::string> reasons;
    for (Remark const& remark : check.remarks) reasons.push_back(remark.sentence);
    for (size_t j = 0; j < record.inputs.size(); ++j)
        if (auto const missing = std::ranges::count_if(record.inputs[j], [](double u) { return std::isnan(u); }))
            reasons.push_back(
                fmt::format("{} of {} samples of {} are missing, and each leaves out the rows that it is in", missing,
                            record.samples, printable(options.inputs[j])));
    throw InputError(fmt::format(
        "{}: {} ({})", record.file,
        check.supported < 1 ? "the input as it stands in the complete rows does not excite the system: it supports no "
                              "model of order 1 or more"
        : options.order
            ? fmt::format("order {} cannot be identified from this input; it supports order {}", options.order,
                          check.supported)
            : fmt::format("{} coefficients of an input cannot be identified from this record; it supports {}",
                          needed + 1, check.supported + 1),
        fmt::join(reasons, "; ")));
}

}  // namespace

InputCheck check_inputs(Record const& record, IdentifyOptions const& options, Progress const& progress) {
    size_t const inputs = record.inputs.size();
    std::vector<Index> coefficients(inputs, 0);
    for (Term const& t : terms_of(options, widest_order(options)))
        if (t.input >= 0) ++coefficients[size_t(t.input)];
    Index const needed = inputs > 0 ? *std::ranges::max_element(coefficients) - 1 : widest_order(options);
    InputCheck out{.supported = needed, .excitation = {}, .remarks = {}};
    if (std::string const &said = record.of_times, mends = time_option(record.time); !said.empty())
        out.remarks.push_back({Rank::time, said, said.ends_with(mends) ? mends : ""});
    for (std::string const& sentence : record.warnings) out.remarks.push_back({Rank::excitation, sentence, ""});
    for (size_t j = 0; j < inputs; ++j) {
        Signal const& u = record.inputs_with_means[j];
        auto const part_done = [&](double part) {
            if (progress) progress((double(j) + part) / double(inputs));
        };
        Excitation const e = excitation(longest_run(u, record.fitted), coefficients[j],
                                        {.constant = options.intercept, .progress = part_done});
        if (e.order < coefficients[j]) out.supported = std::min(out.supported, e.order - 1);
        for (Remark& remark : remarks_on_input(printable(options.inputs[j]), u, record.fitted, e, coefficients[j]))
            out.remarks.push_back(std::move(remark));
        out.excitation.push_back(e);
    }
    expect_supported(record, options, out, needed);
    return out;
}

}  // namespace rlslab::identify
