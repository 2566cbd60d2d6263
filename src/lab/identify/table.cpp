// An identified model as a table with its sentences, for a terminal or a file.
#include "src/lab/identify/structure.hpp"
#include "src/lab/identify/text.hpp"

#include <rlslab/input/text.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;

std::string as_table(Identified const& m, size_t columns) {
    size_t const width = line_width(columns, 120);
    auto const in_lines = [width](std::string const& text) { return wrapped(text, 0, 4, width) + '\n'; };
    auto const on_a_terminal = [&](std::string const& text) { return columns > 0 ? in_lines(text) : text + '\n'; };
    std::string out, file = printable(m.file, 200) + ": ";
    for (std::string const& words : data_lines(m)) out += on_a_terminal(file + words), file.clear();
    for (std::string const& words : input_lines(m)) out += on_a_terminal(words);
    for (std::string const& warning : m.warnings()) out += in_lines("warning: " + warning);
    for (std::string const& words : order_lines(m)) out += '\n' + on_a_terminal(words), out.pop_back();
    size_t name = 9, of = 4;
    for (Parameter const& p : m.parameters)
        name = std::max(name, printable(p.name).size()), of = std::max(of, p.regressor.size());
    if (!structure_given(m.options) && !m.choice.fits.empty()) {
        out += "\n\n  order  parameters        AIC        BIC        FPE  white: p  held out\n";
        for (OrderFit const& fit : m.choice.fits)
            out +=
                fmt::format("{} {:>5}  {:>10} {:>10} {:>10} {:>10}  {:>8}  {:>8}\n", fit.order == m.order ? '*' : ' ',
                            fit.order, fit.parameters, number_text(fit.aic, 5), number_text(fit.bic, 5),
                            number_text(fit.fpe, 3), number_text(fit.ljung_box, 2), percent_text(fit.held_out));
        out.pop_back();
    }
    out += fmt::format("\n\n  {:<{}}  {:<{}} {:>12} {:>9}  {:g} % interval\n", "parameter", name, "of", of, "estimate",
                       "sd", 100 * m.options.confidence);
    for (Parameter const& p : m.parameters)
        out += fmt::format("  {:<{}}  {:<{}} {:>12} {:>9}  {} ... {}\n", printable(p.name), name, p.regressor, of,
                           number_text(p.value, 6), number_text(p.sd, 2), number_text(p.lower, 5),
                           number_text(p.upper, 5));
    out += '\n';
    for (auto const& cured : {m.noise_model, m.instruments}) {
        if (!cured) continue;
        out += in_lines(cured_title(*cured)) + '\n';
        for (CuredParameter const& p : cured->parameters) of = std::max(of, p.regressor.size());
        auto rows = cured_rows(*cured);
        rows.insert(rows.begin(), cured_header());
        for (auto const& r : rows)
            out += fmt::format("  {:<{}}  {:<{}} {:>12} {:>9} {:>14} {:>10}\n", r[0], name, r[1], of, r[2], r[3], r[4],
                               r[5]);
        out += '\n';
        for (std::string const& words : cured_lines(*cured)) out += in_lines(words);
        out += '\n';
    }
    for (std::string const& words : result_lines(m)) out += in_lines(words);
    return out;
}

}  // namespace rlslab::identify
