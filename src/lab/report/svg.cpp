// Panels for pages, and whole figures as documents: title, panels in a grid, legend; looks, and LaTeX as plain text.
#include "src/lab/report/svg.hpp"
#include "src/lab/report/plot.hpp"
#include "src/lab/report/page.hpp"

#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <sstream>

namespace rlslab::report {
namespace {

using namespace plot;

constexpr char const* ink = "#1a1a1a";
constexpr char const* font = "font-family=\"system-ui,'Segoe UI','DejaVu Sans',Helvetica,Arial,sans-serif\"";

/// Everything of a panel in width x height units.
std::string panel_body(Figure const& figure, Panel const& panel, double width, double height) {
    std::vector<Curve const*> const legend = legend_of(figure);
    Cells const cells = figure.cells ? cells_of(figure, panel) : Cells{};
    Frame const frame = frame_of(figure, panel, cells, width, height);
    Axes const& axes = frame.axes;
    std::string out = grid_group(figure, frame);
    if (figure.cells) out += cells_group(figure, panel, cells, axes.x, axes.box, shades_of(figure));
    else {
        for (Curve const& guide : panel.guides)
            out += curve_group(figure, panel, guide, series_number(legend, guide.name), true, axes);
        for (bool const strong : {false, true})  // over the others
            for (Curve const& curve : panel.curves)
                if (curve.strong == strong)
                    out += curve_group(figure, panel, curve, series_number(legend, curve.name), false, axes);
        for (Event const& event : panel.events) {
            size_t const series = series_number(legend, event.series);
            out += event_group(event, panel, series < legend.size() ? legend[series]->look : Look{"#555555"}, series,
                               axes);
        }
        if (figure.names) out += names_group(panel, legend, axes);
    }
    out += labels_group(frame, height);
    bool any = false;
    for (Curve const& curve : panel.curves)
        for (double const v : curve.y) any |= v < panel.y_least || Axis::shows(v, logarithmic_y(figure, panel));
    if (!any)
        out += text_at((axes.box.left + axes.box.right) / 2, (axes.box.top + axes.box.bottom) / 2, "no number to draw",
                       "text-anchor=\"middle\" font-size=\"13\" fill=\"#5c5c5c\"");
    return out;
}

/// The description for screen readers.
std::string description(Figure const& figure, Panel const& panel) {
    std::string out =
        fmt::format("{} against {}", figure.cells ? figure.y + " by " + figure.series : figure.y, figure.x);
    bool const log_y = logarithmic_y(figure, panel);
    if (figure.log_x || log_y)
        out += fmt::format(" ({} logarithmic)", figure.log_x && log_y ? "both" : figure.log_x ? "x" : "y");
    out += ":";
    for (Curve const& curve : panel.curves) {
        Range y;
        for (double const v : curve.y)
            if (Axis::shows(v, log_y)) y.add(v);
        if (!y.empty()) out += fmt::format(" {} {} to {};", curve.name, number_text(y.low), number_text(y.high));
    }
    for (Event const& event : panel.events) out += ' ' + event.text + ';';
    out.back() = '.';
    return out;
}

// One colour a family of variants; mark and dash by the place in it.
constexpr std::array marks{"circle", "square", "diamond", "triangle-up", "triangle-down", "star", "cross", "x"};

Look look(char const* colour, size_t mark, bool hollow) {
    return {colour, hollow, std::string(marks[mark % marks.size()]) + (hollow ? "-open" : "")};
}

struct FamilyLook {
    char const* colour;
    size_t mark;
};
/// In the order of Family::Kind.
constexpr FamilyLook families[] = {{"#000000", 0},   // conventional
                                   {"#0072b2", 1},   // symmetric
                                   {"#d55e00", 2},   // joseph
                                   {"#b8860b", 3},   // root
                                   {"#009e73", 5},   // ud
                                   {"#cc79a7", 7},   // normal_equations
                                   {"#56b4e9", 4},   // qr
                                   {"#6a3d9a", 6},   // wide_qr
                                   {"#7f7f7f", 1}};  // other
static_assert(std::size(families) == size_t(Family::other) + 1);

}  // namespace

Look look_of(std::optional<Family> const& family, size_t place) {
    if (family) {
        auto const [colour, mark] = families[family->kind];
        size_t const pair = size_t(family->place) / 2;  // a third and a fourth member have the next mark but two
        return look(colour, mark + 3 * pair, family->place % 2 == 1);
    }
    constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                 "#b8860b", "#56b4e9", "#000000", "#6a3d9a"};
    return look(colours[place % colours.size()], place, place / colours.size() % 2 == 1);
}

std::string escaped_xml(std::string_view text) {
    std::string out;
    for (; !text.empty(); text.remove_prefix(1)) {
        char const c = text.front();
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '>') out += "&gt;";
        else if (c == '"') out += "&quot;";
        else if (c == '\'') out += "&#39;";
        else if (static_cast<unsigned char>(c) < 0x20) out += c == '\n' || c == '\t' ? ' ' : '?';
        else if (static_cast<unsigned char>(c) < 0x80) out += c;
        else if (size_t const length = printable_character(text); length > 0) {
            out += text.substr(0, length);
            text.remove_prefix(length - 1);
        } else {  // not UTF-8, as pages are
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        }
    }
    return out;
}

