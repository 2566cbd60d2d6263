// Separators and decimal marks are found out, or given. A file that can be read in two ways, or is no table, is refused
// in a line that names the remedy, unless another cell says which it is.
#include "tests/input/read_text.hpp"

#include <fmt/format.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

namespace rlslab {
namespace {

using namespace text_files;

// --- decimal commas --------------------------------------------------------------------------------------------------

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
    EXPECT_THAT(refusal("u;y\n1;2\n1,5;2.5\n", {"u", "y"}), Names("data.csv:3 2 y 3 2.5"));
    EXPECT_THAT(refusal("u;y\n1.5;2\n1;2,5\n", {"u", "y"}), Names("data.csv:3 2 y 2,5"));
    EXPECT_EQ(refusal("u;y\n1.5;2\n1;2,5\n", {"y"}), "no error");  // of the requested columns
    EXPECT_THAT(refusal("u;y\n1,x;2\n", {"u"}), Names("data.csv:2 1 u 1,x"));
    EXPECT_THAT(refusal("1,5;-\n", {"2"}), Names("data.csv 2 1,5 -"));
}
TEST(DecimalComma, IsNotTakenForAMarkBetweenThousands) {
    EXPECT_THAT(refusal("u;y\n1,234;1\n2;2\n", {"u"}), Names("data.csv:2 1 u 1,234 --decimal"));
    EXPECT_EQ(read("u;y\n1,234;1\n2,5;2\n", {"u"})["u"], (Numbers{1.234, 2.5}));          // the next one tells
    EXPECT_EQ(read("u;y\n1,234;0,5\n", {"u", "y"})["u"], (Numbers{1.234}));               // or another column
    EXPECT_EQ(read("u;y\n0,123;1\n12,3456;1\n", {"u"})["u"], (Numbers{0.123, 12.3456}));  // no thousands there
    EXPECT_EQ(read("u;y\n-1,234;1\n", {"u"}, {.decimal = ','})["u"], (Numbers{-1.234}));
    EXPECT_THAT(refusal("u;y\n1,234;0.5\n", {"u", "y"}), Names("data.csv:2 1 u 1,234"));
    EXPECT_THAT(refusal("u;y\n2.5;1\n1,234;2\n", {"u"}), Names("data.csv:3 1 u 2 1,234"));
    EXPECT_THAT(refusal("u;y\n1,234;1\n", {"u"}, {.decimal = '.'}), Names("data.csv:2 1 u 1,234"));
    for (std::string const text : {"1,234,567", "1,234.5", "1.234,5", "1.234.567", "-12,345,678.25"})
        EXPECT_THAT(refusal("u;y\n" + text + ";1", {"u"}), Names("data.csv:2 1 u " + text));
    for (std::string const text : {"1,2,3", "1,23,456", "1.2,3", "1,234.5.6", ",", "1,,5", "1,-5"})
        EXPECT_THAT(refusal("u;y\n" + text + ";1", {"u"}), Names("data.csv:2 1 u " + text));
}

// --- separators ------------------------------------------------------------------------------------------------------

TEST(Separator, BlanksAnyNumberOfThem) {
    EXPECT_EQ(read("   u      y\n  1.5   -2e3\n\n  3 \t  4  \n", {"u", "y"}).values,
              (std::vector<Numbers>{{1.5, 3}, {-2000, 4}}));
    EXPECT_EQ(read("# by hand\n1 2\n3 4\n", {"2"})["2"], (Numbers{2, 4}));
    EXPECT_EQ(read("\"flow rate\" \"y\"\n1 2\n", {"flow rate"})["flow rate"], (Numbers{1}));
    EXPECT_EQ(read("u y\n1 NA\n", {"u"})["u"], (Numbers{1}));
    EXPECT_THAT(refusal("u y\n1 2\n3\n", {"u"}), Names("data.csv:3 2 1"));
    EXPECT_THAT(refusal("u y\n1 x\n", {"y"}), Names("data.csv:2 2 y x"));
}
TEST(Separator, ANameMayHoldBlanks) {
    EXPECT_EQ(read("flow rate\n1\n2\n", {"flow rate"})["flow rate"], (Numbers{1, 2}));
    EXPECT_EQ(read("flow rate, y\n1, 2\n", {"flow rate"})["flow rate"], (Numbers{1}));
    EXPECT_THAT(refusal("flow rate y\n1 2\n", {"y"}), Names("data.csv:1 3 2 --separator"));
    EXPECT_THAT(refusal("flow rate\n", {"flow rate"}), Names("data.csv flow rate"));
    EXPECT_THAT(refusal("u y\n#\n", {"u"}), Names("data.csv u y"));
}
TEST(Separator, ASpreadsheetsFirstLineNamesIt) {
    EXPECT_EQ(read("sep=;\r\nu,1;y\r\n1;2\r\n", {"u,1"})["u,1"], (Numbers{1}));
    EXPECT_EQ(read("\xef\xbb\xbf\"sep=\t\"\nu\ty\n1\t2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read("SEP=|\nu|y\n1,5|2\n", {"u"})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("sep=,\nu,y\n1,2\n", {"y"}).lines, (std::vector<long>{3}));
    EXPECT_THAT(refusal("sep=x\nu,y\n1,2\n", {"y"}), Names("data.csv:1 sep=x"));
    EXPECT_THAT(refusal("sep=;\n", {"y"}), Names("data.csv"));
    EXPECT_THAT(refusal("u;y\nsep=;1\n", {"u"}), Names("data.csv:2 1 u sep="));
}
TEST(Separator, GivenItIsObeyed) {
    EXPECT_EQ(read("sep=,\nu;y\n1,5;2\n", {"u"}, {.separator = ';'})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("a b\tc\n1 2\t3\n", {"c"}, {.separator = ' '})["c"], (Numbers{3}));
    EXPECT_EQ(read("u|y\n1|2\n", {"y"}, {.separator = '|'})["y"], (Numbers{2}));
    EXPECT_EQ(read("1,5\n2,5\n", {"1"}, {.decimal = ','})["1"], (Numbers{1.5, 2.5}));
    EXPECT_EQ(read("u\n1,5\n", {"u"}, {.decimal = ','})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("u,y\n\"1,5\",\"2,5\"\n", {"y"}, {.decimal = ','})["y"], (Numbers{2.5}));
    EXPECT_THAT(refusal("u;y\n1;2\n", {"u"}, {.separator = ','}), Names("data.csv u u;y"));
    EXPECT_THROW(read("u\n1\n", {"u"}, {.separator = 'x'}), std::invalid_argument);
    EXPECT_THROW(read("u\n1\n", {"u"}, {.decimal = ';'}), std::invalid_argument);
}
TEST(Separator, RowsTwiceAsLongAsTheHeaderSayWhy) {
    EXPECT_THAT(refusal("u,y\n1,5,2,5\n", {"u"}), Names("data.csv:2 2 1 4"));
}

// --- what is no text -------------------------------------------------------------------------------------------------

TEST(CsvRefuses, WhatOtherProgramsWrite) {
    EXPECT_THAT(refusal("\x1f\x8b\x08", {"u"}), Names("data.csv UTF-8 gzip"));
    EXPECT_THAT(refusal("PK\x03\x04", {"u"}), Names("data.csv UTF-8 CSV"));
    EXPECT_THAT(refusal("\xd0\xcf\x11\xe0", {"u"}), Names("data.csv UTF-8 CSV"));
    EXPECT_THAT(refusal(std::string("u\0,\0y\0\n\0", 8), {"u"}), Names("data.csv UTF-8 UTF-16LE iconv"));
    EXPECT_THAT(refusal(std::string("\0u\0,\0y\0\n", 8), {"u"}), Names("data.csv UTF-8 UTF-16BE iconv"));
    for (std::string const& text : {std::string("u\0\0\0,\0\0\0y\0\0\0", 12), std::string("\0\0\0u\0\0\0,", 8),
                                    std::string("\xff\xfe\0\0u\0\0\0", 8), std::string("\0\0\xfe\xff\0\0\0u", 8)})
        EXPECT_THAT(refusal(text, {"u"}), Names("data.csv UTF-8 UTF-32 iconv"));
    EXPECT_THAT(refusal(std::string("\0\0\0\0\n", 5), {"u"}), Names("data.csv:1 zero"));
}

RC_GTEST_PROP(Formats, WhatIsWrittenInAnyIsReadBitForBit, ()) {
    auto const flag = [] { return *rc::gen::arbitrary<bool>(); };
    std::size_t const columns = *rc::gen::inRange<std::size_t>(2, 5), rows = *rc::gen::inRange<std::size_t>(1, 12);
    char const separator = *rc::gen::element(';', '\t', ' ', '|'), decimal = *rc::gen::element('.', ',');
    bool const header = flag(), given = flag();
    std::string text = given || flag() ? "" : fmt::format("sep={}\r\n", separator);
    auto const between = [&](std::size_t j) {
        return j == 0             ? ""
               : separator == ' ' ? std::string(*rc::gen::inRange<std::size_t>(1, 4), ' ')
                                  : std::string(1, separator);
    };
    Words names;
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
    auto const data =
        read(text, names, {.separator = given ? separator : '\0', .decimal = doubt && flag() ? ',' : '\0'});
    RC_ASSERT(data.header == header);
    for (std::size_t j = 0; j < columns; ++j)
        RC_ASSERT(std::ranges::equal(data.values[j], table[j], [](double a, double b) {
            return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        }));
}

// --- a point that may stand between thousands ------------------------------------------------------------------------

TEST(PointOrThousands, IsRefusedWhereAnyColumnHasADecimalComma) {
    std::string const german = "druck;y;temp\n967;2908;20,69\n1.047;3148;15,63\n";
    EXPECT_THAT(refusal(german, {"druck", "y"}), Names("data.csv:3 1 druck 1.047 20,69 2 --decimal"));
    EXPECT_THAT(refusal(german, {"druck", "temp"}), Names("data.csv:3 1 druck 2 1.047"));
    EXPECT_EQ(read(german, {"druck"}, {.decimal = '.'})["druck"], (Numbers{967, 1.047}));
    EXPECT_EQ(read(german, {"y"})["y"], (Numbers{2908, 3148})) << "no number in doubt";
    // The comma comes after the number in doubt, in quotes, in a column of text, beside a number with a point.
    EXPECT_THAT(refusal("a,b\n1.047,x\n2,\"1,5\"\n", {"a"}), Names("data.csv:2 1 a 1.047 1,5 3 --decimal"));
    EXPECT_THAT(refusal("a b\n1.047 x\n2.5 1,5\n", {"a"}), Names("data.csv:2 1 a 1.047 1,5 3 --decimal"));
    EXPECT_THAT(refusal("a;b\n-1.047;1\n2;2,5\n", {"a", "b"}), Names("data.csv:2 1 a -1.047"));
}
TEST(PointOrThousands, IsRefusedWhereASemicolonSeparatesAndNothingSaysWhich) {
    auto const why = Names("data.csv:3 1 u 1.000 --decimal");
    EXPECT_THAT(refusal("u;y\n999;1\n1.000;2\n1.001;3\n", {"u"}), why);
    EXPECT_THAT(refusal("u;y\n999;1.234\n1.000;2\n", {"u"}), why) << "of a number that is not asked for";
    EXPECT_EQ(read("u;y\n999;1\n1.000;2\n", {"u"}, {.decimal = '.'})["u"], (Numbers{999, 1}));
    EXPECT_THAT(refusal("u;y\n999;1\n1.000;2\n", {"u"}, {.decimal = ','}), Names("data.csv:3 1 u 1.000"));
    EXPECT_THAT(refusal("u;y\n1,234;1\n1.234;2\n", {"u"}), Names("data.csv:2 1 u 1,234"));
}
/// Of cells that are no numbers to be read, in columns that are not asked for.
TEST(PointOrThousands, IsRefusedWhereANumberWithThousandsOrAUnitShowsTheComma) {
    for (std::string const separator : {"\t", ";"})
        for (std::string const shown : {"1.353,27", "-1.353,27", "1.234.567,5", "15,7 %", "3,25°C"})
            EXPECT_THAT(refusal("u" + separator + "t\n1.047" + separator + shown + "\n", {"u"}),
                        Names("data.csv:2 1 u 1.047 " + shown + " 2 --decimal"));
    EXPECT_THAT(refusal("u\tt\n1.047\t1.234.567\n", {"u"}), Names("data.csv:2 1 u 1.047 1.234.567 2 --decimal"));
    EXPECT_THAT(refusal("u,t\n1.047,\"1.353,27\"\n", {"u"}), Names("data.csv:2 1 u 1.047 1.353,27 2 --decimal"));
    for (std::string const shows_nothing :
         {"1.2.3", "12.03.2024", "192.168.0.1", "a,b", "1,2,3", "12:30", "1.234 kg", "3.5 %"})
        EXPECT_EQ(read("u\tt\n1.047\t" + shows_nothing + "\n", {"u"})["u"], (Numbers{1.047})) << shows_nothing;
}
TEST(PointOrThousands, IsAPointWhereAnotherNumberShowsIt) {
    EXPECT_EQ(read("u;y\n1.000;1\n2.5;2\n", {"u"})["u"], (Numbers{1, 2.5}));
    EXPECT_EQ(read("u;y\n1.000;0.125\n", {"u"})["u"], (Numbers{1})) << "in another column";
    for (std::string const shown : {"0.125", "1234.567", "1.5e3", ".5", "12.", "1.2345"})
        EXPECT_EQ(read("u;y\n1.000;" + shown + "\n", {"u"})["u"], (Numbers{1})) << shown;
    // Without a semicolon, and without a column that has whole numbers, too.
    EXPECT_EQ(read("t\tu\n1\t1.000\n2\t1.001\n", {"u"})["u"], (Numbers{1, 1.001}));
    EXPECT_EQ(read("u,y\n1.047,2.001\n", {"u"})["u"], (Numbers{1.047}));
    EXPECT_EQ(read("u\ty\n1.047\t2\n", {"u"})["u"], (Numbers{1.047}));
}
/// "1.047" among "967": who writes three decimals writes them in every row. The same behind every separator.
TEST(PointOrThousands, IsRefusedWhereAColumnHasWholeNumbersToo) {
    auto const table = [](char separator, std::vector<Words> const& rows) {
        std::string text;
        for (Words const& row : rows)
            for (size_t j = 0; j < row.size(); ++j) text += row[j] + (j + 1 < row.size() ? separator : '\n');
        return text;
    };
    for (char const separator : std::string(",;\t| ")) {
        std::vector<Words> const rows{{"u", "y"}, {"967", "3.384"}, {"1.047", "4.001"}};
        EXPECT_THAT(refusal(table(separator, rows), {"u"}), Names("data.csv:3 1 u 1.047 967 2 --decimal"));
        EXPECT_THAT(refusal(table(separator, rows), {"y"}), Names("data.csv:2 2 y 3.384 967 2 --decimal"));
        EXPECT_EQ(read(table(separator, rows), {"u"}, {.decimal = '.'})["u"], (Numbers{967, 1.047}));
        std::vector<Words> const decimals{{"u", "y"}, {"967", "3.38"}, {"1.047", "4.001"}};
        EXPECT_EQ(read(table(separator, decimals), {"u"})["u"], (Numbers{967, 1.047})) << "3.38 shows the point";
    }
    EXPECT_THAT(refusal("u\n999\n1.000\n1.001\n", {"u"}), Names("data.csv:3 1 u 1.000 999 2 --decimal"));
    EXPECT_THAT(refusal("u,y\n\"967\",\"-3.384\"\n\"1.047\",\"4.001\"\n", {"y"}), Names("data.csv:2 2 y -3.384"));
}
TEST(CommaOrThousands, AnyColumnShowsWhich) {
    EXPECT_EQ(read("u;y\n1,234;0,5\n", {"u"})["u"], (Numbers{1.234}));
    EXPECT_THAT(refusal("u;y\n1,234;0.5\n", {"u"}), Names("data.csv:2 1 u 1,234 0.5 2 --decimal"));
}

// --- blank lines in a file of one column -----------------------------------------------------------------------------

TEST(BlankLines, BetweenRowsOfOneColumnAreMissingValues) {
    Columns const data = read("u\n1\n\n2\n   \n\n3\n\n", {"u"});
    EXPECT_EQ(data.lines, (std::vector<long>{2, 3, 4, 5, 6, 7}));
    Numbers const u = data["u"];
    for (size_t k = 0; k < u.size(); ++k) EXPECT_EQ(std::isnan(u[k]), k == 1 || k == 3 || k == 4) << k;
    EXPECT_EQ(read("u,v\n1,1\n\n2,2\n", {"u"})["u"], (Numbers{1, 2})) << "of two columns a row would have a separator";
    EXPECT_EQ(read("u\n\n1\n2\n", {"u"})["u"], (Numbers{1, 2})) << "above the first row";
}

// --- what stands above the table -------------------------------------------------------------------------------------

TEST(Above, CommentsOfAnyProgramAreSkipped) {
    for (std::string const mark : {"#", "%", "//", "!"})
        EXPECT_EQ(read(mark + " by hand, 7\n" + mark + "\nu,y\n1,2\n", {"y"})["y"], (Numbers{2})) << mark;
    EXPECT_THAT(refusal("% a\n! b\n", {"u"}), Names("data.csv comments"));
}
TEST(Above, ACommentMayHaveTheNames) {
    for (std::string const mark : {"# ", "%", "// ", "!"}) {
        Columns const data = read("%\n" + mark + "u y\n1 2\n3 4\n", {"y", "u"});
        EXPECT_EQ(data.values, (std::vector<Numbers>{{2, 4}, {1, 3}})) << mark;
        EXPECT_EQ(data.lines, (std::vector<long>{3, 4}));
        EXPECT_EQ(read(mark + "u,y\n1,2\n", {"1"})["1"], (Numbers{1})) << "and numbers still are";
    }
    EXPECT_EQ(read("% load,name\n45,abc\n", {"% load"})["% load"], (Numbers{45})) << "a name that looks like one";
    EXPECT_THAT(refusal("# u u\n1 2\n", {"u"}), Names("data.csv:1 u 1 2"));
    EXPECT_THAT(refusal("# u y z\n1 2\n", {"u"}), Names("data.csv u 1 2"));
}
TEST(Above, LinesOfAnotherKindEndWhereTheNamesStand) {
    std::string const logger = "Logger: X100, \"v2\" of Mon 5 May\nSerial;1234\n\n\"Date\" 2024\n";
    Columns const data = read(logger + "t;Speed [rpm];u\n0;1,5;2\n1;3;4\n", {"Speed [rpm]", "u"});
    EXPECT_EQ(data.values, (std::vector<Numbers>{{1.5, 3}, {2, 4}}));
    EXPECT_EQ(data.lines, (std::vector<long>{6, 7}));
    EXPECT_EQ(read("a b c\nd e\nu y\n1 2\n", {"y"})["y"], (Numbers{2})) << "words over words";
    EXPECT_EQ(read("u is the voltage\nt,u\n1,2\n", {"u"})["u"], (Numbers{2}))
        << "a sentence has other cells than a row";
    EXPECT_EQ(read("Logger\nu\n1\n\n2\n", {"u"}).rows(), 3) << "a blank line of one column is a missing value";
    EXPECT_THAT(refusal(logger + "t;u\n0;1\n", {"v"}), Names("data.csv:1"));
    EXPECT_THAT(refusal("x\n1,2\n3,4\n", {"1", "2"}), Names("data.csv 1 x")) << "numbers are no names of a row below";
    EXPECT_THAT(refusal(logger + "t;u;u\n0;1;1\n", {"u"}), Names("data.csv:5 u 2 3"));
}
TEST(Separator, ABarIsFoundOut) {
    EXPECT_EQ(read("u|y\n1,5|2\n", {"u"})["u"], (Numbers{1.5}));
    EXPECT_EQ(read("1,5|2,5\n3,5|4,5\n", {"2"})["2"], (Numbers{2.5, 4.5}));
    EXPECT_EQ(read("|u|\n1\n", {"|u|"})["|u|"], (Numbers{1})) << "in names";
    EXPECT_EQ(read("|u|,|y|\n1,2\n", {"|y|"})["|y|"], (Numbers{2}));
}

// --- words for missing values ----------------------------------------------------------------------------------------

TEST(Missing, WordsAndNumbersMayBeDeclared) {
    CsvFormat const format{.missing = {"No Data", "-1.#ind", "-999"}};
    Numbers const u = read("u,y\nno data,1\n-1.#IND,2\n-999.0,3\n-999.5,4\n", {"u"}, format)["u"];
    ASSERT_EQ(u.size(), 4u);
    for (size_t k = 0; k < 3; ++k) EXPECT_TRUE(std::isnan(u[k])) << k;
    EXPECT_EQ(u[3], -999.5);
    EXPECT_FALSE(read("No Data,1\n2,3\n", {"2"}, format).header) << "no name";
    EXPECT_THAT(refusal("u,y\nNo Data,1\n", {"u"}), Names("data.csv:2 1 u No Data --missing"));
    EXPECT_THAT(refusal("u,y\n-1.#IND,1\n", {"u"}), Names("data.csv:2 1 u -1.#IND --missing"));
    EXPECT_EQ(refusal("u,y\n1.5D+3,1\n", {"u"}).find("--missing"), std::string::npos) << "a number of a kind";
}

/// Halves of a number with a decimal comma.
TEST(Missing, ANumberThatACommaPartedIsNamed) {
    CsvFormat const format{.missing = {"-999", "9"}};
    EXPECT_THAT(refusal("u;y\n1,5;2\n-999,9;3\n", {"u"}, format), Names("data.csv:3 1 u -999,9 --missing -999.9"));
    EXPECT_EQ(read("u;y\n1,5;2\n-999;3\n", {"y"}, format)["y"], (Numbers{2, 3})) << "two numbers";
    EXPECT_TRUE(std::isnan(read("u;y\n-999,9;2\n1,5;3\n", {"u"}, {.missing = {"-999.9"}})["u"][0]));
}
TEST(Above, ARuleUnderTheNamesIsNoRow) {
    Columns const data = read("| u | y |\n|---|:---|\n| 1 | 2 |\n| 3 | 4 |\n", {"u", "y"});
    EXPECT_EQ(data.values, (std::vector<Numbers>{{1, 3}, {2, 4}}));
    EXPECT_EQ(data.lines, (std::vector<long>{3, 4}));
    EXPECT_EQ(read("u y\n--- ---\n1 2\n", {"u"})["u"], (Numbers{1}));
    EXPECT_THAT(refusal("u,y\n1,2\n---,---\n", {"u"}), Names("data.csv:3 1 u ---")) << "between rows";
}

// --- a first row of numbers and text ---------------------------------------------------------------------------------

TEST(FirstRow, LikeTheNextHasNoNamesWhereColumnsAreAskedForByNumber) {
    std::string const dates = "2024-01-01,5,8\n2024-01-02,6,9\n";
    Columns const data = read(dates, {"3", "2"});
    EXPECT_FALSE(data.header);
    EXPECT_EQ(data.values, (std::vector<Numbers>{{8, 9}, {5, 6}}));
    EXPECT_EQ(data.lines, (std::vector<long>{1, 2}));
    EXPECT_THAT(refusal("2024-01-01,3,2\n2024-01-02,6,9\n", {"3", "2"}), Names("data.csv:1 3 2"));
    EXPECT_THAT(refusal("2024-01-01,2,8\n2024-01-02,6,9\n", {"2"}), Names("data.csv:1 2"));
    EXPECT_THAT(refusal(dates, {"1"}), Names("data.csv:1 1 2024-01-01"));
    EXPECT_THAT(refusal(dates, {"4"}), Names("data.csv 4 2024-01-01 5 8"));
    EXPECT_EQ(read("a 1\nb 2\n", {"2"})["2"], (Numbers{1, 2})) << "blanks separate: the row below was looked at before";
    EXPECT_EQ(read("\"x\ny\",1\n\"z\n\",2\n", {"2"})["2"], (Numbers{1, 2})) << "rows of several lines";
}
TEST(FirstRow, OfNamesStaysOne) {
    EXPECT_EQ(read("country,1990,1991\nFrance,1,2\n", {"1991"})["1991"], (Numbers{2})) << "years";
    EXPECT_EQ(read("k,2,1\n5,6,7\n", {"2"})["2"], (Numbers{6})) << "a name over a number";
    EXPECT_EQ(read("k,2,1\nNA,6,7\n", {"1"})["1"], (Numbers{7}));
    EXPECT_THAT(refusal("k,2,1\n", {"2"}), Names("data.csv k 2 1"));
    EXPECT_THAT(refusal("k,u\nx,5\n", {"2"}), Names("data.csv 2 k u"));
}

// --- ends of lines ---------------------------------------------------------------------------------------------------

TEST(LineEnds, ACarriageReturnAloneIsOne) {
    EXPECT_EQ(read("u,y\r1,2\r3,4\r", {"y"})["y"], (Numbers{2, 4}));
    EXPECT_EQ(read("# by hand\r\ru;y\r1,5;2\r3;4", {"u"}).lines, (std::vector<long>{4, 5}));
    EXPECT_THAT(refusal("u,y\r", {"u"}), Names("data.csv u y"));
}
TEST(LineEnds, TheFirstOneOutsideQuotesDecides) {
    EXPECT_EQ(read("\"a\rb\",y\n1,2\n", {"a\rb"})["a\rb"], (Numbers{1}));
    EXPECT_THAT(refusal("u,y\n1,2\r3,4\n", {"y"}), Names("data.csv:2 2 1 3"));
    EXPECT_EQ(read("u,y\r\r\n1,2\r\n", {"u"})["u"], (Numbers{1})) << "a carriage return too many";
    std::string const piece(1 << 16, '#');  // the end crosses chunks
    for (std::string const end : {"\r", "\r\n", "\n"})
        EXPECT_EQ(read(piece.substr(1) + end + "u" + end + "1" + end, {"u"})["u"], (Numbers{1}));
}

// --- what is no table ------------------------------------------------------------------------------------------------

TEST(NoTable, IsNamed) {
    auto const found = [](std::string const& begin) {
        std::string const text = refusal(begin + "\n1,2\n", {"u"}),
                          before = "data.csv: expected rows of numbers as UTF-8 text, found ";
        return text.starts_with(before) ? text.substr(before.size()) : text;
    };
    EXPECT_EQ(found("\x89PNG\r\n\x1a"), "a PNG image");
    EXPECT_EQ(found("%PDF-1.7"), "a PDF document");
    EXPECT_EQ(found("\xff\xd8\xff\xe0"), "a JPEG image");
    std::string const page = "a web page (HTML): save the table in it as CSV";
    for (std::string const begin : {"<!DOCTYPE html>", "<html lang=\"en\">", "\xef\xbb\xbf  <HTML>", "<table>"})
        EXPECT_EQ(found(begin), page);
    EXPECT_EQ(found("<?xml version=\"1.0\"?>"), "an XML file: save the table in it as CSV");
    EXPECT_EQ(found("PAR1,PAR2"), "data.csv: no column \"u\"; the columns are \"PAR1\", \"PAR2\"");
    EXPECT_EQ(found("<TICKER>,<PER>"), "data.csv: no column \"u\"; the columns are \"<TICKER>\", \"<PER>\"");
}

}  // namespace
}  // namespace rlslab
