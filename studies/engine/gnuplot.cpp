// Figures for papers: a gnuplot script for each, with its numbers in it, to be changed to a journal's taste.
#include "figure.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <map>

namespace rlslab {
namespace {

/// In gnuplot's enhanced text an underscore lowers what follows.
std::string plain(std::string const& text) {
    std::string out;
    for (char const c : text) out += c == '_' || c == '^' || c == '@' || c == '&' || c == '{' || c == '}' ? std::string("\\\\") + c : c == '"' ? std::string("''") : std::string(1, c);
    return out;
}

int mark_of(std::string const& mark) {
    static std::map<std::string, int> const types{
        {"circle", 7},          {"circle-open", 6},        {"square", 5},         {"square-open", 4}, {"diamond", 13},
        {"diamond-open", 12},   {"triangle-up", 9},        {"triangle-up-open", 8}, {"triangle-down", 11},
        {"triangle-down-open", 10}, {"star", 15},          {"star-open", 14},     {"cross", 1},       {"cross-open", 1},
        {"x", 2},               {"x-open", 2}};
    auto const found = types.find(mark);
    return found == types.end() ? 7 : found->second;
}

void add_data(std::string& out, std::string const& name, Curve const& curve) {
    out += fmt::format("${} << END\n", name);
    for (size_t i = 0; i < curve.x.size(); ++i) out += fmt::format("{} {}\n", curve.x[i], curve.y[i]);
    out += "END\n";
}

std::string axis(char const* which, bool logarithmic, std::string const& label) {
    return fmt::format("set {0}label \"{1}\"{3}\n{2}", which, plain(label),
                       logarithmic ? fmt::format("set logscale {0}\nset format {0} \"10^{{%L}}\"\n", which) : "",
                       *which == 'x' ? " offset 0,0.5" : "");    // clear of the key
}

/// A rectangle for each cell; they meet halfway between their places.
std::string cells_script(Figure const& figure) {
    std::string out, draw;
    int number = 0;
    for (Panel const& panel : figure.panels) {
        Curve const& cells = panel.curves.front();
        std::vector<std::string> rows;
        std::vector<double> places;
        for (size_t i = 0; i < cells.x.size(); ++i) {
            if (std::ranges::find(rows, cells.row[i]) == rows.end()) rows.push_back(cells.row[i]);
            if (std::ranges::find(places, cells.x[i]) == places.end()) places.push_back(cells.x[i]);
        }
        std::ranges::sort(places);
        auto const between = [&](size_t i, size_t j) { return figure.log_x ? std::sqrt(places[i] * places[j]) : (places[i] + places[j]) / 2; };
        auto const beyond = [&](double edge, double place) { return figure.log_x ? place * place / edge : 2 * place - edge; };
        std::string const name = fmt::format("p{}", ++number);
        out += fmt::format("${} << END\n", name);
        for (size_t i = 0; i < cells.x.size(); ++i) {
            size_t const at = size_t(std::ranges::find(places, cells.x[i]) - places.begin()), last = places.size() - 1;
            long const row = std::ranges::find(rows, cells.row[i]) - rows.begin();
            if (!std::isfinite(cells.y[i]) || last == 0) continue;
            double const low = at > 0 ? between(at - 1, at) : beyond(between(0, 1), places[0]);
            double const high = at < last ? between(at, at + 1) : beyond(between(last - 1, last), places[last]);
            out += fmt::format("{} {} {} {} {} {} {}\n", cells.x[i], row, low, high, double(row) - 0.5, double(row) + 0.5, cells.y[i]);
        }
        out += "END\n";
        std::string tics;
        for (size_t r = 0; r < rows.size(); ++r) tics += fmt::format("{}\"{}\" {}", r ? ", " : "", plain(rows[r]), r);
        draw += fmt::format("set title \"{}\"\nset ytics ({})\nset yrange [-0.6:{}.6]\n"
                            "plot ${} using 1:2:3:4:5:6:7 with boxxyerror fillcolor palette fillstyle solid noborder notitle\n",
                            plain(panel.name), tics, rows.size() - 1, name);
    }
    return out + axis("x", figure.log_x, figure.x) + "set ylabel \"" + plain(figure.series) + "\"\nset autoscale xfix\nset cbrange [0:1]\n" +
           "set palette defined (0 '#f7f7f7', 0.5 '#92c5de', 1 '#053061')\n" + draw;
}

}  // namespace

std::string gnuplot_script(Figure const& figure) {
    size_t const panels = figure.panels.size(), columns = panels > 1 ? 2 : 1, rows = (panels + columns - 1) / columns;
    std::string body;
    if (figure.cells) {
        body = cells_script(figure);
    } else {
        std::string data, draw;
        int number = 0;
        for (Panel const& panel : figure.panels) {
            std::string plots;
            auto const add = [&](Curve const& curve, std::string const& with) {
                if (curve.x.empty()) return;
                std::string const name = fmt::format("c{}", ++number);
                add_data(data, name, curve);
                plots += fmt::format("{}${} using 1:2 with {} lc rgb \"{}\" dt {} title \"{}\"", plots.empty() ? "plot " : ", \\\n  ", name, with,
                                     curve.look.colour, curve.look.dashed ? 2 : 1, plain(curve.name));
            };
            for (Curve const& curve : panel.curves) add(curve, fmt::format("linespoints lw 1.2 ps 0.5 pt {}", mark_of(curve.look.mark)));
            for (Curve const& curve : panel.guides) add(curve, "lines lw 1");
            if (!plots.empty()) draw += fmt::format("set title \"{}\"\n{}\n", plain(panel.name), plots);
        }
        body = data + axis("x", figure.log_x, figure.x) + axis("y", figure.log_y, figure.y) + "set autoscale xfix\nset key below samplen 1.5 spacing 0.9 font \",9\"\n" + draw;
    }
    double const width = panels > 1 ? 12.0 : 7.0, height = 4.6 * double(rows) + 0.4;
    std::string out = fmt::format("# {}: gnuplot {}.gp draws {}.svg and {}.pdf\n", figure.title, figure.name, figure.name, figure.name);
    for (auto const& [terminal, unit, ending] : {std::tuple{"svg enhanced background '#ffffff' font \"Helvetica,12\"", 90.0, "svg"},
                                                 std::tuple{"pdfcairo enhanced font \"Helvetica,10\"", 1.0, "pdf"}}) {
        out += fmt::format("reset\nset terminal {} size {},{}\nset output \"{}.{}\"\nset grid lc rgb \"#e3e3e3\" lt 1\n", terminal,
                           width * unit, height * unit, figure.name, ending);
        out += fmt::format("set multiplot layout {},{} title \"{}\"\n{}unset multiplot\n", rows, columns, plain(figure.title), body);
    }
    return out;
}

}  // namespace rlslab
