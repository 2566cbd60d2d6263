// A map of words: what stands in its cells, and the lines between those whose words in a guide differ.
#include "tests/report/drawn.hpp"

namespace rlslab {
using namespace report;
using namespace drawn;
namespace {

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
