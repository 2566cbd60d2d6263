// Makes curves from rows: one for each series and panel, through the median of the rows at one place.
#include <rlslab/studies/figure.hpp>

#include <rlslab/studies/judgements.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/catalogue/catalogue.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace rlslab::studies {
using namespace report;
namespace {

bool shown(double x, bool logarithmic) { return std::isfinite(x) && (!logarithmic || x > 0); }

Curve curve(std::string name, Look look, Table const& rows, Plot const& plot, bool log_x, bool log_y) {
    Curve out{.name = std::move(name), .look = std::move(look), .x = {}, .y = {}, .lower = {}, .upper = {}};
    std::map<double, std::vector<double>> at;
    std::vector<double> const x = rows.numbers(plot.x), y = rows.numbers(plot.y);
    for (size_t i = 0; i < x.size(); ++i)
        if (shown(x[i], log_x) && shown(y[i], log_y) && !(y[i] < plot.floor && plot.floor > 0))
            at[x[i]].push_back(y[i]);
    for (auto const& [place, values] : at) {
        out.x.push_back(place);
        out.y.push_back(median(values));
        out.lower.push_back(*std::ranges::min_element(values));
        out.upper.push_back(*std::ranges::max_element(values));
    }
    return out;
}

/// The word that most of the cells hold, the first of equals; and how many hold it.
std::pair<std::string, size_t> most_frequent(std::vector<std::vector<Cell>> const& rows, size_t column) {
    std::pair<std::string, size_t> out;
    for (std::vector<Cell> const& row : rows) {
        auto const same = [&](std::vector<Cell> const& other) { return other[column] == row[column]; };
        if (size_t const count = size_t(std::ranges::count_if(rows, same)); count > out.second)
            out = {as_text(row[column]), count};
    }
    return out;
}

/// A cell for each (x, series): the median of its numbers, or its most frequent word with the word's share.
Curve cells(Table const& rows, Plot const& plot, std::string const& column) {
    Curve out{.name = column, .look = {}, .x = {}, .y = {}, .lower = {}, .upper = {}};
    for (Cell const& line : rows.distinct(plot.series)) {
        Table const along = rows.where(plot.series, line);
        for (Cell const& place : along.distinct(plot.x)) {
            Table const here = along.where(plot.x, place);
            bool const words = std::holds_alternative<std::string>(here.rows().front()[here.index(column)]);
            double value = 0;
            if (words) {
                auto const [word, count] = most_frequent(here.rows(), here.index(column));
                out.says.push_back(word);
                value = double(count) / double(here.rows().size());
            } else value = median(here.numbers(column));
            out.x.push_back(std::get<double>(place));
            out.y.push_back(value);
            out.lower.push_back(value);
            out.upper.push_back(value);
            out.row.push_back(as_text(line));
        }
    }
    return out;
}

/// Over the panel's x, which is where the curves are.
Curve guide(Guide const& of, std::vector<Curve> const& curves, size_t place, bool log_x, bool log_y, double floor) {
    constexpr std::array dashes{"#555555", "#999999", "#bbbbbb"};
    Curve out{.name = of.label,
              .look = {dashes[place % dashes.size()], true, ""},
              .x = {},
              .y = {},
              .lower = {},
              .upper = {}};
    double from = INFINITY, to = -INFINITY;
    for (Curve const& c : curves)
        for (double const x : c.x) from = std::min(from, x), to = std::max(to, x);
    constexpr int points = 60;
    for (int i = 0; i <= points && from <= to; ++i) {
        double const part = double(i) / points;
        double const x = log_x ? from * correctly::pow(to / from, part) : from + (to - from) * part, y = of.y(x);
        if (!shown(y, log_y) || (floor > 0 && y < floor)) continue;
        out.x.push_back(x);
        out.y.push_back(y);
    }
    return out;
}

}  // namespace

std::vector<Figure> figures(Study const& study, Table const& table) {
    std::vector<Figure> out;
    for (Plot const& plot : study.plots) {
        bool const log_x = plot.log.find('x') != std::string::npos, log_y = plot.log.find('y') != std::string::npos;
        Figure figure{fmt::format("{}-{}", study.name, out.size() + 1),
                      plot.title,
                      plot.x_label.empty() ? plot.x : plot.x_label,
                      plot.y_label.empty() ? plot.y : plot.y_label,
                      log_x,
                      log_y,
                      plot.cells,
                      {},
                      plot.series_label.empty() ? plot.series : plot.series_label};
        Table rows = table;
        for (auto const& [column, values] : plot.where) rows = rows.where(column, values);
        // The same mark for the same series in every panel.
        std::vector<Cell> const all_series = rows.distinct(plot.series);
        std::vector<std::string> const by = plot.panel.empty() ? std::vector<std::string>{} : std::vector{plot.panel};
        for (auto const& [name, here] : rows.groups(by)) {
            Panel panel{name, {}, {}};
            if (plot.cells) {
                panel.curves.push_back(cells(here, plot, plot.y));
                for (Guide const& border : plot.guides) panel.guides.push_back(cells(here, plot, border.label));
            } else
                for (size_t place = 0; place < all_series.size(); ++place) {
                    Table const one = here.where(plot.series, all_series[place]);
                    if (one.empty()) continue;
                    bool const word = std::holds_alternative<std::string>(all_series[place]);
                    std::string const series = as_text(all_series[place]);
                    panel.curves.push_back(curve(word ? series : plot.series + " " + series,
                                                 look_of(family_of_variant(series), place), one, plot, log_x, log_y));
                }
            for (size_t place = 0; place < plot.guides.size() && !plot.cells; ++place)
                panel.guides.push_back(guide(plot.guides[place], panel.curves, place, log_x, log_y, plot.floor));
            figure.panels.push_back(std::move(panel));
        }
        out.push_back(std::move(figure));
    }
    return out;
}

}  // namespace rlslab::studies
