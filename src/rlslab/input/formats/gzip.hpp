// Gzip's compressed data, decompressed while they are read.
#pragma once

#include <rlslab/input/bytes.hpp>

namespace rlslab {

/// The first bytes of gzip data.
inline constexpr std::string_view gzip_begins = "\x1f\x8b";

/// The decompressed bytes of `packed`, of all its parts if gzip files were joined. Memory does not depend on their
/// number. The source throws InputError, with a message that begins with `name`, when the data end too early, are
/// damaged, or are followed by anything else.
ByteSource unpacked(ByteSource packed, std::string name);
/// The same for one part in zlib's format (RFC 1950), which other file formats contain.
ByteSource inflated(ByteSource packed, std::string name);

}  // namespace rlslab
