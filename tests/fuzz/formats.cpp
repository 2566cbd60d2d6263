// Any bytes as a file of data, compressed or MATLAB's: read, or refused in one printable line.
#include "tests/fuzz/fuzz.hpp"

#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/open.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace rlslab::fuzz {
namespace {

/// A file in memory, with a path.
class MemoryFile {
    int descriptor_ = memfd_create("fuzzed", MFD_CLOEXEC);

public:
    explicit MemoryFile(std::string_view bytes) {
        expect(descriptor_ >= 0 && write(descriptor_, bytes.data(), bytes.size()) == ssize_t(bytes.size()),
               "a file in memory");
    }
    MemoryFile(MemoryFile const&) = delete;
    MemoryFile& operator=(MemoryFile const&) = delete;
    ~MemoryFile() { close(descriptor_); }
    std::string path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }
};

/// What the bytes unpack to, or why they do not; at most a megabyte of it.
std::string unpacked_in_pieces(std::string_view bytes, std::size_t of_packed, std::size_t of_unpacked) {
    std::string out, piece(of_unpacked, '\0');
    try {
        ByteSource const source = unpacked(
            [bytes, of_packed](std::span<char> to) mutable {
                std::size_t const now = std::min({of_packed, to.size(), bytes.size()});
                std::ranges::copy(bytes.substr(0, now), to.begin());
                bytes.remove_prefix(now);
                return now;
            },
            "packed");
        for (std::size_t got = 1; got > 0 && out.size() < (1 << 20);) out.append(piece, 0, got = source(piece));
    } catch (InputError const& error) {
        return one_line(error);  // what came before it depends on the pieces
    }
    return out.substr(0, 1 << 20);
}

}  // namespace

void take(std::string_view bytes) {
    if (bytes.starts_with(gzip_begins))
        expect(unpacked_in_pieces(bytes, bytes.size(), 4096) == unpacked_in_pieces(bytes, 3, 511),
               "the same in pieces");
    MemoryFile const file(bytes);
    for (std::vector<std::string> const& asked : {std::vector<std::string>{"u", "y"}, {"x_1", "x_2"}, {"1"}, {"s"}})
        try {
            Columns const data = read_data(DataFile(file.path()), asked);
            expect(data.rows() > 0 && data.values.size() == asked.size(), "rows, or a refusal");
            for (auto const& column : data.values) {
                expect(Index(column.size()) == data.rows(), "columns of equal length");
                for (double const x : column)
                    expect(std::isnan(x) || std::abs(x) <= largest_value, "values within bounds, or missing");
            }
        } catch (InputError const& error) {
            one_line(error);
        }
}

}  // namespace rlslab::fuzz
