// CSV files of many dialects are read bit for bit, and a file that cannot be read is refused in one clear line.
#include "tests/common/same.hpp"
#include "tests/input/read_text.hpp"

#include <fmt/format.h>
#include <rapidcheck/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <thread>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
using namespace text_files;
using files::Folder, files::message_of;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
std::string const bom = "\xef\xbb\xbf";

TEST(Csv, ReadsColumnsByNameInTheOrderAsked) {
    auto const data = read("u,y,z\n1,2,3\n4,5,6\n", {"z", "u"});
    EXPECT_TRUE(data.header);
    EXPECT_EQ(data.names, (Words{"z", "u"}));
    EXPECT_EQ(data["z"], (Numbers{3, 6}));
    EXPECT_EQ(data["u"], (Numbers{1, 4}));
    EXPECT_EQ(data.rows(), 2);
    EXPECT_THROW(data["y"], std::invalid_argument);
}

TEST(Csv, WithoutAHeaderColumnsAreNumbered) {
    auto const data = read("1,2\n3,4", {"2"});
    EXPECT_FALSE(data.header);
    EXPECT_EQ(data["2"], (Numbers{2, 4}));
    EXPECT_FALSE(read("NA,2\n3,4", {"1"}).header);  // missing is no name
    EXPECT_TRUE(read("1,y\n3,4", {"1"}).header);    // one word makes a header, and "1" is a name in it
}

