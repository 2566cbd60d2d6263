// Laws of every drawing, whatever the numbers: inside its panel, no NaN, well formed, of bounded size. Of pages, of
// names at their marks, of points below the axis.
#include "tests/report/drawn.hpp"
#include "src/lab/report/plot.hpp"

#include <rlslab/core/random.hpp>

#include <cmath>
#include <set>

namespace rlslab {
using namespace report;
using namespace drawn;
namespace {

TEST(Decades, AreLog10AndExactEnoughAtPowersOfTen) {
    Seed seed{1};
    for (int i = 0; i < 100000; ++i) {
        double const x = std::ldexp(1 + seed.uniform(), int(seed.uniform() * 2000) - 1000);
        long double const exact = std::log10(static_cast<long double>(x));
        ASSERT_NEAR(decades(x), double(exact), 4 * 0x1p-52 * std::max(1.0, double(std::abs(exact)))) << x;
    }
    for (int k = -307; k <= 308; ++k)
        EXPECT_NEAR(decades(std::stod("1e" + std::to_string(k))), k, 4 * 0x1p-52 * std::max(1, std::abs(k)));
    EXPECT_EQ(decades(1), 0);
    EXPECT_NEAR(decades(5e-324), -323.306215343115980, 1e-12);
}

void ticks_are_lawful(Range range, bool logarithmic, int about) {
    SCOPED_TRACE(testing::Message() << range.low << " ... " << range.high << (logarithmic ? ", logarithmic" : "")
                                    << ", about " << about);
    Axis axis(range, logarithmic, 0.03);
    axis.place(0, 1);
    Ticks const ticks = axis.ticks(about);
    std::set<std::pair<std::string, std::string>> texts;
    size_t labelled = 0;
    for (size_t i = 0; i < ticks.all.size(); ++i) {
        Tick const& tick = ticks.all[i];
        if (i > 0) {
            EXPECT_LT(ticks.all[i - 1].value, tick.value);
        }
        EXPECT_THAT(axis(tick.value), testing::AllOf(testing::Ge(-1e-6), testing::Le(1 + 1e-6))) << tick.value;
        if (tick.text.empty()) continue;
        ++labelled;
        EXPECT_TRUE(texts.emplace(tick.text, tick.power).second) << tick.text << " twice";
    }
    EXPECT_LE(labelled, size_t(about) + 2);
    EXPECT_LE(ticks.all.size(), 90u);
}
TEST(Ticks, AscendInsideTheRangeEachWithItsOwnLabel) {
    Seed seed{2};
    for (int i = 0; i < 4000; ++i) {
        double const size = std::ldexp(1 + seed.uniform(), int(seed.uniform() * 1900) - 950),
                     middle = (seed.uniform() - 0.5) * 40 * size;
        int const about = 3 + int(seed.uniform() * 9);
        ticks_are_lawful({middle, middle + size}, false, about);
        ticks_are_lawful({size, size * std::ldexp(1 + seed.uniform(), int(seed.uniform() * seed.uniform() * 60))}, true,
                         about);
    }
    for (bool const logarithmic : {false, true})
        for (Range const& range :
             {Range{}, Range{1, 1}, Range{1e-300, 1e300}, Range{5e-324, 1.7e308}, Range{1, std::nextafter(1.0, 2.0)},
              Range{1e9, 1e9 + 1}, Range{5e-324, 5e-324}, Range{1e-310, 3e-310}, Range{1, 10}, Range{0.99, 101},
              Range{2, 7}, Range{3, 4}, Range{1.7e308, 1.79e308}})
            ticks_are_lawful(range, logarithmic, 6);
    for (Range const& range : {Range{0, 0}, Range{-1.7e308, 1.7e308}, Range{-5e-324, 5e-324}, Range{-1, 1e-300}})
        ticks_are_lawful(range, false, 6);
}
TEST(Ticks, AreWhatPeopleWouldChoose) {
    auto const texts = [](Range range, bool logarithmic, int about) {
        std::vector<std::string> out;
        for (Tick const& tick : Axis(range, logarithmic, 0).ticks(about).all)
            if (!tick.text.empty()) out.push_back(tick.text + (tick.power.empty() ? "" : "^" + tick.power));
        return out;
    };
    EXPECT_THAT(texts({0, 1}, false, 5), testing::ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
    EXPECT_THAT(texts({-30, 20}, false, 6), testing::ElementsAre("−30", "−20", "−10", "0", "10", "20"));
    EXPECT_THAT(texts({0, 30000}, false, 3), testing::ElementsAre("0", "10\u2009000", "20\u2009000", "30\u2009000"));
    EXPECT_THAT(texts({1e-16, 1}, true, 6),
                testing::ElementsAre("10^−15", "10^−12", "10^−9", "10^−6", "10^−3", "10^0"));
    EXPECT_THAT(texts({1, 1000}, true, 6), testing::ElementsAre("1", "10", "100", "1000"));
    EXPECT_EQ(Axis({0, 4e7}, false, 0).ticks(5).left_out, 7);
    EXPECT_THAT(texts({0, 4e7}, false, 5), testing::ElementsAre("0", "1", "2", "3", "4"));
}

TEST(Drawing, OfNothingOrOnePointIsLawful) {
    lawful(Figure{.name = "f", .title = "t", .x = "x", .y = "y", .panels = {}});
    lawful(Figure{.name = "f", .title = "t", .x = "x", .y = "y", .panels = {{"p", {}, {}}}});
    EXPECT_EQ(lawful(one({}, {})), 0u);
    EXPECT_THAT(panel_svg(one({}, {}), 0, 520, 350), testing::HasSubstr("no number to draw"));
    for (bool const logarithmic : {false, true}) EXPECT_EQ(lawful(one({3}, {4}, logarithmic, logarithmic)), 1u);
    EXPECT_EQ(lawful(one({nan, infinity, 1}, {1, 1, -infinity})), 0u);
    Figure cells = one({}, {});
    cells.cells = true;
    lawful(cells);
}
TEST(Drawing, LeavesOutWhatALogarithmicAxisCannotShow) {
    Figure figure = one({1, 2, 3, 4, 5, 6}, {1, 0, -1, nan, infinity, 10}, true, true);
    figure.panels[0].curves[0].line = false;
    EXPECT_EQ(lawful(figure), 2u);
    figure.panels[0].curves[0].x[0] = 0;
    EXPECT_EQ(lawful(figure), 1u);
}
TEST(Drawing, BreaksALineAtANumberItCannotShow) {
    std::string const text = panel_svg(one({1, 2, 3, 4, 5}, {1, 2, nan, 2, 1}), 0, 520, 350);
    size_t const line = text.find("\" fill=\"none\" stroke=\"#0072b2\""), from = text.rfind("d=\"", line);
    std::string const path = text.substr(from, line - from);
    EXPECT_EQ(std::ranges::count(path, 'M'), 2) << path;
    EXPECT_EQ(std::ranges::count(path, 'L'), 2) << path;
}
TEST(Drawing, ShowsAnyFiniteNumber) {
    std::vector<double> const all{-1.79e308, -1e300, -1, -1e-300, -5e-324, 0, 5e-324, 1e-300, 1, 1e300, 1.79e308};
    EXPECT_GE(lawful(one(all, all)), 6u);  // the small ones share a place
    EXPECT_GE(lawful(one(all, all, true, true)), 5u);
    Seed seed{3};
    for (int i = 0; i < 150; ++i) {
        std::vector<double> x, y, low, high;
        for (int k = 0; k < 12; ++k) {
            auto const draw = [&] {
                double const u = seed.uniform();
                if (u < 0.05) return std::array{nan, infinity, -infinity, 0.0}[size_t(seed.uniform() * 4)];
                return (seed.uniform() < 0.3 ? -1 : 1) *
                       std::ldexp(1 + seed.uniform(), int((seed.uniform() - 0.5) * (i % 3 ? 20 : 2000)));
            };
            x.push_back(draw()), y.push_back(draw()), low.push_back(draw()), high.push_back(draw());
        }
        Figure figure = one(x, y, i % 2, i % 4 / 2);
        Panel& panel = figure.panels[0];
        panel.curves[0].lower = low, panel.curves[0].upper = high, panel.curves[0].bars = i % 5 == 0,
        panel.curves[0].stems = i % 6 == 0;
        panel.guides.push_back({.name = "guide", .look = {"#555555", true}, .x = x, .y = high});
        panel.events = {{.x = x[3], .text = "held out"}, {.x = x[4], .y = y[4], .text = "broken", .series = "curve"}};
        figure.square = i % 7 == 0;
        figure.names = i % 2;
        lawful(figure);
    }
}
/// A figure with these words wherever a figure has some.
Figure full_of(std::string const& text) {
    Figure out = one({1, 2, 3}, {1e-7, 2, 3e5}, false, true);
    out.title = out.x = out.y = out.series = out.note = text;
    Panel& panel = out.panels[0];
    panel.name = panel.curves[0].name = text;
    panel.curves[0].says = {text, text, text};
    panel.curves.push_back({.name = text + "1", .look = look_of({}, 1), .x = {1, 3}, .y = {1, 2}});
    panel.events = {{.x = 1.4, .text = text}, {.x = 2.9, .text = text}, {.x = 2, .y = 2, .text = text, .series = text}};
    return out;
}
TEST(Drawing, HoldsAndEscapesEveryTextHoweverLong) {
    std::string const words = "a rather long sentence that has to be broken into lines, ", endless(300, 'm');
    for (std::string const& text : {words + words + words + words + words + words, endless, words + endless,
                                    std::string("short"), std::string("<script>alert(\"1\")</script> & 'x' \x01 \n")}) {
        Figure figure = full_of(text);
        for (bool const names : {false, true}) {
            figure.names = names;
            lawful(figure);
            texts_fit(panel_svg(figure, 0, 400, 330), 400, 330);
        }
        EXPECT_EQ((svg(figure) + figure_html(figure)).find("<script"), std::string::npos);
        figure.x_names = {text, text + "1", text + "2", text + "3"};
        lawful(figure);
        figure.x_names.clear(), figure.cells = true, figure.log_y = false;
        figure.panels[0].curves[0].row = {text, text + "1", text};
        lawful(figure);
    }
}
TEST(Drawing, ALegendOfManyCurvesStandsBesideThePanelInTheOrderOfTheirEnds) {
    Figure figure = one({1, 2, 3}, {1, 2, 5});
    for (int n = 0; n < 40; ++n) {
        lawful(figure);
        figure.panels[0].curves.push_back({.name = "curve " + std::to_string(n),
                                           .look = look_of({}, size_t(n)),
                                           .x = {1, 3},
                                           .y = {1.0 * n, 1.0 * n}});
    }
    std::string html = figure_html(figure);
    EXPECT_THAT(html, testing::HasSubstr("class=\"beside\""));
    EXPECT_LT(html.find("<span data-s=\"40\""), html.find("<span data-s=\"7\""));  // curve 39, at the top
    EXPECT_LT(html.find("<span data-s=\"7\""),
              html.find("<span data-s=\"0\""));  // curve 6, over the one that ends at 5
    figure.panels.push_back(figure.panels[0]);
    html = figure_html(figure);
    EXPECT_THAT(html, testing::Not(testing::HasSubstr("beside")));
    EXPECT_LT(html.find("<span data-s=\"0\""), html.find("<span data-s=\"1\""));
}
TEST(Drawing, OfAMillionPointsIsSmallAndKeepsItsExtremes) {
    std::vector<double> x, y;
    Seed seed{4};
    for (int i = 0; i < 1000000; ++i) x.push_back(i), y.push_back(seed.uniform());
    y[123456] = 5, y[654321] = -5;
    Figure figure = one(x, y);
    std::string const text = panel_svg(figure, 0, 1040, 440);
    EXPECT_LT(text.size(), 150000u);
    Place low, high;
    double top = infinity, bottom = 0;
    for (Place const& p : places(text, low, high)) top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    EXPECT_LT(top - low.y, 25);
    EXPECT_LT(high.y - bottom, 25);
    figure.panels[0].curves[0].line = false;
    EXPECT_LT(panel_svg(figure, 0, 520, 350).size(), 6000000u);
}
TEST(Drawing, SharesTheRangeOfYUnlessAPanelHasItsOwn) {
    Figure figure = one({0, 1}, {0, 1});
    figure.panels.push_back(figure.panels[0]);
    figure.panels[1].curves[0].y = {0, 1000};
    Place low, high;
    auto const height = [&](size_t panel) {
        std::vector<Place> const p = places(panel_svg(figure, panel, 520, 350), low, high);
        double top = infinity;
        for (Place const& place : p) top = std::min(top, place.y);
        return (high.y - top) / (high.y - low.y);
    };
    EXPECT_LT(height(0), 0.1);
    EXPECT_GT(height(1), 0.9);
    figure.own_y = true;
    EXPECT_GT(height(0), 0.9);
}
TEST(Drawing, ASquareAxisHasOneUnit) {
    Figure figure = one({-1, 1, 1, -1}, {-1, -1, 1, 1});
    figure.square = true;
    Place low, high;
    Range x, y;
    for (Place const& p : places(panel_svg(figure, 0, 1040, 440), low, high)) x.add(p.x), y.add(p.y);
    EXPECT_NEAR(x.high - x.low, y.high - y.low, 0.3);
}
TEST(Drawing, ASeriesHasOneNumberInLegendAndPanels) {
    Figure figure = one({1, 2}, {1, 2});
    figure.panels[0].curves.push_back({.name = "other", .look = look_of({}, 1), .x = {1}, .y = {2}});
    figure.panels[0].guides.push_back({.name = "guide", .look = {"#555555", true}, .x = {1, 2}, .y = {1, 1}});
    std::string const html = figure_html(figure);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(legend_of(figure)[i]->name, std::vector<std::string>({"curve", "other", "guide"})[i]);
        EXPECT_THAT(html, testing::HasSubstr("<span data-s=\"" + std::to_string(i) + "\">"));
        EXPECT_THAT(html, testing::HasSubstr("<g class=\"s\" data-s=\"" + std::to_string(i) + "\">"));
    }
}

TEST(Pages, LoadNothing) {
    std::string const text = page("a < b", figure_html(one({1, 2}, {1, 2})) + formula_html("x") +
                                               table_html({"a", "<b>"}, {{"1", "&"}, {"★ 3", "4"}}, {1}));
    for (char const* address : {"src=", "@import", "url(", "<link", "fetch("})
        EXPECT_EQ(text.find(address), std::string::npos) << address;
    EXPECT_THAT(text, testing::HasSubstr("<title>a &lt; b</title>"));
    EXPECT_THAT(text, testing::HasSubstr("<th>&lt;b&gt;</th>"));
    EXPECT_THAT(text, testing::HasSubstr("<tr><td>1</td>"));
    EXPECT_THAT(text, testing::HasSubstr("<tr class=\"strong\"><td>★ 3</td>"));
}

// --- names, points below the axis, emphasised curves -----------------------------------------------------------------

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
// --- a map of words: what stands in its cells, and the lines between those whose words in a guide differ -----------

TEST(Drawing, AMapOfWordsHasThemInItsCellsAndLinesWhereAGuidesDiffer) {
    Figure figure = one({1, 2, 1, 2}, {1, 0.5, 0.25, 0});
    figure.cells = true;
    Curve& cells = figure.panels[0].curves[0];
    cells.row = {"low", "low", "high", "high"};
    cells.says = {"S", "<", "F", "SF"};
    figure.panels[0].guides.push_back(cells);
    auto const borders = [&](std::vector<std::string> const& says) {
        figure.panels[0].guides[0].says = says;
        lawful(figure);
        std::string const text = svg(figure);
        EXPECT_THAT(text, testing::HasSubstr(">SF</text>"));
        EXPECT_THAT(text, testing::HasSubstr(">&lt;</text>"));
        size_t const at = text.find("#d55e00");
        if (at == std::string::npos) return ptrdiff_t(0);
        size_t const path = text.rfind("d=\"", at);
        return std::count(text.begin() + ptrdiff_t(path), text.begin() + ptrdiff_t(at), 'M');
    };
    EXPECT_EQ(borders({"S", "S", "S", "S"}), 0);
    EXPECT_EQ(borders({"S", "F", "S", "S"}), 2);
    EXPECT_EQ(borders({"S", "F", "F", "S"}), 4);
    EXPECT_EQ(borders({"S", "F"}), 1);
}

}  // namespace
}  // namespace rlslab
