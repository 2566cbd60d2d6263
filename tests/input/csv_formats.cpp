// Separators and decimal marks are found out, or given. A file that can be read in two ways is refused in a line that names the remedy.
#include "tests/input/csv_texts.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>

namespace rlslab {
namespace {

// --- decimal commas -------------------------------------------------------------------------------------------------------

TEST(DecimalComma, IsReadWhereItIsNoSeparator) {
    EXPECT_EQ(read("u;y\n1,5;-2,25e1\n3;,5\n4,;1234,5678\n", {"u", "y"}).values,
              (std::vector<Numbers>{{1.5, 3, 4}, {-22.5, .5, 1234.5678}}));
    EXPECT_EQ(read("u\ty\n1,5\t2\n", {"u"})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("1,5 2,5\n3,5 4,5\n", {"2"})["2"], (Numbers{2.5, 4.5}));
    EXPECT_EQ(read("u y\n1,5 2,5\n", {"y"})["y"], (Numbers{2.5}));
    EXPECT_EQ(read("u,y\n\"1,5e3\",\"2\"\n", {"u"})["u"], (Numbers{1500}));
    EXPECT_FALSE(read("1,5;2,5\n", {"1"}).header);
}
TEST(DecimalComma, OneMarkAFile) {
    EXPECT_EQ(refusal("u;y\n1;2\n1,5;2.5\n", {"u", "y"}), "data.csv:3: column 2 (y): expected a decimal comma as in line 3, found \"2.5\"");
    EXPECT_EQ(refusal("u;y\n1.5;2\n1;2,5\n", {"u", "y"}), "data.csv:3: column 2 (y): expected a decimal point as in line 2, found \"2,5\"");
    EXPECT_EQ(refusal("u;y\n1.5;2\n1;2,5\n", {"y"}), "no error");  // of what is asked for
    EXPECT_EQ(refusal("u;y\n1,x;2\n", {"u"}), "data.csv:2: column 1 (u): expected a number, found \"1,x\"");
    EXPECT_EQ(refusal("1,5;-\n", {"2"}), "data.csv: no column \"2\"; the columns are \"1,5\", \"-\"");
}
TEST(DecimalComma, IsNotTakenForAMarkBetweenThousands) {
    std::string const why =
        "data.csv:2: column 1 (u): \"1,234\" may be a decimal comma or a mark between thousands, and no number says which "
        "(--decimal , if it is the former)";
    EXPECT_EQ(refusal("u;y\n1,234;1\n2;2\n", {"u"}), why);
    EXPECT_EQ(read("u;y\n1,234;1\n2,5;2\n", {"u"})["u"], (Numbers{1.234, 2.5}));          // the next one tells
    EXPECT_EQ(read("u;y\n1,234;0,5\n", {"u", "y"})["u"], (Numbers{1.234}));               // or another column
    EXPECT_EQ(read("u;y\n0,123;1\n12,3456;1\n", {"u"})["u"], (Numbers{0.123, 12.3456}));  // no thousands there
    EXPECT_EQ(read("u;y\n-1,234;1\n", {"u"}, {.decimal = ','})["u"], (Numbers{-1.234}));
    EXPECT_EQ(refusal("u;y\n1,234;0.5\n", {"u", "y"}),
              "data.csv:2: column 1 (u): expected a number without marks between thousands, found \"1,234\"");
    EXPECT_EQ(refusal("u;y\n2.5;1\n1,234;2\n", {"u"}), "data.csv:3: column 1 (u): expected a decimal point as in line 2, found \"1,234\"");
    EXPECT_EQ(refusal("u;y\n1,234;1\n", {"u"}, {.decimal = '.'}), "data.csv:2: column 1 (u): expected a decimal point, found \"1,234\"");
    for (std::string const text : {"1,234,567", "1,234.5", "1.234,5", "1.234.567", "-12,345,678.25"})
        EXPECT_EQ(refusal("u;y\n" + text + ";1", {"u"}),
                  "data.csv:2: column 1 (u): expected a number without marks between thousands, found \"" + text + "\"");
    for (std::string const text : {"1,2,3", "1,23,456", "1.2,3", "1,234.5.6", ",", "1,,5", "1,-5"})
        EXPECT_EQ(refusal("u;y\n" + text + ";1", {"u"}), "data.csv:2: column 1 (u): expected a number, found \"" + text + "\"");
}

// --- separators -----------------------------------------------------------------------------------------------------------

TEST(Separator, BlanksAnyNumberOfThem) {
    EXPECT_EQ(read("   u      y\n  1.5   -2e3\n\n  3 \t  4  \n", {"u", "y"}).values, (std::vector<Numbers>{{1.5, 3}, {-2000, 4}}));
    EXPECT_EQ(read("# by hand\n1 2\n3 4\n", {"2"})["2"], (Numbers{2, 4}));
    EXPECT_EQ(read("\"flow rate\" \"y\"\n1 2\n", {"flow rate"})["flow rate"], (Numbers{1}));
    EXPECT_EQ(read("u y\n1 NA\n", {"u"})["u"], (Numbers{1}));
    EXPECT_EQ(refusal("u y\n1 2\n3\n", {"u"}), "data.csv:3: expected 2 columns as in line 1, found 1");
    EXPECT_EQ(refusal("u y\n1 x\n", {"y"}), "data.csv:2: column 2 (y): expected a number, found \"x\"");
}
TEST(Separator, ANameMayHoldBlanks) {
    EXPECT_EQ(read("flow rate\n1\n2\n", {"flow rate"})["flow rate"], (Numbers{1, 2}));
    EXPECT_EQ(read("flow rate, y\n1, 2\n", {"flow rate"})["flow rate"], (Numbers{1}));
    EXPECT_EQ(refusal("flow rate y\n1 2\n", {"y"}),
              "data.csv:1: expected as many names as cells below, found 3 words over 2 in line 2 (quote a name "
              "that holds blanks, or give the separator: --separator)");
    EXPECT_EQ(refusal("flow rate\n", {"flow rate"}),
              "data.csv: expected rows below the header, found none (the columns are \"flow rate\")");
    EXPECT_EQ(refusal("u y\n#\n", {"u"}), "data.csv: no column \"u\"; the columns are \"u y\"");
}
TEST(Separator, ASpreadsheetsFirstLineNamesIt) {
    EXPECT_EQ(read("sep=;\r\nu,1;y\r\n1;2\r\n", {"u,1"})["u,1"], (Numbers{1}));
    EXPECT_EQ(read("\xef\xbb\xbf\"sep=\t\"\nu\ty\n1\t2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read("SEP=|\nu|y\n1,5|2\n", {"u"})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("sep=,\nu,y\n1,2\n", {"y"}).lines, (std::vector<long>{3}));
    EXPECT_EQ(refusal("sep=x\nu,y\n1,2\n", {"y"}), "data.csv:1: expected sep= with a comma, semicolon, tab, bar or blank, found \"sep=x\"");
    EXPECT_EQ(refusal("sep=;\n", {"y"}), "data.csv: expected rows of numbers, found only comments and blank lines");
    EXPECT_EQ(refusal("u;y\nsep=;1\n", {"u"}), "data.csv:2: column 1 (u): expected a number, found \"sep=\"");
}
TEST(Separator, GivenItIsObeyed) {
    EXPECT_EQ(read("sep=,\nu;y\n1,5;2\n", {"u"}, {.separator = ';'})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("a b\tc\n1 2\t3\n", {"c"}, {.separator = ' '})["c"], (Numbers{3}));
    EXPECT_EQ(read("u|y\n1|2\n", {"y"}, {.separator = '|'})["y"], (Numbers{2}));
    EXPECT_EQ(read("1,5\n2,5\n", {"1"}, {.decimal = ','})["1"], (Numbers{1.5, 2.5}));
    EXPECT_EQ(read("u\n1,5\n", {"u"}, {.decimal = ','})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("u,y\n\"1,5\",\"2,5\"\n", {"y"}, {.decimal = ','})["y"], (Numbers{2.5}));
    EXPECT_EQ(refusal("u;y\n1;2\n", {"u"}, {.separator = ','}), "data.csv: no column \"u\"; the columns are \"u;y\"");
    EXPECT_THROW(read("u\n1\n", {"u"}, {.separator = 'x'}), std::invalid_argument);
    EXPECT_THROW(read("u\n1\n", {"u"}, {.decimal = ';'}), std::invalid_argument);
}
TEST(Separator, RowsTwiceAsLongAsTheHeaderSayWhy) {
    EXPECT_EQ(refusal("u,y\n1,5,2,5\n", {"u"}),
              "data.csv:2: expected 2 columns as in line 1, found 4 (decimal commas? they need another separator, or quotes)");
}

// --- what is no text --------------------------------------------------------------------------------------------------------

TEST(CsvRefuses, WhatOtherProgramsWrite) {
    EXPECT_EQ(refusal("\x1f\x8b\x08", {"u"}),
              "data.csv: expected rows of numbers as UTF-8 text, found gzip's compressed data: unpack them first");
    EXPECT_EQ(refusal("PK\x03\x04", {"u"}),
              "data.csv: expected rows of numbers as UTF-8 text, found a zip archive or a workbook: save the sheet as CSV");
    EXPECT_EQ(refusal("\xd0\xcf\x11\xe0", {"u"}),
              "data.csv: expected rows of numbers as UTF-8 text, found a workbook: save the sheet as CSV");
}

RC_GTEST_PROP(Formats, WhatIsWrittenInAnyIsReadBitForBit, ()) {
    auto const flag = [] { return *rc::gen::arbitrary<bool>(); };
    std::size_t const columns = *rc::gen::inRange<std::size_t>(2, 5), rows = *rc::gen::inRange<std::size_t>(1, 12);
    char const separator = *rc::gen::element(';', '\t', ' ', '|'), decimal = *rc::gen::element('.', ',');
    bool const header = flag(), given = separator == '|' || flag();
    std::string text = given || flag() ? "" : fmt::format("sep={}\r\n", separator);
    auto const between = [&](std::size_t j) {
        return j == 0 ? "" : separator == ' ' ? std::string(*rc::gen::inRange<std::size_t>(1, 4), ' ') : std::string(1, separator);
    };
    Names names;
    for (std::size_t j = 0; j < columns; ++j) names.push_back(header ? fmt::format("n{}", j) : std::to_string(j + 1));
    for (std::size_t j = 0; header && j < columns; ++j) text += between(j) + names[j];
    if (header) text += '\n';
    std::vector<Numbers> table(columns);
    for (std::size_t i = 0; i < rows; ++i, text += '\n')
        for (std::size_t j = 0; j < columns; ++j) {
            auto x = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>() * 0x9e3779b97f4a7c15u);
            if (!(std::abs(x) <= largest_value)) x = double(i);
            table[j].push_back(x);
            std::string cell = fmt::format("{:#}", x);  // with its mark, so that no cell is in doubt
            if (auto const at = cell.find('.'); at != cell.npos) cell[at] = decimal;
            text += between(j) + cell;
        }
    bool const doubt = decimal == ',';
    auto const data = read(text, names, {.separator = given ? separator : '\0', .decimal = doubt && flag() ? ',' : '\0'});
    RC_ASSERT(data.header == header);
    for (std::size_t j = 0; j < columns; ++j)
        RC_ASSERT(std::ranges::equal(data.values[j], table[j], [](double a, double b) {
            return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        }));
}

}  // namespace
}  // namespace rlslab
