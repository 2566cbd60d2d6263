// Compressed data are read as the data they contain, and MATLAB's variables as columns. A file that cannot be read is
// refused in one line. Then digests of files, and text in lines.
#include "tests/common/files.hpp"
#include "tests/common/kept.hpp"

#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/open.hpp>
#include <rlslab/input/sha256.hpp>
#include <rlslab/input/text.hpp>

#include <zlib.h>

#include <bit>
#include <filesystem>
#include <fstream>

namespace rlslab {
namespace {

using files::Folder, files::message_of;
using Words = std::vector<std::string>;
using Numbers = std::vector<double>;

std::string packed(std::string const& text) {
    std::string out(compressBound(uLong(text.size())) + 32, '\0');
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = uInt(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = uInt(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

Columns read(std::string const& bytes, Words const& asked, CsvFormat format = {}) {
    Folder const folder;
    return read_data({folder.file(bytes, "data"), format}, asked);
}
std::string refusal(std::string const& bytes, Words const& asked, CsvFormat format = {}) {
    Folder const folder;
    return folder.without(message_of([&] { read_data({folder.file(bytes, "data"), format}, asked); }));
}

// --- gzip ------------------------------------------------------------------------------------------------------------

TEST(Gzip, IsReadByItsContent) {
    EXPECT_EQ(read(packed("u;y\n1,5;2\n3;4\n"), {"u"})["u"], (Numbers{1.5, 3}));
    EXPECT_EQ(read("u,y\n1,2\n", {"y"})["y"], (Numbers{2}));
    EXPECT_EQ(read(packed("u|y\n1|2\n"), {"y"}, {.separator = '|'})["y"], (Numbers{2}));
    EXPECT_THAT(refusal(packed("u,y\n1,2\n3,x\n"), {"y"}), Names("data:3 2 y x"));
}
TEST(Gzip, ItsMarksAreInDoubtAsInPlainText) {
    EXPECT_THAT(refusal(packed("u\ty\n967\t1.047\n1.047\t2.001\n"), {"u"}), Names("data:3 1 u 1.047 967 --decimal"));
}
TEST(ColumnsAmong, AreCellsOfTheFirstLinesAndTheFileIsReadFromItsBeginning) {
    std::string const text = "% by hand\nLogger\nt;y[k-1];\"Speed [rpm]\"\n1;2;3\n";
    Words const words{"y[k-1]", "y[k-2]", "Speed [rpm]", "u"};
    Folder const folder;
    for (std::string const& bytes : {text, packed(text)}) {
        DataFile file(folder.file(bytes, "data"));
        EXPECT_EQ(columns_among(words, file), (Words{"y[k-1]", "Speed [rpm]"}));
        EXPECT_EQ(read_data(file, {"Speed [rpm]"})["Speed [rpm]"], (Numbers{3}));
    }
    DataFile damaged(folder.file(packed(text).substr(0, 20), "data"));
    EXPECT_EQ(columns_among(words, damaged), (Words{}));
    EXPECT_THAT(folder.without(message_of([&] { read_data(damaged, {"t"}); })), Names("data"));
}
TEST(Gzip, PartsThatWereJoinedAreOneFile) {
    EXPECT_EQ(read(packed("u,y\n1,2\n3,") + packed("") + packed("4\n"), {"y"})["y"], (Numbers{2, 4}));
    EXPECT_EQ(read(packed("u\n1\n") + std::string(513, '\0'), {"u"})["u"], (Numbers{1}));  // as a tape pads it
    EXPECT_THAT(refusal(packed("u\n1\n") + "more", {"u"}), Names("data"));
}
TEST(Gzip, DamageIsSeenWhereverItIs) {
    std::string text = "u\n";
    for (int i = 0; i < 300; ++i) text += std::to_string(i * i % 97) + '\n';
    std::string const whole = packed(text);
    for (std::size_t length = 2; length < whole.size(); ++length)
        EXPECT_THAT(refusal(whole.substr(0, length), {"u"}), Names("data")) << length;
    for (std::size_t at = 10; at < whole.size(); ++at) {  // behind the header
        std::string damaged = whole;
        damaged[at] = char(damaged[at] ^ 0x10);
        if (refusal(damaged, {"u"}) ==
            "no error") {  // a bit that fills up the last byte before the checksum says nothing
            EXPECT_EQ(at, whole.size() - 9);
            EXPECT_EQ(read(damaged, {"u"})["u"], read(whole, {"u"})["u"]);
        }
    }
    std::string checksum = whole;
    checksum[whole.size() - 6] ^= 1;
    EXPECT_THAT(refusal(checksum, {"u"}), Names("data"));
    EXPECT_THAT(refusal(packed(whole), {"u"}), Names("data UTF-8 gzip"));
    EXPECT_THAT(refusal(packed(""), {"u"}), Names("data empty"));
}
TEST(Gzip, ABombIsNotHeld) {
    std::string bomb;  // a line of 256 MiB in 256 kB
    for (int i = 0; i < 4; ++i) bomb += packed(std::string(1 << 26, '1'));
    EXPECT_LT(bomb.size(), 300000u);
    EXPECT_THAT(refusal(bomb, {"1"}), Names("data:1 1"));
}
TEST(Gzip, RowsWithoutEndAreRefused) {
    std::string rows;
    for (int i = 0; i < 1 << 18; ++i) rows += "7\n";
    long given = 0;
    CsvFile endless(
        [&](std::span<char> to) {
            std::size_t const now = std::min(to.size(), rows.size());
            std::ranges::copy(rows.substr(0, now), to.begin());
            given += long(now);
            return now;
        },
        "endless", {}, 1 << 20);
    EXPECT_THAT(message_of([&] { endless.read({"1"}); }), Names("endless:524289 524288"));
    EXPECT_LT(given, 2 << 20);
}

// --- MATLAB ----------------------------------------------------------------------------------------------------------

/// A .mat file of version 5 as the format's description has it, without matio: each variable a matrix of doubles by
/// columns.
struct Mat5 {
    std::string bytes;
    Mat5() : bytes("MATLAB 5.0 MAT-file, by hand") {
        bytes.resize(124, ' ');
        put(std::uint16_t(0x0100)), put(std::uint16_t(0x4d49));
    }
    template <class T>
    void put(T x) {
        auto const raw = std::bit_cast<std::array<char, sizeof(T)>>(x);
        bytes.append(raw.begin(), raw.end());
    }
    void pad() { bytes.resize((bytes.size() + 7) / 8 * 8, '\0'); }
    Mat5& add(std::string const& name, std::int32_t rows, std::int32_t cols, Numbers const& values,
              std::uint32_t flags = 6) {
        std::size_t const names = (name.size() + 7) / 8 * 8, numbers = values.size() * 8;
        put(std::uint32_t(14)), put(std::uint32_t(16 + 16 + 8 + names + 8 + numbers));
        put(std::uint32_t(6)), put(std::uint32_t(8)), put(flags), put(std::uint32_t(0));
        put(std::uint32_t(5)), put(std::uint32_t(8)), put(rows), put(cols);
        put(std::uint32_t(1)), put(std::uint32_t(name.size()));
        bytes += name;
        pad();
        put(std::uint32_t(9)), put(std::uint32_t(numbers));
        for (double const x : values) put(x);
        return *this;
    }
};

TEST(Matlab, VectorsAreColumnsAndMatricesHaveSome) {
    std::string const file = Mat5()
                                 .add("u", 3, 1, {1, 2.5, -3})
                                 .add("y", 1, 3, {4, 5, 6})
                                 .add("X", 3, 2, {1, 2, 3, 7, 8, 9})
                                 .add("Ts", 1, 1, {0.1})
                                 .bytes;
    Columns const data = read(file, {"y", "u", "X_2"});
    EXPECT_EQ(data["u"], (Numbers{1, 2.5, -3}));
    EXPECT_EQ(data["y"], (Numbers{4, 5, 6}));
    EXPECT_EQ(data["X_2"], (Numbers{7, 8, 9}));
    EXPECT_EQ(read(file, {"X(:,1)", "X(:, 2)", "u(:,1)"}).values,
              (std::vector<Numbers>{{1, 2, 3}, {7, 8, 9}, {1, 2.5, -3}}));
    EXPECT_EQ(read(file, {"X(:,2)"})["X(:,2)"], (Numbers{7, 8, 9}));
    EXPECT_THAT(refusal(file, {"y(:,2)"}), Names("data y(:,2) u y X_1 X_2 Ts"));
    EXPECT_EQ(data.lines, (std::vector<long>{1, 2, 3}));
    EXPECT_THAT(refusal(file, {"u", "Ts"}), Names("data 3 u 1 Ts"));
    EXPECT_THAT(refusal(file, {"X"}), Names("data X X_1 X_2"));
    EXPECT_THAT(refusal(file, {"U"}), Names("data U u y X_1 X_2 Ts"));
    EXPECT_THAT(refusal(file, {"u"}, {.decimal = ','}), Names("data MATLAB"));
}
TEST(Matlab, WhatIsNoRealVectorIsNamed) {
    double const inf = std::numeric_limits<double>::infinity();
    std::string const file = Mat5()
                                 .add("u", 2, 1, {1, inf})
                                 .add("v", 2, 1, {1, -1e200})
                                 .add("w", 0, 0, {})
                                 .add("z", 2, 1, {1, 2}, 0x0806)
                                 .add("c", 2, 1, {1, 2}, 1)
                                 .add("X", 1 << 30, 3, {1})
                                 .bytes;
    EXPECT_THAT(refusal(file, {"u"}), Names("data u 2 0 2^500 inf"));
    EXPECT_THAT(refusal(file, {"v"}), Names("data v 2 0 2^500 -1e+200"));
    EXPECT_THAT(refusal(file, {"w"}), Names("data w"));
    EXPECT_THAT(refusal(file, {"z"}), Names("data z complex"));
    EXPECT_THAT(refusal(file, {"c"}), Names("data c cell"));
    EXPECT_THAT(refusal(file, {"X"}), Names("data X 1073741824 3"));
    EXPECT_TRUE(std::isnan(read(Mat5().add("u", 2, 1, {1, std::nan("")}).bytes, {"u"})["u"][1]));  // a missing value
    EXPECT_THAT(refusal(Mat5().bytes, {"u"}), Names("data"));
}
TEST(Matlab, AStructureIsNamedWithItsFieldsAndTheRemedy) {
    auto const structure = [](Mat5 file) {  // data, of the fields u and speed
        std::string const names = std::string("u\0\0\0\0\0\0\0", 8) + std::string("speed\0\0\0", 8);
        file.put(std::uint32_t(14)), file.put(std::uint32_t(16 + 16 + 16 + 8 + 8 + names.size()));
        file.put(std::uint32_t(6)), file.put(std::uint32_t(8)), file.put(std::uint32_t(2)), file.put(std::uint32_t(0));
        file.put(std::uint32_t(5)), file.put(std::uint32_t(8)), file.put(std::int32_t(1)), file.put(std::int32_t(1));
        file.put(std::uint32_t(1)), file.put(std::uint32_t(4)), file.bytes += "data", file.pad();
        file.put(std::uint32_t(5 | 4 << 16)), file.put(std::int32_t(8));
        file.put(std::uint32_t(1)), file.put(std::uint32_t(names.size())), file.bytes += names;
        return file.bytes;
    };
    for (Words const& asked : {Words{"u"}, Words{"data"}, Words{"data.u"}})
        EXPECT_THAT(refusal(structure(Mat5()), asked), Names("data u speed -struct")) << asked[0];
    EXPECT_THAT(refusal(structure(Mat5().add("Ts", 1, 1, {0.1})), {"u"}), Names("data u Ts speed -struct"));
    EXPECT_EQ(read(structure(Mat5().add("Ts", 1, 1, {0.1})), {"Ts"})["Ts"], (Numbers{0.1}));
}
TEST(Matlab, ANumberMayStandForAMissingValue) {
    EXPECT_TRUE(
        std::isnan(read(Mat5().add("u", 2, 1, {1, -999}).bytes, {"u"}, {.missing = {"No Data", "-999"}})["u"][1]));
}
TEST(Matlab, CutShortItIsRefused) {
    std::string const whole = Mat5().add("u", 3, 1, {1, 2, 3}).bytes;
    EXPECT_THAT(refusal(whole.substr(0, 128), {"u"}), Names("data"));
    for (std::size_t length = 129; length < whole.size(); ++length)
        EXPECT_THAT(refusal(whole.substr(0, length), {"u"}), Names("data")) << length;
    EXPECT_THAT(refusal(Mat5().add("u", 1 << 20, 1, {1}).bytes, {"u"}), Names("data u 8 1048576 1"));
}
TEST(Matlab, InCompressedVariablesEveryBitIsChecked) {
    std::string const whole = files::kept(RLSLAB_SOURCE_DIR "/tests/fuzz/corpus/formats.txt").at("mat5_packed");
    auto const good = read(whole, {"u", "y"}).values;
    for (std::size_t length = 129; length < whole.size();
         ++length) {  // between variables nothing shows what is missing behind
        std::string const told = refusal(whole.substr(0, length), {"u", "y"});
        if (told == "no error") {
            EXPECT_EQ(read(whole.substr(0, length), {"u", "y"}).values, good);
        }
    }
    for (std::size_t at = 128; at < whole.size(); ++at)
        for (int bit = 0; bit < 8; bit += 3) {
            std::string damaged = whole;
            damaged[at] = char(damaged[at] ^ (1 << bit));
            if (refusal(damaged, {"u", "y"}) == "no error") {
                EXPECT_EQ(read(damaged, {"u", "y"}).values, good) << at;
            }
        }
}
TEST(Matlab, EitherEndFirst) {
    std::string const little = Mat5().add("u", 2, 1, {1.5, -3}).bytes;
    std::string big = little.substr(0, 124) + std::string("\1\0MI", 4);
    auto const swap = [&](std::size_t from, std::size_t count) {
        big.append(little.rbegin() + long(little.size() - from - count), little.rbegin() + long(little.size() - from));
    };
    for (std::size_t at = 128; at < little.size();)
        if (at == 128 + 48) big += little.substr(at, 8), at += 8;  // the name
        else if (at >= little.size() - 16) swap(at, 8), at += 8;
        else swap(at, 4), at += 4;
    EXPECT_EQ(read(big, {"u"})["u"], (Numbers{1.5, -3}));
}
TEST(Matlab, IsReadThroughGzipAndAPipe) {
    std::string const file = Mat5().add("u", 2, 1, {1.5, -3}).bytes;
    EXPECT_EQ(read(packed(file), {"u"})["u"], (Numbers{1.5, -3}));
}
TEST(Matlab, BothVersionsPackedAndPlain) {
    auto const all = files::kept(RLSLAB_SOURCE_DIR "/tests/fuzz/corpus/formats.txt");
    for (char const* name : {"mat5", "mat5_packed", "mat73", "mat73_packed"}) {
        Folder const folder;
        std::string const path = folder.file(all.at(name), name);
        Columns data;
        std::string const told = message_of([&] { data = read_data(path, {"u", "y", "x_2", "s"}); });
        if (told.find("matio") != told.npos) continue;  // without it, or it without HDF5
        ASSERT_EQ(told, "no error") << name;
        EXPECT_EQ(data.values, (std::vector<Numbers>{{1, 2.5, -3, 4}, {1, 2, 3, 4.5}, {5, 6, 7, 8}, {1, -2, 3, 4}}))
            << name;
    }
}

// --- SHA-256 against the examples of FIPS 180-4, and at the ends of blocks -------------------------------------------

std::string of(std::string const& text, size_t at_once) {
    Sha256 digest;
    for (size_t i = 0; i < text.size(); i += at_once) digest.add(std::string_view(text).substr(i, at_once));
    return digest.hex();
}

TEST(Sha256, GivesTheStandardsDigests) {
    std::string const two_blocks = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    for (size_t const at_once : {1u, 7u, 64u, 1000000u}) {
        EXPECT_EQ(of("", at_once), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        EXPECT_EQ(of("abc", at_once), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        EXPECT_EQ(of(two_blocks, at_once), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
        EXPECT_EQ(of(std::string(1000000, 'a'), at_once),
                  "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
}
/// Where the padding begins a block, ends one, and just misses one; digests by coreutils' sha256sum.
TEST(Sha256, PadsAtTheEndsOfABlock) {
    EXPECT_EQ(of(std::string(55, 'x'), 64), "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
    EXPECT_EQ(of(std::string(56, 'x'), 64), "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
    EXPECT_EQ(of(std::string(63, 'x'), 64), "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2");
    EXPECT_EQ(of(std::string(64, 'x'), 64), "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
}
TEST(Sha256, OfAFileIsThatOfItsBytes) {
    auto const path = std::filesystem::temp_directory_path() / "rlslab_sha256_test.csv";
    std::string const text = "u,y\n1,2\n3,4\n";
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(read_data(path.string(), {"y"}).sha256, of(text, 64));
    std::filesystem::remove(path);
}

// --- text in lines of a certain width --------------------------------------------------------------------------------

TEST(Wrapped, BreaksAtSpacesBeforeTheWidth) {
    EXPECT_EQ(wrapped("one two three", 0, 2, 7), "one two\n  three") << "a line may be as long as the width";
    EXPECT_EQ(wrapped("one two three", 0, 2, 6), "one\n  two\n  three") << "not longer";
    EXPECT_EQ(wrapped("one two", 1, 0, 7), "one\ntwo") << "what stands before the text counts";
    EXPECT_EQ(wrapped("one  two", 0, 0, 4), "one\ntwo") << "no line begins or ends with a space";
}
TEST(Wrapped, LeavesALongWordWhole) {
    EXPECT_EQ(wrapped("incompressible it is", 0, 1, 5), "incompressible\n it\n is");
    EXPECT_EQ(wrapped("incompressible", 0, 1, 5), "incompressible");
    EXPECT_EQ(wrapped("", 9, 1, 5), "");
}

}  // namespace
}  // namespace rlslab
