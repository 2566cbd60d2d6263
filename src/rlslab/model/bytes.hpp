// Where data come from: bytes in order, once, from a file, standard input, memory, or through what unpacks them.
#pragma once

#include <rlslab/core/input_error.hpp>

#include <functional>
#include <span>

namespace rlslab {

/// Writes the next bytes to the start of `to` and says how many; 0: there are no more. Throws InputError that names the file.
/// Copies take from the same bytes.
using ByteSource = std::function<std::size_t(std::span<char> to)>;

/// What messages call a path: printable; "-" is standard input.
std::string name_of_file(std::string const& path);

/// The bytes of a file ("-": standard input; a FIFO is fine). Throws InputError when it cannot be opened or, later, read.
ByteSource bytes_of_file(std::string const& path);

/// The first `count` bytes of the source, or all if it has fewer; the source gives them again.
std::string peek(ByteSource& source, std::size_t count);

}  // namespace rlslab
