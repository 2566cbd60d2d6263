// SHA-256 in blocks of 64 bytes: section numbers are FIPS 180-4's.
#include <rlslab/input/sha256.hpp>

#include <algorithm>
#include <bit>

namespace rlslab {
namespace {

/// 4.2.2: the first 32 bits of the fractions of the cube roots of the first 64 primes.
constexpr std::uint32_t K[64] = {
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

}  // namespace

// 6.2.2
void Sha256::take_block(unsigned char const* block) {
    std::uint32_t W[64];
    for (int t = 0; t < 16; ++t)
        W[t] = std::uint32_t(block[4 * t]) << 24 | std::uint32_t(block[4 * t + 1]) << 16 |
               std::uint32_t(block[4 * t + 2]) << 8 | block[4 * t + 3];
    for (int t = 16; t < 64; ++t) {
        std::uint32_t const s0 = std::rotr(W[t - 15], 7) ^ std::rotr(W[t - 15], 18) ^ W[t - 15] >> 3;
        std::uint32_t const s1 = std::rotr(W[t - 2], 17) ^ std::rotr(W[t - 2], 19) ^ W[t - 2] >> 10;
        W[t] = W[t - 16] + s0 + W[t - 7] + s1;
    }
    auto [a, b, c, d, e, f, g, h] = h_;
    for (int t = 0; t < 64; ++t) {
        std::uint32_t const T1 =
            h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + K[t] + W[t];
        std::uint32_t const T2 =
            (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
        h = g, g = f, f = e, e = d + T1, d = c, c = b, b = a, a = T1 + T2;
    }
    std::uint32_t const last[8] = {a, b, c, d, e, f, g, h};
    for (size_t i = 0; i < 8; ++i) h_[i] += last[i];
}

void Sha256::add(std::span<char const> bytes) {
    for (size_t at = 0; at < bytes.size();) {
        size_t const filled = bytes_ % 64, now = std::min(64 - filled, bytes.size() - at);
        std::copy_n(bytes.data() + at, now, block_.data() + filled);
        bytes_ += now, at += now;
        if (filled + now == 64) take_block(block_.data());
    }
}

std::string Sha256::hex() const {
    Sha256 last = *this;  // 5.1.1: a one, zeros, and the number of bits in 64 bits
    std::uint64_t const bits = 8 * bytes_;
    std::string end(1 + (119 - bytes_ % 64) % 64, '\0');
    end[0] = char(0x80);
    for (int i = 7; i >= 0; --i) end += char(bits >> 8 * i);
    last.add(end);
    std::string out;
    for (std::uint32_t const word : last.h_)
        for (int i = 28; i >= 0; i -= 4) out += "0123456789abcdef"[word >> i & 15];
    return out;
}

ByteSource digested(ByteSource source, std::shared_ptr<Sha256> into) {
    return [source = std::move(source), into = std::move(into)](std::span<char> to) {
        std::size_t const got = source(to);
        into->add(to.first(got));
        return got;
    };
}

}  // namespace rlslab