std::vector<Curve const*> legend_of(Figure const& figure) {
    std::vector<Curve const*> out;
    for (bool const guides : {false, true})
        for (Panel const& panel : figure.panels)
            for (Curve const& curve : guides ? panel.guides : panel.curves)
                if (std::ranges::none_of(out, [&](Curve const* c) { return c->name == curve.name; }))
                    out.push_back(&curve);
    return out;
}

std::string key_svg(Curve const& curve) {
    std::string out = "<svg class=\"key\" viewBox=\"0 0 34 12\" width=\"34\" height=\"12\" aria-hidden=\"true\">";
    if (curve.line) out += fmt::format("<path d=\"M1 6H33\" {}/>", line_style(curve.look, 1.8));
    if (curve.marks && !curve.look.mark.empty())
        out += fmt::format("<path d=\"{}\" {}/>", mark_path(curve.look.mark, 17, 6), mark_style(curve.look));
    return out + "</svg>";
}

std::string panel_svg(Figure const& figure, size_t panel, double width, double height) {
    Panel const& drawn = figure.panels.at(panel);
    return fmt::format(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" xmlns=\"http://www.w3.org/2000/svg\" {} "
        "fill=\"{}\">\n<title>{}</title>\n<desc>{}</desc>\n{}</svg>\n",
        fixed(width), fixed(height), font, ink,
        escaped_xml(figure.title + (drawn.name.empty() ? "" : ": " + drawn.name)),
        escaped_xml(description(figure, drawn)), panel_body(figure, drawn, width, height));
}

std::string svg(Figure const& figure) {
    size_t const panels = figure.panels.size(), columns = panels <= 1 ? 1 : figure.cells && panels > 4 ? 3 : 2;
    // A map of words stands by itself in a page's column, and has its letters to read.
    bool const words =
        figure.cells && panels == 1 && !figure.panels[0].curves.empty() && !figure.panels[0].curves[0].says.empty();
    double const width = words ? 460 : 960, title = words ? 14 : 16;
    constexpr double gap = 16;
    double const cell = (width - gap * double(columns - 1)) / double(columns);
    double const panel_height = words ? 330 : columns == 1 ? (figure.square ? 620 : 470) : columns == 2 ? 340 : 280;
    std::string out;
    double y = 24;
    for (std::string const& line : wrapped(figure.title, title, width - (words ? 60 : 20), 4)) {
        out += text_at(width / 2, y, line,
                       fmt::format("font-size=\"{}\" font-weight=\"600\" text-anchor=\"middle\"", title));
        y += 20;
    }
    for (size_t i = 0; i < panels; ++i) {
        Panel const& panel = figure.panels[i];
        double const x = double(i % columns) * (cell + gap);
        if (!panel.name.empty())
            out += text_at(x + cell / 2, y + 8, shortened(panel.name, 13, cell),
                           "font-size=\"13\" font-weight=\"600\" text-anchor=\"middle\"");
        out += fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n", fixed(x), fixed(y + 8),
                           panel_body(figure, panel, cell, panel_height));
        if (i % columns == columns - 1 || i + 1 == panels) y += panel_height + 22;
    }
    if (figure.cells) {
        Range const shades = shades_of(figure);
        std::string bar;
        for (int i = 0; i < 40; ++i)
            bar += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"4.2\" height=\"12\" fill=\"{}\"/>", fixed(120 + 4 * i),
                               fixed(y), shade((i + 0.5) / 40));
        out += text_at(112, y + 11, number_text(shades.low), "font-size=\"12\" text-anchor=\"end\"") + bar +
               text_at(288, y + 11, shortened(number_text(shades.high) + "  " + figure.y, 12, width - 300),
                       "font-size=\"12\"");
        y += 24;
    } else if (auto const legend = legend_of(figure);
               legend.size() > 1 || (legend.size() == 1 && !legend[0]->name.empty())) {
        double x = 20;
        for (Curve const* curve : legend) {
            std::string const name = shortened(curve->name, tick_size, width - 80);
            double const room = 44 + tick_size * text_width(name) + 14;
            if (x > 20 && x + room > width) x = 20, y += 20;
            if (curve->line)
                out += fmt::format("<path d=\"M{} {}h32\" {}/>", fixed(x), fixed(y + 6), line_style(curve->look, 1.8));
            if (curve->marks && !curve->look.mark.empty())
                out += fmt::format("<path d=\"{}\" {}/>", mark_path(curve->look.mark, x + 16, y + 6),
                                   mark_style(curve->look));
            out += text_at(x + 39, y + 10.3, name, fmt::format("font-size=\"{}\"", tick_size));
            x += room;
        }
        y += 24;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" "
        "{2} fill=\"{3}\">\n"
        "<title>{4}</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n{5}</svg>\n",
        fixed(width), fixed(y), font, ink, escaped_xml(figure.title), out);
}

