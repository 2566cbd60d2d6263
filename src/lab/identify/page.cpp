// An identified model as a page.
#include "src/lab/identify/figures.hpp"
#include "src/lab/identify/text.hpp"
#include "src/lab/report/page.hpp"

#include <filesystem>
#include <fmt/format.h>

namespace rlslab::identify {
using namespace report;
namespace {

/// If the variant gave no numbers, only the orders and the trajectory.
std::vector<Figure> figures_of(Identified const& m) {
    std::vector<Figure> out;
    bool const model = !m.measured.empty();
    if (!m.choice.fits.empty()) draw_orders(out, m);
    if (model) draw_outputs(out, m), draw_correlations(out, m);
    if (!m.constancy.samples.empty()) draw_constancy(out, m);
    if (!m.responses.empty()) draw_steps(out, m), draw_frequencies(out, m);
    if (!m.poles.empty() || !m.zeros.empty()) draw_poles(out, m);
    draw_trajectory(out, m);
    return out;
}

/// A box for each sentence; kind: "warning", "next".
std::string boxes(std::string const& kind, std::string const& type, std::vector<std::string> const& sentences) {
    std::string out;
    for (std::string const& words : sentences)
        out += fmt::format("<li class=\"{}\"><b>{}</b> {}</li>", type, kind, escaped(words));
    return out.empty() ? "" : "<ul class=\"claims\">" + out + "</ul>";
}

/// Without the text of the header.
std::vector<std::string> order_lines_below(Identified const& m) {
    std::vector<std::string> out = order_lines(m);
    std::string const header = fmt::format("{} ({})", m.structure, m.why);
    if (out.front().starts_with(header))
        out.front().erase(0, header.size() + (out.front().starts_with(header + "; ") ? 2 : 0));
    std::erase(out, "");
    return out;
}

}  // namespace

std::string as_page(Identified const& m) {
    std::vector<Figure> const figures = figures_of(m);
    std::string body = fmt::format("<header><h1>{}: {}</h1><p class=\"question\">{}</p>",
                                   escaped(printable(std::filesystem::path(m.file).filename().string(), 60)),
                                   escaped(m.structure), escaped(m.why));
    body += boxes("warning", "fails", m.warnings()) + "</header>";
    for (std::string const& words : order_lines_below(m)) body += fmt::format("<p>{}</p>", escaped(words));
    for (std::string const& words : result_lines(m))
        if (!words.starts_with("next: ") && !words.starts_with("hint: "))
            body += fmt::format("<p>{}</p>", escaped(words));
    body += boxes("hint", "next", m.hints());
    if (!m.next().empty()) body += boxes("next", "next", {m.next()});
    for (Figure const& figure : figures) body += figure_html(figure);
    body += "<section><h2>Parameters</h2>\n";
    std::vector<std::vector<std::string>> rows;
    for (Parameter const& p : m.parameters)
        rows.push_back({printable(p.name), p.regressor, number_text(p.value, 6), number_text(p.sd, 2),
                        fmt::format("{} ... {}", number_text(p.lower, 5), number_text(p.upper, 5))});
    body += table_html(
        {"parameter", "of", "estimate", "sd", fmt::format("{:g} % interval", 100 * m.options.confidence)}, rows);
    body += "</section>\n";
    for (auto const& cured : {m.noise_model, m.instruments}) {
        if (!cured) continue;
        body += fmt::format("<section><p>{}</p>\n", escaped(cured_title(*cured)));
        body += table_html(cured_header(), cured_rows(*cured));
        for (std::string const& words : cured_lines(*cured)) body += fmt::format("<p>{}</p>", escaped(words));
        body += "</section>\n";
    }
    for (auto const& lines : {data_lines(m), input_lines(m)})
        for (std::string const& words : lines) body += fmt::format("<p class=\"soft\">{}</p>", escaped(words));
    if (m.run) body += as_html(*m.run);
    return page(m.file + ": identified", body);
}

}  // namespace rlslab::identify
