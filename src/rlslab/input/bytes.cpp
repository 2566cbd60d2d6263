// Files by the C library: one interface for regular files, FIFOs and standard input.
#include <rlslab/input/bytes.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

namespace rlslab {

std::string name_of_file(std::string const& path) { return path == "-" ? "standard input" : printable(path, 200); }

ByteSource bytes_of_file(std::string const& path) {
    auto const close = [](std::FILE* file) {
        if (file && file != stdin) std::fclose(file);
    };
    std::shared_ptr<std::FILE> const file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"), close);
    std::string const name = name_of_file(path);
    if (!file) throw InputError(fmt::format("{}: cannot be opened: {}", name, std::generic_category().message(errno)));
    return [file, name](std::span<char> to) {
        errno = 0;
        std::size_t const got = std::fread(to.data(), 1, to.size(), file.get());
        if (got > 0 || !std::ferror(file.get())) return got;
        if (errno == EISDIR) throw InputError(name + ": expected a file, found a directory");
        throw InputError(fmt::format("{}: cannot be read: {}", name, std::generic_category().message(errno)));
    };
}

std::string detail::peek(ByteSource& source, std::size_t count) {
    std::string first(count, '\0');
    std::size_t filled = 0;
    for (std::size_t got = 1; filled < count && got > 0; filled += got)
        got = source({first.data() + filled, count - filled});
    first.resize(filled);
    struct Begun {
        std::string first;
        ByteSource rest;
        std::size_t given = 0;
    };
    source = [begun = std::make_shared<Begun>(Begun{first, std::move(source)})](std::span<char> to) {
        auto& [begin, rest, given] = *begun;
        if (given == begin.size()) return rest(to);
        std::size_t const now = std::min(to.size(), begin.size() - given);
        std::copy_n(begin.data() + given, now, to.data());
        given += now;
        return now;
    };
    return first;
}

}  // namespace rlslab
