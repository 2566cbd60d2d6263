// Version 5, read without matio: for a file that was cut short, matio 1.5.23 returns numbers that are not in it.
//
// The format (MAT-File Format, MathWorks): 128 bytes of header; then elements, each a tag (type, bytes) and so many
// bytes, one for each variable. A compressed element holds another in zlib's form. A matrix holds elements padded to 8
// bytes: flags, dimensions, name, numbers (of any type that keeps them), imaginary parts.
#include <rlslab/input/formats/gzip.hpp>
#include <rlslab/input/formats/mat.hpp>
#include <rlslab/input/formats/mat_variables.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <fmt/format.h>

namespace rlslab {
namespace {

enum class Type : std::uint32_t {
    int8 = 1,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    binary32,
    binary64 = 9,
    int64 = 12,
    uint64,
    matrix,
    compressed
};
constexpr std::uint32_t flag_complex = 0x0800;

/// A reader of a stream of bytes whose remaining number is known.
class Reader {
    ByteSource bytes_;
    std::string const& file_;

public:
    bool swapped;
    std::size_t left;

    Reader(ByteSource bytes, std::string const& file, bool other_end, std::size_t count)
        : bytes_(std::move(bytes)), file_(file), swapped(other_end), left(count) {}
    [[noreturn]] void fail(std::string const& what) const {
        throw InputError(fmt::format("{}: {}: the file is damaged", file_, what));
    }
    std::size_t some(std::span<char> to) {
        std::size_t const got = bytes_(to.first(std::min(to.size(), left)));
        left -= got;
        return got;
    }
    /// False: there were none. Throws where there were some but too few.
    bool fill(std::span<char> to) {
        std::size_t filled = 0;
        for (std::size_t got = 1; filled < to.size() && got > 0; filled += got) got = some(to.subspan(filled));
        if (filled > 0 && filled < to.size()) fail("it ends within a variable");
        return filled > 0 || to.empty();
    }
    void need(std::span<char> to) {
        if (!fill(to)) fail("it ends within a variable");
    }
    void skip(std::size_t count) {
        std::array<char, 4096> waste;
        for (; count > 0; count -= std::min(count, waste.size()))
            need(std::span(waste).first(std::min(count, waste.size())));
    }
    /// The number that begins there, from either end.
    template <class T>
    T number(std::span<char const> from) const {
        std::array<char, sizeof(T)> raw;
        std::copy_n(from.begin(), raw.size(), raw.begin());
        if (swapped) std::ranges::reverse(raw);
        return std::bit_cast<T>(raw);
    }
};

struct Tag {
    Type type;
    std::size_t bytes;           // of data
    std::array<char, 4> here{};  // the data themselves, where four bytes hold them
    bool small = false;
    std::size_t padding() const { return small ? 0 : (8 - bytes % 8) % 8; }
};

std::optional<Tag> next_tag(Reader& r) {
    std::array<char, 8> raw;
    if (!r.fill(raw)) return std::nullopt;
    std::uint32_t const first = r.number<std::uint32_t>(raw),
                        second = r.number<std::uint32_t>(std::span(raw).subspan(4));
    if (first >> 16 == 0) return Tag{Type(first), second};
    Tag tag{Type(first & 0xffff), first >> 16};
    if (tag.bytes > 4) r.fail("a short element says it is long");
    std::copy_n(raw.begin() + 4, 4, tag.here.begin());
    tag.small = true;
    return tag;
}
Tag tag_within(Reader& r, char const* of) {
    auto const tag = next_tag(r);
    if (!tag) r.fail(fmt::format("a variable has no {}", of));
    if (!tag->small && tag->bytes > r.left) r.fail(fmt::format("a variable's {} are longer than it", of));
    return *tag;
}

/// A short element of a matrix: flags, dimensions, name.
std::string contents(Reader& r, char const* of, std::size_t unit) {
    Tag const tag = tag_within(r, of);
    if (tag.bytes > 4096 || tag.bytes % unit != 0) r.fail(fmt::format("{} bytes of {}", tag.bytes, of));
    std::string out(tag.bytes, '\0');
    if (tag.small) std::copy_n(tag.here.begin(), tag.bytes, out.begin());
    else r.need(out), r.skip(tag.padding());
    return out;
}

/// How numbers of a type are kept.
struct Kept {
    std::size_t bytes;  // 0: it has none
    double (*read)(Reader const&, std::span<char const>);
};
template <class T>
constexpr Kept kept_as{sizeof(T), [](Reader const& r, std::span<char const> at) { return double(r.number<T>(at)); }};
Kept kept(Type type) {
    switch (type) {
        case Type::int8: return kept_as<std::int8_t>;
        case Type::uint8: return kept_as<std::uint8_t>;
        case Type::int16: return kept_as<std::int16_t>;
        case Type::uint16: return kept_as<std::uint16_t>;
        case Type::int32: return kept_as<std::int32_t>;
        case Type::uint32: return kept_as<std::uint32_t>;
        case Type::binary32: return kept_as<float>;
        case Type::binary64: return kept_as<double>;
        case Type::int64: return kept_as<std::int64_t>;
        case Type::uint64: return kept_as<std::uint64_t>;
        default: return {0, nullptr};
    }
}

/// The numbers of the columns that are needed.
void read_numbers(Reader& r, MatVariable& v, std::vector<std::string> const& requested) {
    std::vector<std::size_t> const requested_columns = columns_requested(v, requested);
    if (requested_columns.empty()) return;
    Tag const tag = tag_within(r, "numbers");
    auto const [size, read] = kept(tag.type);
    if (size == 0 || tag.bytes != size * v.rows * v.cols)
        r.fail(fmt::format("{}: {} bytes of numbers for {} x {}", printable(v.name), tag.bytes, v.rows, v.cols));
    std::array<char, 4096> chunk;
    for (std::size_t j = 0; j < v.cols; ++j) {
        bool const skipped = std::ranges::count(requested_columns, j) == 0;
        for (std::size_t i = 0, count = 0; i < v.rows; i += count) {
            count = std::min(v.rows - i, chunk.size() / size);
            std::span<char> const raw = std::span(chunk).first(count * size);
            if (tag.small) std::copy_n(tag.here.begin() + long((j * v.rows + i) * size), raw.size(), raw.begin());
            else r.need(raw);
            for (std::size_t k = 0; k < count && !skipped; ++k) v.values[j].push_back(read(r, raw.subspan(k * size)));
        }
    }
}

/// The names of a structure's fields: each has the same length, with zeros behind it. None where there are very many.
std::vector<std::string> field_names(Reader& r) {
    std::string const length = contents(r, "length of field names", 4);
    if (length.empty()) return {};
    auto const each = std::size_t(std::max(r.number<std::int32_t>(length), 1));
    Tag const tag = tag_within(r, "field names");
    if (tag.small || tag.bytes > 4096) return {};
    std::string all(tag.bytes, '\0');
    r.need(all);
    std::vector<std::string> out;
    for (std::size_t at = 0; at + each <= all.size(); at += each) out.emplace_back(all.substr(at, each).c_str());
    return out;
}

MatVariable read_matrix(Reader& r, std::vector<std::string> const& requested) {
    std::string const flags = contents(r, "flags", 8);
    if (flags.empty()) r.fail("a variable has no flags");
    std::uint32_t const first = r.number<std::uint32_t>(flags);
    auto const is = MatClass(first & 0xff);
    if (is == MatClass::opaque) return {contents(r, "name", 1), is, false, {}};  // it has no dimensions
    std::string const dimensions = contents(r, "dimensions", 4);
    std::vector<std::size_t> sizes;
    for (std::size_t i = 0; i < dimensions.size(); i += 4) {
        std::int32_t const size = r.number<std::int32_t>(std::span(dimensions).subspan(i));
        if (size < 0) r.fail("a negative dimension");
        sizes.push_back(std::size_t(size));
    }
    MatVariable out(contents(r, "name", 1), is, first & flag_complex, sizes);
    if (is == MatClass::structure) out.has_fields(field_names(r));
    read_numbers(r, out, requested);
    return out;
}

/// So many of a reader's bytes; copies share them.
ByteSource part_of(Reader& r, std::size_t count) {
    return [&r, left = std::make_shared<std::size_t>(count)](std::span<char> to) {
        std::size_t const got = r.some(to.first(std::min(to.size(), *left)));
        if (got == 0 && *left > 0 && !to.empty()) r.fail("it ends within a variable");
        *left -= got;
        return got;
    };
}

}  // namespace

Columns read_mat5(ByteSource bytes, std::string const& file, std::vector<std::string> const& requested) {
    std::array<char, mat_begin> header;
    constexpr std::size_t no_end = std::numeric_limits<std::size_t>::max();
    std::vector<MatVariable> variables;
    Reader r(std::move(bytes), file, false, no_end);
    r.need(header);
    r.swapped = (header[126] == 'I') != (std::endian::native == std::endian::little);
    while (auto const tag = next_tag(r)) {
        ByteSource part = part_of(r, tag->bytes);
        std::size_t inner = tag->bytes;
        bool const compressed = tag->type == Type::compressed;
        Type type = tag->type;
        if (compressed) {
            part = inflated(std::move(part), file);
            Reader peeked(part, file, r.swapped, 8);
            auto const packed = next_tag(peeked);
            if (!packed) r.fail("a compressed variable is empty");
            type = packed->type;
            inner = packed->bytes;
        }
        Reader element(part, file, r.swapped, inner);
        if (type == Type::matrix && !tag->small && inner > 0) variables.push_back(read_matrix(element, requested));
        element.skip(element.left);
        std::array<char, 1> more;
        if (compressed && part(more) > 0)
            r.fail("a compressed variable is longer than it says");  // with a correct checksum
        if (!compressed && !tag->small) r.skip(tag->padding());
    }
    return columns_of(variables, file, requested);
}

}  // namespace rlslab
