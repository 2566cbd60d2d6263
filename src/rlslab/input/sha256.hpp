// SHA-256 (FIPS 180-4): the name of a file's bytes in a result, so that a later reader can tell whether he has the same
// file.
#pragma once

#include <rlslab/input/bytes.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace rlslab {

/// The digest of the bytes that were added, in their order.
class Sha256 {
    std::array<std::uint32_t, 8> h_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                    0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<unsigned char, 64> block_{};
    std::uint64_t bytes_ = 0;

    void take_block(unsigned char const* block);

public:
    void add(std::span<char const> bytes);
    /// 64 hexadecimal digits of all bytes so far.
    std::string hex() const;
};

/// The same source; what is read from it is added to the digest.
ByteSource digested(ByteSource source, std::shared_ptr<Sha256> into);

}  // namespace rlslab