// --- LaTeX as plain text: words for Greek letters, a/b for fractions, no backslash -----------------------------------

namespace {

/// Commands by their names, as text.
std::map<std::string, std::string, std::less<>> const& words() {
    static auto const list = [] {
        std::map<std::string, std::string, std::less<>> out{
            {"quad", "  "}, {"qquad", "    "}, {"|", "‖"}, {"\\", ";  "}, {",", " "}, {";", " "},
            {":", " "},     {" ", " "},        {"!", ""},  {"{", "{"},    {"}", "}"}};
        std::istringstream left(
            "alpha α beta β gamma γ delta δ epsilon ε varepsilon ε zeta ζ eta η theta θ kappa κ lambda λ mu μ "
            "nu ν xi ξ pi π rho ρ sigma σ tau τ phi φ psi ψ omega ω Phi Φ Psi Ψ Sigma Σ Delta Δ Lambda Λ Theta Θ "
            "top ᵀ infty ∞ le ≤ leq ≤ ge ≥ geq ≥ ne ≠ neq ≠ ll ≪ gg ≫ approx ≈ sim ~ lesssim ≲ gtrsim ≳ propto ∝ "
            "pm ± cdot · times × to → rightarrow → Rightarrow ⇒ Longrightarrow ⟹ in ∈ sum Σ prod Π sqrt √ "
            "ldots … dots … cdots … lfloor ⌊ rfloor ⌋ ell ℓ partial ∂ ");
        for (std::string name, text; left >> name >> text;) out[name] = text;
        return out;
    }();
    return list;
}

/// Reads LaTeX from `at` on; writes text.
class Reader {
    std::string_view tex_;
    size_t at_ = 0;

    std::string command() {  // after the backslash
        size_t end = at_;
        while (end < tex_.size() && ((tex_[end] >= 'a' && tex_[end] <= 'z') || (tex_[end] >= 'A' && tex_[end] <= 'Z')))
            ++end;
        if (end == at_ && end < tex_.size()) ++end;
        std::string_view const name = tex_.substr(at_, end - at_);
        at_ = end;
        if (name == "frac" || name == "tfrac" || name == "dfrac") {
            std::string const over = argument(), under = argument();
            return grouped(over) + "/" + grouped(under);
        }
        if (name == "begin" || name == "end") return argument(), "";
        if (name == "sqrt") return "√" + grouped(argument());
        if (name == "hat") return argument() + "̂";
        if (name == "tilde") return argument() + "̃";
        if (name == "bar") return argument() + "̄";
        for (std::string_view const known :
             {"text", "mathrm", "mathbf", "operatorname", "underbrace", "overbrace", "mathit"})
            if (name == known) return argument();
        for (std::string_view const size : {"left", "right", "big", "Big", "bigl", "bigr", "Bigl", "Bigr", "Bigg", "rm",
                                            "bf", "limits", "displaystyle"})
            if (name == size) return "";
        if (name == "\n") return " ";
        auto const found = words().find(name);
        return found == words().end() ? std::string(name) : found->second;
    }
    /// A group without its braces, or one symbol.
    std::string argument() {
        while (at_ < tex_.size() && (tex_[at_] == ' ' || tex_[at_] == '\n')) ++at_;
        if (at_ >= tex_.size()) return "";
        if (tex_[at_] == '{') return ++at_, until_brace();
        if (tex_[at_] == '\\') return ++at_, command();
        size_t end = at_ + 1;
        while (end < tex_.size() && (static_cast<unsigned char>(tex_[end]) & 0xc0) == 0x80) ++end;
        std::string const out(tex_.substr(at_, end - at_));
        at_ = end;
        return out;
    }
    std::string until_brace() {
        std::string out;
        while (at_ < tex_.size() && tex_[at_] != '}') out += next();
        ++at_;
        return out;
    }
    std::string next() {
        char const c = tex_[at_++];
        if (c == '\\') return command();
        if (c == '{') return until_brace();
        if (c == '^' || c == '_') {
            std::string const of = argument();
            return of == "ᵀ" ? of : c + grouped(of);
        }
        if (c == '&' || c == '\n') return " ";
        if (c == '~') return " ";
        return std::string(1, c);
    }
    static std::string grouped(std::string const& text) {
        size_t symbols = 0;
        for (char const c : text) symbols += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
        bool const plain = text.find_first_of(" +-/=^,") == std::string::npos;
        return symbols <= 1 || plain ? text : "(" + text + ")";
    }

public:
    explicit Reader(std::string_view tex) : tex_(tex) {}
    std::string all() {
        std::string out;
        while (at_ < tex_.size())
            if (tex_[at_] == '}') ++at_;
            else out += next();
        return out;
    }
};

}  // namespace

std::string readable(std::string_view tex) {
    std::string out;
    for (char const c : Reader(tex).all())
        if (c != ' ' || (!out.empty() && !out.ends_with("  "))) out += c;
    while (out.ends_with(' ')) out.pop_back();
    return out;
}

}  // namespace rlslab::report
