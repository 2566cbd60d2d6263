// Gzip's compressed data, unpacked as they are read.
#pragma once

#include <rlslab/model/bytes.hpp>

namespace rlslab {

/// What begins compressed data.
inline constexpr std::string_view gzip_begins = "\x1f\x8b";

/// The bytes that `packed` holds, part behind part where files were joined. Memory does not depend on how much they unpack to.
/// Throws InputError beginning with `name` when they end too early, are damaged, or are followed by something else.
ByteSource unpacked(ByteSource packed, std::string name);
/// The same of one part in zlib's form (RFC 1950), as other files hold it.
ByteSource inflated(ByteSource packed, std::string name);

}  // namespace rlslab
