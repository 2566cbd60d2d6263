// Files that can be read in two ways, or are no tables: refused in a line that names the remedy, unless another cell says which it is.
#include "tests/files.hpp"

#include <rlslab/model/csv.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

using files::Folder, files::message_of;
using Names = std::vector<std::string>;
using Numbers = std::vector<double>;

Columns read(std::string const& text, Names const& asked, CsvFormat format = {}) {
    Folder const folder;
    return read_columns(folder.file(text), asked, format);
}
std::string refusal(std::string const& text, Names const& asked, CsvFormat format = {}) {
    Folder const folder;
    return folder.without(message_of([&] { read_columns(folder.file(text), asked, format); }));
}

// --- a point that may stand between thousands -------------------------------------------------------------------------------

std::string const or_point = " may be a decimal point or a mark between thousands, and ", way_out = " (--decimal . if it is the former)";

TEST(PointOrThousands, IsRefusedWhereAnyColumnHasADecimalComma) {
    std::string const german = "druck;y;temp\n967;2908;20,69\n1.047;3148;15,63\n";
    EXPECT_EQ(refusal(german, {"druck", "y"}),
              "data.csv:3: column 1 (druck): \"1.047\"" + or_point + "\"20,69\" in line 2 has a decimal comma" + way_out);
    EXPECT_EQ(refusal(german, {"druck", "temp"}), "data.csv:3: column 1 (druck): expected a decimal comma as in line 2, found \"1.047\"");
    EXPECT_EQ(read(german, {"druck"}, {.decimal = '.'})["druck"], (Numbers{967, 1.047}));
    EXPECT_EQ(read(german, {"y"})["y"], (Numbers{2908, 3148})) << "no number in doubt";
    // The comma comes after the number in doubt, in quotes, in a column of text, beside a number with a point.
    EXPECT_EQ(refusal("a,b\n1.047,x\n2,\"1,5\"\n", {"a"}),
              "data.csv:2: column 1 (a): \"1.047\"" + or_point + "\"1,5\" in line 3 has a decimal comma" + way_out);
    EXPECT_EQ(refusal("a b\n1.047 x\n2.5 1,5\n", {"a"}),
              "data.csv:2: column 1 (a): \"1.047\"" + or_point + "\"1,5\" in line 3 has a decimal comma" + way_out);
    EXPECT_EQ(refusal("a;b\n-1.047;1\n2;2,5\n", {"a", "b"}),
              "data.csv:2: column 1 (a): expected a number without marks between thousands, found \"-1.047\"");
}
TEST(PointOrThousands, IsRefusedWhereASemicolonSeparatesAndNothingSaysWhich) {
    std::string const why = "data.csv:3: column 1 (u): \"1.000\"" + or_point + "no number says which" + way_out;
    EXPECT_EQ(refusal("u;y\n999;1\n1.000;2\n1.001;3\n", {"u"}), why);
    EXPECT_EQ(refusal("u;y\n999;1.234.567\n1.000;2\n", {"u"}), why) << "of a number that is not asked for";
    EXPECT_EQ(read("u;y\n999;1\n1.000;2\n", {"u"}, {.decimal = '.'})["u"], (Numbers{999, 1}));
    EXPECT_EQ(refusal("u;y\n999;1\n1.000;2\n", {"u"}, {.decimal = ','}),
              "data.csv:3: column 1 (u): expected a decimal comma, found \"1.000\"");
    EXPECT_EQ(refusal("u;y\n1,234;1\n1.234;2\n", {"u"}),
              "data.csv:2: column 1 (u): expected a number without marks between thousands, found \"1,234\"");
}
TEST(PointOrThousands, IsAPointWhereAnotherNumberShowsIt) {
    EXPECT_EQ(read("u;y\n1.000;1\n2.5;2\n", {"u"})["u"], (Numbers{1, 2.5}));
    EXPECT_EQ(read("u;y\n1.000;0.125\n", {"u"})["u"], (Numbers{1})) << "in another column";
    for (std::string const shown : {"0.125", "1234.567", "1.5e3", ".5", "12.", "1.2345"})
        EXPECT_EQ(read("u;y\n1.000;" + shown + "\n", {"u"})["u"], (Numbers{1})) << shown;
    // Without a semicolon it stays what it was.
    EXPECT_EQ(read("u\n999\n1.000\n1.001\n", {"u"})["u"], (Numbers{999, 1, 1.001}));
    EXPECT_EQ(read("u,y\n1.047,2.001\n", {"u"})["u"], (Numbers{1.047}));
    EXPECT_EQ(read("u\ty\n1.047\t2\n", {"u"})["u"], (Numbers{1.047}));
}
TEST(CommaOrThousands, AnyColumnShowsWhich) {
    EXPECT_EQ(read("u;y\n1,234;0,5\n", {"u"})["u"], (Numbers{1.234}));
    EXPECT_EQ(refusal("u;y\n1,234;0.5\n", {"u"}),
              "data.csv:2: column 1 (u): \"1,234\" may be a decimal comma or a mark between thousands, and \"0.5\" in line 2 has a decimal "
              "point (--decimal , if it is the former)");
}

}  // namespace
}  // namespace rlslab
