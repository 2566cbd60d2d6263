// rlslab advise: what keeps the wanted digits on a record.
#include "advise/advise.hpp"
#include "program/record_options.hpp"

#include <cmath>

namespace rlslab::program {
using namespace compare;
using namespace report;
namespace {

struct AdviseArguments {
    RecordArguments record;
    std::vector<std::string> arithmetics;
    AdviseOptions options;
    bool json = false;
};

/// 0 where something keeps the digits, else 1.
int run_advise(AdviseArguments const& a) {
    AdviseOptions options = a.options;
    if (!a.arithmetics.empty()) options.arithmetics = a.arithmetics;
    Question const question = question_of(a.record);
    Advice advice = advise(question.records, options, progress_after_a_second("advising"));
    for (Tried& t : advice.tried) t.comparison.model = question.model;
    print(a.json ? as_json(advice) : as_text(advice, colour(), terminal_columns()));
    return advice.chosen() ? 0 : 1;
}

}  // namespace

Command advise_command(CLI::App& app) {
    auto const a = std::make_shared<AdviseArguments>();
    CLI::App* const advising = app.add_subcommand("advise", "What keeps the wanted digits on a record, with the C++ for it.");
    advising->footer(
        "Three digits in float:  rlslab advise data.csv --input u --output y --order 4 --arithmetic float --digits 3\n\n"
        "The digits are those of the worst parameter: after the last row, of the least-squares solution for the data as given, in "
        "every order of the rows that is tried; and at nine tenths of checkpoints along the record, of the solution there with the "
        "filter's prior. They say how well a filter computes, not how well the data determine theta. Of several arithmetics the "
        "first that keeps the digits is taken.\n\n"
        "Exit code: 0 something keeps the digits; 1 nothing tried does; 2 no answer: wrong input, or it could not be written.");
    take_record(*advising, a->record);
    take_forgetting(*advising, a->options.forgetting);
    advising->add_option("--digits", a->options.digits, "wanted of every parameter, from 0.5 to 30; default 3")
        ->check(real("a number from 0.5 to 30", [](double x) { return 0.5 <= x && x <= 30; }))
        ->type_name("D");
    take_arithmetics(*advising, a->arithmetics, "to try, in this order (rlslab list; also half, single, fp32, fp64); default float,double");
    take_seed(*advising, a->options.seed, "of stochastic rounding and of the orders of rows; default 1");
    take_count(*advising, "--threads", a->options.threads, 1, 4096, "default: all cores; the results are the same");
    advising->add_flag("--json", a->json, "JSON instead of text");
    return {advising, [a] { return run_advise(*a); }};
}

}  // namespace rlslab::program
