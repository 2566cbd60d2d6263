// Binary128 has Quad's roundings, and its bytes in saved states.
#include <rlslab/arithmetic/binary128.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/core/random.hpp>

#include <gtest/gtest.h>

#ifdef RLSLAB_BINARY128
namespace rlslab {
namespace {

template <class T>
std::array<std::byte, Encoding<Quad>::size> bytes_of(T const& x) {
    static_assert(Encoding<T>::size == Encoding<Quad>::size);
    std::array<std::byte, Encoding<Quad>::size> out;
    Encoding<T>::write(x, out.data());
    return out;
}
Binary128 as_binary128(Quad const& x) {
    Binary128 out;
    EXPECT_TRUE(Encoding<Binary128>::read(bytes_of(x).data(), out));
    return out;
}
Quad random_number(Seed& seed, int around) {
    Quad const fine = Quad(seed.bell()) + Quad(seed.bell()) * Quad(0x1p-52) + Quad(seed.bell()) * Quad(0x1p-104);
    return ldexp(fine, around + int(seed.next() % 9));
}

TEST(Binary128, RoundsAsQuadDoes) {
    Seed seed{8};
    for (int const around : {0, -16383, -16440, -8200, 16370}) {
        for (int k = 0; k < 5000; ++k) {
            Quad const a = random_number(seed, around), b = random_number(seed, around);
            Binary128 const x = as_binary128(a), y = as_binary128(b);
            ASSERT_EQ(bytes_of(x), bytes_of(a));
            ASSERT_EQ(bytes_of(x + y), bytes_of(a + b));
            ASSERT_EQ(bytes_of(x - y), bytes_of(a - b));
            ASSERT_EQ(bytes_of(x * y), bytes_of(a * b));
            ASSERT_EQ(bytes_of(x / y), bytes_of(a / b));
            ASSERT_EQ(bytes_of(-x), bytes_of(-a));
            ASSERT_EQ(x < y, a < b);
            ASSERT_EQ(double(x), double(a));
            ASSERT_EQ(float(x), float(a));
        }
    }
}
TEST(Binary128, ValuesThatAreNoNumbers) {
    double const inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    for (double const a : {0.0, -0.0, 1.0, -3.5, inf, -inf, nan, 0x1p-1074}) {
        EXPECT_EQ(bytes_of(Binary128(a)), bytes_of(Quad(a))) << a;
        EXPECT_EQ(isfinite(Binary128(a)), std::isfinite(a));
        EXPECT_EQ(isnan(Binary128(a)), std::isnan(a));
        EXPECT_EQ(isnan(as_binary128(Quad(a))), std::isnan(a));
        for (double const b : {0.0, 1.0, inf, nan}) {
            EXPECT_EQ(Binary128(a) == Binary128(b), a == b);
            EXPECT_EQ(Binary128(a) <= Binary128(b), a <= b);
            EXPECT_EQ(Binary128(a) > Binary128(b), a > b);
        }
    }
    EXPECT_EQ(bytes_of(Binary128(-7)), bytes_of(Quad(-7)));
}
TEST(Binary128, BytesThatNoNumberHasAreRefused) {
    auto const good = bytes_of(Quad(1.25));
    Binary128 x;
    Quad q;
    for (std::size_t i = 0; i < good.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            auto bytes = good;
            bytes[i] ^= std::byte(1 << bit);
            EXPECT_EQ(Encoding<Binary128>::read(bytes.data(), x), Encoding<Quad>::read(bytes.data(), q))
                << i << ' ' << bit;
        }
}

}  // namespace
}  // namespace rlslab
#endif
