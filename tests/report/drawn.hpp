// What every test of drawings reads from an SVG: whether it is well formed, where its marks are, whether its texts fit.
#pragma once

#include "src/lab/report/axis.hpp"
#include "src/lab/report/page.hpp"
#include "src/lab/report/svg.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <cstring>

namespace rlslab::drawn {
using namespace report;

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

inline Figure one(std::vector<double> x, std::vector<double> y, bool log_x = false, bool log_y = false) {
    Figure out{.name = "f",
               .title = "title",
               .x = "abscissa",
               .y = "ordinate",
               .log_x = log_x,
               .log_y = log_y,
               .panels = {{"", {}, {}}}};
    out.panels[0].curves.push_back({.name = "curve", .look = look_of({}, 0), .x = std::move(x), .y = std::move(y)});
    return out;
}

/// Tags are closed in the order in which they were opened, attributes have quotes, no & stands alone. (std::regex
/// overflows the stack here.)
inline testing::AssertionResult well_formed(std::string const& xml) {
    auto const wrong = [](std::string_view tag) { return testing::AssertionFailure() << tag.substr(0, 200); };
    std::vector<std::string> open;
    for (size_t at = 0; (at = xml.find('<', at)) != std::string::npos;) {
        size_t const end = xml.find('>', at);
        if (end == std::string::npos) return wrong("an open tag at the end");
        std::string_view tag(xml.data() + at + 1, end - at - 1);
        at = end;
        bool const closes = tag.starts_with('/'), alone = tag.ends_with('/');
        if (alone) tag.remove_suffix(1);
        std::string const name(tag.substr(closes, std::min(tag.find(' '), tag.size()) - closes));
        std::string_view attributes = tag.substr(closes + name.size());
        while (!attributes.empty()) {  // NAME="VALUE" after NAME="VALUE", each with a space before it
            size_t const is = attributes.find("=\""), quote = is == tag.npos ? is : attributes.find('"', is + 2);
            if (attributes[0] != ' ' || quote == tag.npos) return wrong(tag);
            for (char const c : attributes.substr(1, is - 1))
                if (!std::isalpha(static_cast<unsigned char>(c)) && c != '-' && c != ':') return wrong(tag);
            if (attributes.substr(is + 2, quote - is - 2).find('<') != tag.npos) return wrong(tag);
            attributes.remove_prefix(quote + 1);
        }
        if (name.empty() || (closes && (open.empty() || open.back() != name))) return wrong(tag);
        if (closes) open.pop_back();
        else if (!alone) open.push_back(name);
    }
    for (size_t at = 0; (at = xml.find('&', at)) != std::string::npos; ++at) {
        std::string_view const rest = std::string_view(xml).substr(at + 1, 6);
        if (std::ranges::none_of(std::array{"amp;", "lt;", "gt;", "quot;", "#39;", "ensp;"},
                                 [&](char const* known) { return rest.starts_with(known); }))
            return wrong(rest);
    }
    return open.empty() ? testing::AssertionSuccess() : wrong("not closed: " + open.back());
}

struct Place {
    double x, y;
};
/// The absolute places in a path: after M and L.
inline void add_places(std::vector<Place>& out, std::string_view path) {
    for (size_t at = 0; (at = path.find_first_of("ML", at)) != path.npos;) {
        char* end = nullptr;
        double const x = std::strtod(path.data() + at + 1, &end), y = std::strtod(end, &end);
        out.push_back({x, y});
        at = size_t(end - path.data());
    }
}
/// The corners of the panel's frame, and every absolute place in the paths of its series (not of their names, which
/// stand beside it).
inline std::vector<Place> places(std::string const& text, Place& low, Place& high) {
    size_t const frame_end = text.find("Z\" fill=\"none\" stroke=\"#888\""), frame = text.rfind("\"M", frame_end);
    EXPECT_NE(frame_end, text.npos);
    char* end = nullptr;
    low.x = std::strtod(text.c_str() + frame + 2, &end), low.y = std::strtod(end, &end);
    high.x = std::strtod(end + 1, &end), high.y = std::strtod(end + 1, &end);
    std::vector<Place> out;
    for (char const* group : {"<g class=\"s\" data-s", "<g class=\"s event\" data-s"})
        for (size_t at = 0; (at = text.find(group, at)) != text.npos;) {
            size_t const last = text.find('\n', at);  // a group is a line
            for (size_t d = at; (d = text.find(" d=\"", d)) < last;) {
                size_t const quote = text.find('"', d + 4);
                add_places(out, std::string_view(text).substr(d + 4, quote - d - 4));
                d = quote;
            }
            at = last;
        }
    return out;
}

/// Every text is inside a drawing so wide and high, by what its letters are about as wide as.
inline void texts_fit(std::string const& svg, double width, double height) {
    for (size_t at = 0; (at = svg.find("<text ", at)) != svg.npos; ++at) {
        size_t const close = svg.find('>', at);
        std::string const tag = svg.substr(at, close - at);
        std::string text = svg.substr(close + 1, svg.find("</text>", close) - close - 1);
        for (size_t open; (open = text.find('<')) != text.npos;) text.erase(open, text.find('>', open) - open + 1);
        for (auto const& [entity, plain] :
             {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "+"}})
            for (size_t e; (e = text.find(entity)) != text.npos;) text.replace(e, std::strlen(entity), plain);
        auto const number = [&](char const* name, double otherwise) {
            size_t const found = tag.find(name);
            return found == tag.npos ? otherwise : std::strtod(tag.c_str() + found + std::strlen(name), nullptr);
        };
        bool const upright = tag.find("rotate(-90)") != tag.npos, slanted = tag.find("rotate(-35)") != tag.npos;
        double const size = number("font-size=\"", 12), length = size * text_width(text) * (slanted ? 0.82 : 1);
        size_t const place = tag.find("translate(");
        char* end = nullptr;
        double const x = place == tag.npos ? number(" x=\"", -1) : std::strtod(tag.c_str() + place + 10, &end);
        double const y = place == tag.npos ? number(" y=\"", -1) : std::strtod(end, nullptr);
        double const before = tag.find("\"end\"") != tag.npos      ? length
                              : tag.find("\"middle\"") != tag.npos ? length / 2
                                                                   : 0;
        EXPECT_GE((upright ? height - y : x) - before, -0.5) << text;
        EXPECT_LE((upright ? height - y : x) - before + length, (upright ? height : width) + 0.5) << text;
        EXPECT_GE(upright ? x : y, 0.6 * size) << text;
        EXPECT_LE(upright ? x : y, upright ? width : height) << text;
    }
}

