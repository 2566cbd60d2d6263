// What a drawing shows besides its numbers: names at their marks, points below the axis, emphasised curves.
#include "tests/report/drawn.hpp"
#include "report/plot.hpp"

#include <rlslab/core/random.hpp>

namespace rlslab {
using namespace report;
using namespace drawn;
namespace {

/// Single points with names, as in a plot of cost against digits.
Figure named_points(std::vector<std::pair<double, double>> const& places, size_t name_length = 9) {
    Figure out{.name = "f", .title = "t", .x = "x", .y = "y", .panels = {{"", {}, {}}}};
    out.names = true;
    for (size_t i = 0; i < places.size(); ++i) {
        auto const [x, y] = places[i];
        std::string name = "n" + std::to_string(i);
        name.resize(name_length, 'o');
        out.panels[0].curves.push_back({.name = name,
                                        .look = look_of({}, i),
                                        .x = {x},
                                        .y = {y},
                                        .lower = {y - 0.3},
                                        .upper = {y + 0.2},
                                        .line = false,
                                        .bars = true});
    }
    return out;
}
struct Label {
    size_t series;
    plot::Box box;
};
/// From the drawing: each name's box, and each mark's place by the number of its series.
std::vector<Label> labels_of(std::string const& svg, std::vector<Place>& marks, size_t series) {
    auto const number = [&](std::string_view before, size_t from) {
        return std::strtod(svg.c_str() + svg.find(before, from) + before.size(), nullptr);
    };
    marks.assign(series, {});
    for (size_t i = 0; i < series; ++i) {
        size_t const group = svg.find("<g class=\"s\" data-s=\"" + std::to_string(i) + '"'),
                     tip = svg.find("\"><title>", group), path = svg.rfind("\"M", tip);
        char* end = nullptr;
        marks[i].x = std::strtod(svg.c_str() + path + 2, &end), marks[i].y = std::strtod(end, nullptr);
    }
    std::vector<Label> out;
    for (size_t at = 0; (at = svg.find("<g class=\"s name\"", at)) != svg.npos; ++at) {
        size_t const text = svg.find("<text", at), begin = svg.find('>', text) + 1;
        double const x = number(" x=\"", text), y = number(" y=\"", text);
        std::string const name = svg.substr(begin, svg.find('<', begin) - begin);
        bool const bold = svg.substr(text, begin - text).find("font-weight") != svg.npos;
        out.push_back(
            {size_t(number("data-s=\"", at)),
             {x, y + 2.6 - plot::name_height, x + plot::tick_size * text_width(name) * (bold ? 1.1 : 1), y + 2.6}});
    }
    return out;
}
TEST(Names, StandNearerToTheirOwnMarkThanToAnyOtherAndTouchNothing) {
    size_t placed = 0, left_out = 0;
    for (std::uint64_t const s : {1, 2, 3}) {
        Seed seed{s};
        for (size_t n = 1; n <= 24; ++n) {
            std::vector<std::pair<double, double>> places;
            double const crowd = n % 3 == 0 ? 0.1 : 1;  // a third of them in one corner
            for (size_t i = 0; i < n; ++i)
                places.emplace_back((i % 3 ? 1 : crowd) * seed.uniform(), (i % 3 ? 1 : crowd) * 10 * seed.uniform());
            Figure figure = named_points(places, 4 + size_t(seed.uniform() * 20));
            figure.panels[0].curves[0].strong = n % 2;
            lawful(figure);
            std::vector<Place> marks;
            std::vector<Label> const labels = labels_of(panel_svg(figure, 0, 520, 350), marks, n);
            EXPECT_LE(labels.size(), n);
            for (Label const& label : labels) {
                SCOPED_TRACE(testing::Message() << "seed " << s << ", " << n << " points, name " << label.series);
                Place const own = marks[label.series];
                for (size_t i = 0; i < n; ++i) {
                    double const distance = plot::distance2(label.box, marks[i].x, marks[i].y);
                    EXPECT_GE(distance, 25) << "over mark " << i;
                    if (i != label.series) {
                        EXPECT_LT(plot::distance2(label.box, own.x, own.y), distance + 2) << "nearer to mark " << i;
                    }  // rounded to tenths
                }
                for (Label const& other : labels)
                    EXPECT_TRUE(&other == &label || label.box.right <= other.box.left + 0.2 ||
                                other.box.right <= label.box.left + 0.2 || label.box.bottom <= other.box.top + 0.2 ||
                                other.box.bottom <= label.box.top + 0.2)
                        << "over name " << other.series;
            }
            placed += labels.size(), left_out += n - labels.size();
        }
    }
    EXPECT_GT(placed, 2 * left_out);
}
TEST(Names, StandBesideEveryMarkOfASparsePlotAndBesideNoneInOnePlace) {
    std::vector<Place> marks;
    auto const names = [&](Figure const& figure) { return labels_of(panel_svg(figure, 0, 520, 350), marks, 5).size(); };
    EXPECT_EQ(names(named_points({{0, 0}, {0, 5}, {1, 2}, {2, 0}, {2, 5}})), 5u);
    Figure const one_place = named_points(std::vector<std::pair<double, double>>(5, {1, 1}));
    EXPECT_EQ(names(one_place), 0u);
    EXPECT_THAT(figure_html(one_place), testing::HasSubstr("n4ooooooo</span> </p>")) << "the legend has them";
}

/// The mark of one series as a tooltip's path: where it stands; {-1, -1}: none says that.
Place place_of_tooltip(std::string const& svg, std::string const& words) {
    size_t const tip = svg.find("<title>" + words), path = tip == svg.npos ? tip : svg.rfind("\"M", tip);
    if (path == svg.npos) return {-1, -1};
    char* end = nullptr;
    double const x = std::strtod(svg.c_str() + path + 2, &end);
    return {x, std::strtod(end, nullptr)};
}
TEST(Drawing, ATriangleAtTheEdgeStandsForWhatIsBelowTheAxis) {
    Figure figure = one({0, 1, 2, 3}, {4, -30, -1e300, 3});
    Panel& panel = figure.panels[0];
    panel.y_least = -1;
    panel.curves.push_back({.name = "bars",
                            .look = look_of({}, 1),
                            .x = {1.5, 2.5},
                            .y = {2, -7},
                            .lower = {-9, -9},
                            .upper = {3, -5},
                            .line = false,
                            .bars = true});
    EXPECT_GE(lawful(figure), 8u);
    std::string const text = panel_svg(figure, 0, 520, 350);
    Place low, high;
    places(text, low, high);
    EXPECT_NEAR(place_of_tooltip(text, "curve: abscissa 1, ordinate -30, below the axis").y, high.y, 8);
    EXPECT_NEAR(place_of_tooltip(text, "bars: abscissa 2.5, ordinate -7 (-9 to -5), below the axis").y, high.y, 8);
    EXPECT_LT(place_of_tooltip(text, "curve: abscissa 3, ordinate 3").y, (low.y + high.y) / 2);
    EXPECT_EQ(place_of_tooltip(text, "curve: abscissa 3, ordinate 3, below").y, -1);
    // The axis ends there: 3 and 4 are distinguished as if nothing else were drawn.
    double const unit = place_of_tooltip(text, "curve: abscissa 3").y - place_of_tooltip(text, "curve: abscissa 0").y;
    EXPECT_GT(unit, 0.15 * (high.y - low.y));
    panel.y_least = -infinity;
    EXPECT_EQ(panel_svg(figure, 0, 520, 350).find("below the axis"), std::string::npos);
}
TEST(Drawing, WhatIsBelowALogarithmicAxisMayBeZero) {
    Figure figure = one({1, 2, 3}, {0.5, 1e-12, 0});
    figure.own_y = true;
    figure.panels[0].log_y = true, figure.panels[0].y_least = 1e-6, figure.panels[0].y_holds = {0.01, 1};
    figure.panels.push_back(figure.panels[0]);
    figure.panels[1].log_y = false, figure.panels[1].y_least = -infinity;
    EXPECT_GE(lawful(figure), 6u);
    std::string const text = panel_svg(figure, 0, 520, 350);
    EXPECT_NE(place_of_tooltip(text, "curve: abscissa 3, ordinate 0, below the axis").y, -1);
    EXPECT_THAT(text, testing::HasSubstr("against abscissa (y logarithmic)"));
    EXPECT_THAT(panel_svg(figure, 1, 520, 350), testing::Not(testing::HasSubstr("below the axis")));
}
TEST(Drawing, AStrongCurveIsThickOverTheOthersWhichAreFaint) {
    Figure figure = one({1, 2}, {1, 2});
    figure.panels[0].curves.push_back({.name = "other", .look = look_of({}, 1), .x = {1, 2}, .y = {2, 1}});
    std::string const equal = panel_svg(figure, 0, 520, 350);
    EXPECT_EQ(equal.find("opacity=\".5\""), equal.npos);
    figure.panels[0].curves[0].strong = true;
    std::string const text = panel_svg(figure, 0, 520, 350);
    size_t const curve = text.find("<g class=\"s\" data-s=\"0\">"),
                 other = text.find("<g class=\"s\" data-s=\"1\" opacity=\".5\">");
    ASSERT_NE(curve, text.npos);
    ASSERT_NE(other, text.npos);
    EXPECT_LT(other, curve);
    auto const width = [&](size_t group) {
        return std::strtod(text.c_str() + text.find("stroke-width=\"", group) + 14, nullptr);
    };
    EXPECT_GE(width(curve), 2 * width(other));
    EXPECT_THAT(figure_html(figure), testing::HasSubstr("<span data-s=\"0\" class=\"strong\">"));
    EXPECT_THAT(figure_html(figure), testing::HasSubstr("<span data-s=\"1\">"));
    lawful(figure);
}
TEST(Drawing, AStrongCategoryHasABandAndABoldName) {
    Figure figure = one({0, 1, 2}, {1, 2, 3});
    figure.x_names = {"conventional_two_sided", "★ ud", "qr"};
    EXPECT_EQ(panel_svg(figure, 0, 1040, 440).find("700"), std::string::npos);
    figure.strong_x = {1, 7};  // 7: no such category
    lawful(figure);
    std::string const text = panel_svg(figure, 0, 1040, 440);
    EXPECT_THAT(text, testing::HasSubstr("font-weight=\"700\">★ ud</text>"));
    EXPECT_THAT(text, testing::HasSubstr(">conventional_two_sided</text>"));
    EXPECT_EQ(text.find("<rect"), text.rfind("<rect"));
}
TEST(Pages, AStrongRowOfATableStandsOut) {
    std::string const text = table_html({"a", "b"}, {{"1", "2"}, {"★ 3", "4"}}, {1});
    EXPECT_THAT(text, testing::HasSubstr("<tr><td>1</td>"));
    EXPECT_THAT(text, testing::HasSubstr("<tr class=\"strong\"><td>★ 3</td>"));
}

}  // namespace
}  // namespace rlslab
