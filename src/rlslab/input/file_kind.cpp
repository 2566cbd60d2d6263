// The first bytes that formats prescribe.
#include <rlslab/input/file_kind.hpp>

#include <algorithm>

namespace rlslab {
namespace {

struct FileKind {
    std::string_view begins, what;
};

constexpr std::string_view utf_16 = "UTF-16: save it as UTF-8 (iconv -f UTF-16LE -t UTF-8, or UTF-16BE)";
constexpr std::string_view utf_32 = "UTF-32: save it as UTF-8 (iconv -f UTF-32LE -t UTF-8, or UTF-32BE)";
constexpr FileKind of_bytes[] = {{std::string_view("\xff\xfe\0\0", 4), utf_32},
                                 {std::string_view("\0\0\xfe\xff", 4), utf_32},
                                 {"\xff\xfe", utf_16},
                                 {"\xfe\xff", utf_16},
                                 {"\x1f\x8b", "gzip's compressed data: unpack them first"},
                                 {"BZh91AY", "bzip2's compressed data: unpack them first"},
                                 {"\xfd"
                                  "7zXZ",
                                  "xz's compressed data: unpack them first"},
                                 {"\x28\xb5\x2f\xfd", "zstd's compressed data: unpack them first"},
                                 {"7z\xbc\xaf", "a 7-Zip archive: unpack it first"},
                                 {"PK\x03\x04", "a zip archive or a workbook: save the sheet as CSV"},
                                 {"\xd0\xcf\x11\xe0", "a workbook: save the sheet as CSV"},
                                 {"\x89PNG", "a PNG image"},
                                 {"\xff\xd8\xff", "a JPEG image"},
                                 {"GIF89a", "a GIF image"},
                                 {"%PDF-", "a PDF document"},
                                 {"{\\rtf", "an RTF document: save the table as CSV"},
                                 {"\x89HDF", "an HDF5 file: save the columns as CSV"},
                                 {"\x93NUMPY", "an array of NumPy: write it with numpy.savetxt"},
                                 {"PAR1\x15", "a Parquet file: save the columns as CSV"},
                                 {"SQLite format 3", "a database of SQLite: save the table as CSV"},
                                 {"\x7f"
                                  "ELF",
                                  "a program"}};
constexpr std::string_view of_markup[] = {"<!doctype html", "<html", "<head", "<body", "<table"};

/// Whether one of every two bytes is zero: letters and digits in UTF-16, which begins without a mark.
bool in_pairs(std::string_view begin) {
    begin = begin.substr(0, std::min<std::size_t>(begin.size(), 16));
    bool zero[2] = {begin.size() > 1, begin.size() > 1};
    for (std::size_t i = 0; i < begin.size(); ++i) zero[i % 2] &= begin[i] == '\0';
    return zero[0] != zero[1];
}

}  // namespace

std::string_view not_a_table(std::string_view begin) {
    for (auto const& [begins, what] : of_bytes)
        if (begin.starts_with(begins)) return what;
    if (in_pairs(begin)) return begin.substr(1, 2) == std::string_view("\0\0", 2) ? utf_32 : utf_16;
    if (begin.starts_with("\xef\xbb\xbf")) begin.remove_prefix(3);
    begin.remove_prefix(std::min(begin.find_first_not_of(" \t"), begin.size()));
    auto const same = [](char a, char b) { return ('A' <= a && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
    for (auto const& tag : of_markup)
        if (std::ranges::equal(begin.substr(0, tag.size()), tag, same))
            return "a web page (HTML): save the table in it as CSV";
    if (std::ranges::equal(begin.substr(0, 5), std::string_view("<?xml"), same))
        return "an XML file: save the table in it as CSV";
    return "";
}

}  // namespace rlslab