/// The tags alone.
inline std::string without_texts(std::string const& xml) {
    std::string out;
    for (size_t at = 0; at < xml.size();) {
        size_t const tag = std::min(xml.find('<', at), xml.size()), end = std::min(xml.find('>', tag), xml.size());
        out += xml.substr(tag, end - tag);
        at = end;
    }
    return out;
}

/// All that holds of the drawing of any figure. Returns how many places are drawn.
inline size_t lawful(Figure const& figure) {
    size_t count = 0;
    for (size_t i = 0; i < figure.panels.size(); ++i) {
        std::string const text = panel_svg(figure, i, 520, 350);
        EXPECT_TRUE(well_formed(text));
        std::string const bare = without_texts(text);
        texts_fit(text, 520, 350);
        EXPECT_EQ(bare.find("nan"), std::string::npos);
        EXPECT_EQ(bare.find("inf"), std::string::npos);
        EXPECT_EQ(bare.find("e+"), std::string::npos);
        Place low, high;
        for (Place const& p : places(text, low, high)) {
            EXPECT_THAT(p.x, testing::AllOf(testing::Ge(low.x - 0.11), testing::Le(high.x + 0.11)));
            EXPECT_THAT(p.y, testing::AllOf(testing::Ge(low.y - 0.11), testing::Le(high.y + 0.11)));
            ++count;
        }
        EXPECT_LT(low.x, high.x);
        EXPECT_LT(low.y, high.y);
    }
    EXPECT_TRUE(well_formed(svg(figure)));
    EXPECT_TRUE(well_formed(figure_html(figure)));
    return count;
}

}  // namespace rlslab::drawn