TEST(Csv, FindsTheSeparatorOutsideQuotes) {
    EXPECT_EQ(read("u;y\n1;2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read("u\ty\n1\t2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read("\"u;\t\",y\n1,2\n", {"u;\t"})["u;\t"], (Numbers{1}));
    EXPECT_EQ(read("\"u\n,\";y\n1;2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read("5\" u,y\n1,2\n", {"5\" u"})["5\" u"], (Numbers{1}));
    EXPECT_EQ(read("u\n1\n2\n", {"u"})["u"], (Numbers{1, 2}));
}

TEST(Csv, SkipsWhatIsNoRowAndCountsItsLines) {
    auto const data = read(bom + "# made by hand\n\n#\r\nu,y\r\n1,2\r\n   \n\n3,4", {"y"});
    EXPECT_EQ(data["y"], (Numbers{2, 4}));
    EXPECT_EQ(data.lines, (std::vector<long>{5, 8}));
}

TEST(Csv, QuotedCellsHoldQuotesSeparatorsAndLineEnds) {
    auto const data =
        read("\"a \"\"b\"\"\", \"note\" ,y\r\n\"1\",\"one,\r\ntwo\n\n#three\",\" 2 \"\n3,,\"\"\n", {"a \"b\"", "y"});
    EXPECT_EQ(data["a \"b\""], (Numbers{1, 3}));
    EXPECT_TRUE(same(data["y"], {2, missing}));
    EXPECT_EQ(data.lines, (std::vector<long>{2, 6}));
}

TEST(Csv, ReadsNumbersAsPeopleWriteThem) {
    auto const data = read("x\n+1.5\n -2e3 \n.5\n5.\n-0\n1E-3\n9007199254740993\n4.9e-324\n3e150\n", {"x"});
    EXPECT_TRUE(same(data["x"], {1.5, -2000, .5, 5, -0., 1e-3, 9007199254740992, 0x1p-1074, 3e150}));
}

TEST(Csv, ReadsMissingValuesAsPeopleWriteThem) {
    auto const data = read("x,k\n,1\nNA,2\nNaN,3\nnan,4\nnull,5\n.,6\n?,7\n\"\",8\n-nan,9\n  ,10\nNULL,11", {"x"});
    EXPECT_EQ(data.rows(), 11);
    for (double const x : data["x"]) EXPECT_TRUE(std::isnan(x));
}

TEST(Csv, ColumnsNotAskedForMayHoldAnything) {
    auto const data = read("date,u,y\n2024-01-01,1,inf\nyesterday,2,1e999\n,3,\"a, b\"\n", {"u"});
    EXPECT_EQ(data["u"], (Numbers{1, 2, 3}));
}

TEST(Csv, KnowsItsNamesBeforeReadingAndReadsOnce) {
    Folder const folder;
    CsvFile file(folder.file(" u , \"y\"\n1,2\n"));
    EXPECT_TRUE(file.has_header());
    EXPECT_EQ(file.names(), (Words{"u", "y"}));
    EXPECT_EQ(file.read({"y"})["y"], (Numbers{2}));
    EXPECT_THROW(file.read({"y"}), std::invalid_argument);
    EXPECT_THROW(read("u,y\n1,2\n", {}), std::invalid_argument);
}

TEST(CsvRefuses, CellsThatAreNoNumbers) {
    EXPECT_THAT(refusal("t,u\n1,2\n\n2,abc\n", {"t", "u"}), Names("data.csv:4 2 u abc"));
    EXPECT_THAT(refusal("1,2\n2,abc\n", {"2"}), Names("data.csv:2 2 abc"));
    for (std::string const text : {"0x10", "1e", "1 2", "--1", "+-1", "1d5", "nan(1)", "-", "1.2.3", "1_000", "e5"})
        EXPECT_THAT(refusal("u\n" + text, {"u"}), Names("data.csv:2 1 u " + text));
    for (std::string const text : {"inf", "-Infinity", "+INF"})
        EXPECT_THAT(refusal(text + "\n1", {"1"}), Names("data.csv:1 1 " + text));
    for (std::string const text : {"3.3e150", "-1e200", "1e999", "1e-999"})
        EXPECT_THAT(refusal("u\n" + text, {"u"}), Names("data.csv:2 1 u 0 2^-1074 2^500 " + text));
}

TEST(CsvRefuses, GarbageShortenedAndPrintable) {
    EXPECT_THAT(refusal("u\n\x01\x1b[2J\xff"
                        "5\rh\xc3\xa9!",
                        {"u"}),
                Names("data.csv:2 1 u \\x01\\x1b[2J\\xff5\\x0dh\xc3\xa9!"));
    EXPECT_THAT(refusal("u\n" + std::string(1000000, 'a'), {"u"}), Names("data.csv:2 1 u " + std::string(40, 'a')));
    EXPECT_THAT(refusal("u\n\"a\nb\"", {"u"}), Names("data.csv:2 1 u a\\x0ab"));
    EXPECT_THAT(refusal("u\n1\n" + std::string("\0\0", 2), {"u"}), Names("data.csv:3 zero"));
    EXPECT_THAT(refusal("\xff\xfeu\n", {"u"}), Names("data.csv UTF-8 UTF-16"));
}

TEST(CsvRefuses, RaggedRows) {
    EXPECT_THAT(refusal("# c\nu,y,z\n1,2,3\n4,5\n", {"u"}), Names("data.csv:4 3 2"));
    EXPECT_THAT(refusal("1,2\n1,2,\n", {"1"}), Names("data.csv:2 2 1 3"));
    EXPECT_THAT(refusal("u,y\n1,2\n3", {"u"}), Names("data.csv:3 2 1"));
    EXPECT_THAT(refusal("u,y\n1,2\n#3\n", {"u"}), Names("data.csv:3 2 1"));
}

TEST(CsvRefuses, BrokenQuotes) {
    EXPECT_THAT(refusal("u,y\n1,2\n3,\"4\n5,6\n", {"u"}), Names("data.csv:3 2 quote"));
    EXPECT_THAT(refusal("u,y\n1,\"" + std::string(1 << 21, '\n'), {"u"}), Names("data.csv:2 2 quote"));
    EXPECT_THAT(refusal("u,\"y\n1,2\n", {"u"}), Names("data.csv:1 2 quote"));
    EXPECT_THAT(refusal("u,y\n\"1\"2,3\n", {"u"}), Names("data.csv:2 1 quote"));
}

TEST(CsvRefuses, FilesWithoutRows) {
    EXPECT_THAT(refusal("", {"u"}), Names("data.csv empty"));
    EXPECT_THAT(refusal("# x\n\n  \n", {"u"}), Names("data.csv"));
    EXPECT_THAT(refusal("u,y\n\n", {"u"}), Names("data.csv u y"));
}

TEST(CsvRefuses, ColumnsThatAreNotThere) {
    EXPECT_THAT(refusal("time,flow,temperature\n1,2,3\n", {"temprature"}),
                Names("data.csv temprature temperature time flow"));
    EXPECT_THAT(refusal("u,y\n1,2\n", {"U"}), Names("data.csv U u y"));
    EXPECT_THAT(refusal("u,y\n1,2\n", {"2"}), Names("data.csv 2 u y"));
    EXPECT_THAT(refusal("1,2\n", {"u"}), Names("data.csv u 1 2"));
    EXPECT_THAT(refusal("1,2,3,4,5,6,7,8,9\n", {"10"}), Names("data.csv 10 1 2 3 4 5 6 7 8 9"));
    EXPECT_THAT(refusal(",y\n1,2\n", {""}), Names("data.csv"));
    EXPECT_THAT(refusal(std::string(100, 'a') + "\n1\n", {"\x1b"}), Names("data.csv \\x1b " + std::string(24, 'a')));
}

TEST(CsvRefuses, AnAmbiguousNameOnlyWhenAskedFor) {
    EXPECT_THAT(refusal("# c\nu,y,u\n1,2,3\n", {"u"}), Names("data.csv:2 u 1 3"));
    EXPECT_EQ(refusal("u,y,u\n1,2,3\n", {"y"}), "no error");
}

TEST(CsvRefuses, FilesThatCannotBeRead) {
    Folder const folder;
    auto const told = [&](std::string const& path) {
        return folder.without(message_of([&] { read_columns(path, {"u"}); }));
    };
    EXPECT_EQ(told(folder.path / "no.csv"), "no.csv: cannot be opened: No such file or directory");
    fs::create_directory(folder.path / "dir.csv");
    EXPECT_EQ(told(folder.path / "dir.csv"), "dir.csv: expected a file, found a directory");
    EXPECT_EQ(told(folder.path / "a\nb"), "a\\x0ab: cannot be opened: No such file or directory");
    if (fs::exists("/proc/self/mem")) {
        EXPECT_EQ(told("/proc/self/mem"), "/proc/self/mem: cannot be read: Input/output error");
    }

    std::string const secret = folder.file("u\n1\n", "secret.csv");
    fs::permissions(folder.path, fs::perms::all);
    fs::permissions(secret, fs::perms::none);
    uid_t const me = geteuid(), nobody = 65534;
    ASSERT_EQ(seteuid(me == 0 ? nobody : me), 0);  // root may read everything
    auto const message = told(secret);
    ASSERT_EQ(seteuid(me), 0);
    EXPECT_EQ(message, "secret.csv: cannot be opened: Permission denied");
}

/// What the reader says to a FIFO that is fed `piece` over and over, `times` at most; and how many times it took it.
struct Fed {
    std::string message;
    Columns data;
    int pieces = 0;
};
Fed piped(std::string const& piece, int times, std::string const& column) {
    Folder const folder;
    std::string const path = (folder.path / "fifo").string();
    EXPECT_EQ(mkfifo(path.c_str(), 0600), 0);
    auto const before = std::signal(SIGPIPE, SIG_IGN);
    Fed fed;
    std::thread writer([&] {
        std::FILE* const to = std::fopen(path.c_str(), "wb");
        std::setbuf(to, nullptr);
        while (fed.pieces < times && std::fwrite(piece.data(), 1, piece.size(), to) == piece.size()) ++fed.pieces;
        std::fclose(to);
    });
    fed.message = folder.without(message_of([&] { fed.data = read_columns(path, {column}); }));
    writer.join();
    std::signal(SIGPIPE, before);
    return fed;
}

TEST(CsvStream, ALineOf2GiBIsRefusedAfterItsFirst) {
    auto const fed = piped(std::string(1 << 16, '1'), 1 << 15, "u");
    EXPECT_EQ(fed.message, "fifo:1: expected a line of at most 1 MiB");
    EXPECT_LE(fed.pieces, 2 * 16);  // 1 MiB, a chunk, and what the pipe holds
    EXPECT_THAT(message_of([] { read_columns("/dev/zero", {"u"}); }), Names("/dev/zero:1 1"));
}

TEST(CsvStream, RowsCrossChunks) {
    std::string const rows = "0.1,-12345.678901\r\n7,8\r\n";
    auto const fed = piped(rows, 20000, "2");
    ASSERT_EQ(fed.message, "no error");
    ASSERT_EQ(fed.data.rows(), 40000);
    for (std::size_t i = 0; i < 40000; ++i) ASSERT_EQ(fed.data["2"][i], i % 2 == 0 ? -12345.678901 : 8);
}

TEST(CsvStream, EndsEarlyAsAnyFileDoes) {
    EXPECT_EQ(piped("1,2\n3,4\n5", 1, "1").message, "fifo:3: expected 2 columns as in line 1, found 1");
    EXPECT_EQ(piped("1,2\n3,4\n5,", 1, "1").message, "no error");
    EXPECT_EQ(piped("", 0, "1").message, "fifo: expected rows of numbers, found an empty file");
}

TEST(CsvStream, ADashIsStandardInput) {
    Folder const folder;
    int const saved = dup(0);
    ASSERT_NE(std::freopen(folder.file("u\n1\nx\n").c_str(), "rb", stdin), nullptr);
    EXPECT_THAT(message_of([] { read_columns("-", {"u"}); }), Names("input:3 1 u x"));
    std::clearerr(stdin);
    dup2(saved, 0);
    close(saved);
}

RC_GTEST_PROP(Csv, WhatIsWrittenIsReadBitForBit, ()) {
    auto const flag = [] { return *rc::gen::arbitrary<bool>(); };
    std::size_t const columns = *rc::gen::inRange<std::size_t>(1, 5), rows = *rc::gen::inRange<std::size_t>(1, 12);
    char const separator = *rc::gen::element(',', ';', '\t');
    bool const header = flag();
    std::string const end = flag() ? "\r\n" : "\n";
    auto const in_quotes = [](std::string text) {
        for (auto at = text.find('"'); at != text.npos; at = text.find('"', at + 2)) text.insert(at, 1, '"');
        return '"' + text + '"';
    };
    std::vector<Numbers> table(columns);
    Words names;
    std::string text = flag() ? bom + "# about; this,\tfile" + end : "";
    for (std::size_t j = 0; j < columns; ++j) {
        auto const middle = *rc::gen::container<std::string>(rc::gen::elementOf(std::string("a \",;\t\n#'\xc3")));
        names.push_back(header ? fmt::format("n{}{}n", j, middle) : std::to_string(j + 1));
        if (header) text += (j == 0 ? "" : std::string(1, separator)) + in_quotes(names.back());
    }
    if (header) text += end;
    for (std::size_t i = 0; i < rows; ++i) {
        if (header && (columns > 1 || i == 0) && flag()) text += end;  // a blank line
        for (std::size_t j = 0; j < columns; ++j) {
            auto x = std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>() * 0x9e3779b97f4a7c15u);
            if (!(std::abs(x) <= largest_value)) x = missing;
            std::string cell = flag() ? fmt::format("{}", x) : fmt::format("{:+.17g}", x);
            if (std::isnan(x)) cell = *rc::gen::element<std::string>("NA", "nan", ".", "?", columns > 1 ? "" : "null");
            if (flag()) cell = " " + cell + "  ";
            table[j].push_back(x);
            text += (j == 0 ? "" : std::string(1, separator)) + (flag() ? in_quotes(cell) : cell);
        }
        if (i + 1 < rows || flag()) text += end;
    }
    auto const data = read(text, names);
    RC_ASSERT(data.header == header);
    RC_ASSERT(data.rows() == Index(rows));
    for (std::size_t j = 0; j < columns; ++j) RC_ASSERT(same(data.values[j], table[j]));
}

TEST(CsvRecords, TheLabsRealRecords) {
    fs::path const folder = fs::path(RLSLAB_SOURCE_DIR) / "../shared/data";
    if (!fs::exists(folder)) GTEST_SKIP() << "no folder ../shared/data beside the project";
    auto const rows = [&](char const* name) { return read_columns(folder / name, {"u", "y"}).rows(); };
    EXPECT_EQ(rows("hair_dryer.csv"), 1000);
    EXPECT_EQ(rows("heat_exchanger.csv"), 4000);
    EXPECT_EQ(rows("gas_furnace.csv"), 296);
}

TEST(CsvRecords, TheDemo) {
    auto const data = read_columns(fs::path(RLSLAB_SOURCE_DIR) / "studies/data/sales.csv", {"lead", "sales"});
    ASSERT_EQ(data.rows(), 150);
    EXPECT_EQ(Numbers(data["sales"].begin(), data["sales"].begin() + 2), (Numbers{200.1, 199.5}));
    EXPECT_EQ(Numbers(data["lead"].begin(), data["lead"].begin() + 2), (Numbers{10.01, 10.07}));
    EXPECT_EQ(data["sales"].back(), 262.7);
}

}  // namespace
}  // namespace rlslab
