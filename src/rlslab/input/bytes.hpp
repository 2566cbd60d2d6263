// Sources of data: bytes, read once and in order, from a file, standard input, memory, or a decompressor.
#pragma once

#include <rlslab/core/cpp20.hpp>

#include <rlslab/core/input_error.hpp>

#include <functional>
#include <span>

namespace rlslab {

/// Writes the next bytes to the start of `to` and returns their number; 0: there are no more. Throws InputError that
/// names the file. Copies of a ByteSource read from the same stream.
using ByteSource = std::function<std::size_t(std::span<char> to)>;

/// The name of a path in messages: printable; "standard input" for "-".
std::string name_of_file(std::string const& path);

/// The bytes of a file ("-": standard input; it may be a FIFO). Throws InputError when it cannot be opened; the source
/// does when it cannot be read.
ByteSource bytes_of_file(std::string const& path);

namespace detail {
/// The first `count` bytes of the source, or all if it has fewer. The source returns them again when it is read.
std::string peek(ByteSource& source, std::size_t count);
}  // namespace detail

}  // namespace rlslab
