// L filters in lockstep: a scalar that is L numbers, one in each lane. Lane i of every result has the bits that the
// scalar T gives for the numbers of lane i.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>

#include <array>
#include <utility>
#include <cstdint>
#ifdef __x86_64__
#include <emmintrin.h>
#endif

namespace rlslab {

namespace detail {
namespace registers {
#include <rlslab/core/instructions.hpp>
}
/// Bytes of a register of the instruction set for which this translation unit is compiled. GCC makes slow code of wider
/// vectors.
#if defined(__AVX512F__)
inline constexpr int pack_register = 64;
#elif defined(__AVX__)
inline constexpr int pack_register = 32;
#else
inline constexpr int pack_register = 16;
#endif

/// work(k) for k = 0 ... R - 1, each k a constant: the compiler keeps an array in registers only if no loop indexes it.
template <int R, class Work>
[[gnu::always_inline]] inline void for_registers(Work work) {
    [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
        (work(std::integral_constant<int, k>{}), ...);
    }
    (std::make_integer_sequence<int, R>{});
}

template <class T, int L>
struct PackShape {
    static_assert(std::same_as<T, float> || std::same_as<T, double>, "lanes are the hardware's numbers");
    static constexpr int bytes = std::min<int>(pack_register, L* int(sizeof(T)));
    static_assert(L * int(sizeof(T)) % bytes == 0, "L fills whole registers");
    static constexpr int width = bytes / int(sizeof(T)), registers = L / width;
    using Word = std::conditional_t<sizeof(T) == 8, std::int64_t, std::int32_t>;
    // Not of a wide register's own alignment: vectors of packs are also where malloc puts them, at multiples of 16
    // (Eigen, DontAlign).
    static constexpr int alignment = std::min(bytes, 16);
    typedef T Numbers __attribute__((vector_size(bytes), aligned(alignment)));
    typedef Word Bits __attribute__((vector_size(bytes), aligned(alignment)));
    typedef T Anywhere __attribute__((vector_size(bytes), aligned(alignof(T)), may_alias));
};
}  // namespace detail

/// One value for each lane of a type that is not a number of the arithmetic, for example Health or a count of rows.
template <class X, int L>
struct Lanes {
    std::array<X, size_t(L)> value;
    explicit(false) Lanes(X x = {}) { value.fill(x); }
    X const& operator[](int lane) const { return value[size_t(lane)]; }
    Lanes& operator++() {
        for (X& x : value) ++x;
        return *this;
    }
    friend Lanes<bool, L> operator>=(Lanes const& a, X const& b) {
        Lanes<bool, L> out;
        for (size_t i = 0; i < size_t(L); ++i) out.value[i] = a.value[i] >= b;
        return out;
    }
};

/// The result of a comparison of packs: one truth for each lane.
template <class T, int L>
class PackMask {
    using Shape = detail::PackShape<T, L>;
    using Bits = typename Shape::Bits;

public:
    Bits m[Shape::registers];

    PackMask() = default;
    [[gnu::always_inline]] explicit(false) PackMask(bool b) {
        detail::for_registers<Shape::registers>([&](auto k)
                                                    __attribute__((always_inline)) { m[k] = Bits{} - (b ? 1 : 0); });
    }
    explicit PackMask(Lanes<bool, L> const& truths) {
        for (int i = 0; i < L; ++i) m[i / Shape::width][i % Shape::width] = truths[i] ? -1 : 0;
    }
    bool operator[](int lane) const { return m[lane / Shape::width][lane % Shape::width] != 0; }
    [[gnu::always_inline]] friend PackMask operator&&(PackMask const& a, PackMask const& b) {
        PackMask out;
        detail::for_registers<Shape::registers>([&](auto k)
                                                    __attribute__((always_inline)) { out.m[k] = a.m[k] & b.m[k]; });
        return out;
    }
    [[gnu::always_inline]] friend PackMask operator||(PackMask const& a, PackMask const& b) {
        PackMask out;
        detail::for_registers<Shape::registers>([&](auto k)
                                                    __attribute__((always_inline)) { out.m[k] = a.m[k] | b.m[k]; });
        return out;
    }
    [[gnu::always_inline]] friend PackMask operator!(PackMask const& a) {
        PackMask out;
        detail::for_registers<Shape::registers>([&](auto k) __attribute__((always_inline)) { out.m[k] = ~a.m[k]; });
        return out;
    }
    [[gnu::always_inline]] friend bool any(PackMask const& a) {
        Bits seen = a.m[0];
        detail::for_registers<Shape::registers>([&](auto k) __attribute__((always_inline)) { seen |= a.m[k]; });
        return !detail::registers::holds_in_all<T>(Bits(~seen));
    }
    [[gnu::always_inline]] friend bool all(PackMask const& a) { return !any(!a); }
};

/// L numbers of float or double; L fills whole registers. Every operation rounds once in every lane, and nothing is
/// fused.
template <class T, int L>
class Pack {
    using Shape = detail::PackShape<T, L>;
    using Numbers = typename Shape::Numbers;
    static constexpr int R = Shape::registers;

public:
    using Mask = PackMask<T, L>;
    using lane_type = T;
    static constexpr int lanes = L;
    Numbers v[R];

    [[gnu::always_inline]] Pack() : Pack(T(0)) {}
    /// Copies whole registers. GCC's own copy goes by halves, and the next load of a whole register has to wait for
    /// both.
    [[gnu::always_inline]] Pack(Pack const& other) {
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { v[k] = other.v[k]; });
    }
    [[gnu::always_inline]] Pack& operator=(Pack const& other) {
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { v[k] = other.v[k]; });
        return *this;
    }
    /// The same number in every lane.
    [[gnu::always_inline]] explicit Pack(T x) {  // x - 0 is x, also where x is -0
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { v[k] = x - Numbers{}; });
    }
    [[gnu::always_inline]] explicit Pack(int x) : Pack(T(x)) {}
    [[gnu::always_inline]] explicit Pack(double x)
        requires(!std::same_as<T, double>)
        : Pack(T(x)) {}
    [[gnu::always_inline]] explicit Pack(std::array<T, L> const& x) {
        for (int i = 0; i < L; ++i) set(i, x[size_t(i)]);
    }
    /// The L numbers from x on, by whole registers.
    [[gnu::always_inline]] static Pack loaded(T const* x) {
        Pack out(Raw{});
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) {
            out.v[k] = *reinterpret_cast<typename Shape::Anywhere const*>(x + k * Shape::width);
        });
        return out;
    }
    T operator[](int lane) const { return v[lane / Shape::width][lane % Shape::width]; }
    void set(int lane, T x) { v[lane / Shape::width][lane % Shape::width] = x; }

    [[gnu::always_inline]] Pack& operator+=(Pack const& b) { return *this = *this + b; }
    [[gnu::always_inline]] Pack& operator-=(Pack const& b) { return *this = *this - b; }
    [[gnu::always_inline]] Pack& operator*=(Pack const& b) { return *this = *this * b; }
    [[gnu::always_inline]] Pack& operator/=(Pack const& b) { return *this = *this / b; }
    [[gnu::always_inline]] friend Pack operator+(Pack const& a, Pack const& b) {
        return zipped(a, b, [](Numbers x, Numbers y) { return x + y; });
    }
    [[gnu::always_inline]] friend Pack operator-(Pack const& a, Pack const& b) {
        return zipped(a, b, [](Numbers x, Numbers y) { return x - y; });
    }
    [[gnu::always_inline]] friend Pack operator*(Pack const& a, Pack const& b) {
        return zipped(a, b, [](Numbers x, Numbers y) { return x * y; });
    }
    [[gnu::always_inline]] friend Pack operator/(Pack const& a, Pack const& b) {
        return zipped(a, b, [](Numbers x, Numbers y) { return x / y; });
    }
    [[gnu::always_inline]] friend Pack operator-(Pack const& a) {
        return zipped(a, a, [](Numbers x, Numbers) { return -x; });
    }
    [[gnu::always_inline]] friend Mask operator<(Pack const& a, Pack const& b) {
        Mask out;
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { out.m[k] = a.v[k] < b.v[k]; });
        return out;
    }
    [[gnu::always_inline]] friend Mask operator<=(Pack const& a, Pack const& b) {
        Mask out;
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { out.m[k] = a.v[k] <= b.v[k]; });
        return out;
    }
    [[gnu::always_inline]] friend Mask operator==(Pack const& a, Pack const& b) {
        Mask out;
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { out.m[k] = a.v[k] == b.v[k]; });
        return out;
    }
    [[gnu::always_inline]] friend Mask operator!=(Pack const& a, Pack const& b) { return !(a == b); }
    /// x - x is zero for every number, NaN for infinities and NaN.
    [[gnu::always_inline]] friend Mask isfinite(Pack const& a) { return a - a == Pack(); }
    [[gnu::always_inline]] friend Pack sqrt(Pack const& a) {
        return zipped(a, a, [](Numbers x, Numbers) { return Numbers(detail::registers::root_of_each(x)); });
    }
    /// a where the mask is set, else b.
    [[gnu::always_inline]] friend Pack select(Mask const& mask, Pack const& a, Pack const& b) {
        Pack out(Raw{});
        detail::for_registers<R>([&](auto k)
                                     __attribute__((always_inline)) { out.v[k] = mask.m[k] ? a.v[k] : b.v[k]; });
        return out;
    }

private:
    struct Raw {};
    [[gnu::always_inline]] explicit Pack(Raw) {}
    template <class Operation>
    [[gnu::always_inline]] static Pack zipped(Pack const& a, Pack const& b, Operation operation) {
        Pack out(Raw{});
        detail::for_registers<R>([&](auto k) __attribute__((always_inline)) { out.v[k] = operation(a.v[k], b.v[k]); });
        return out;
    }
};

template <class X, class T, int L>
Lanes<X, L> select(PackMask<T, L> const& mask, Lanes<X, L> const& a, Lanes<X, L> const& b) {
    if (all(mask)) return a;
    Lanes<X, L> out = b;
    if (any(mask))
        for (int i = 0; i < L; ++i)
            if (mask[i]) out.value[size_t(i)] = a[i];
    return out;
}

template <class X, int L>
Lanes<X, L> worse(Lanes<X, L> a, Lanes<X, L> const& b) {
    for (size_t i = 0; i < size_t(L); ++i) a.value[i] = worse(a.value[i], b.value[i]);
    return a;
}
template <class T, int L, class X>
struct PerLaneOf<Pack<T, L>, X> {
    using type = Lanes<X, L>;
};

template <class T, int L>
struct ArithmeticTraits<Pack<T, L>> : ArithmeticTraits<T> {};

/// Lane after lane, also of what has such lanes.
template <Encodable X, int L>
struct Encoding<Lanes<X, L>> {
    static constexpr std::size_t size = L * Encoding<X>::size;
    static void write(auto const& x, std::byte* to) {
        for (int i = 0; i < L; ++i) Encoding<X>::write(x[i], to + std::size_t(i) * Encoding<X>::size);
    }
    static bool read(std::byte const* from, Lanes<X, L>& x) {
        for (X& lane : x.value) {
            if (!Encoding<X>::read(from, lane)) return false;
            from += Encoding<X>::size;
        }
        return true;
    }
};
template <class T, int L>
struct Encoding<Pack<T, L>> : Encoding<Lanes<T, L>> {
    static bool read(std::byte const* from, Pack<T, L>& x) {
        Lanes<T, L> lanes;
        bool const read = Encoding<Lanes<T, L>>::read(from, lanes);
        x = Pack<T, L>(lanes.value);
        return read;
    }
};
template <class T, int L>
struct Encoding<PackMask<T, L>> : Encoding<Lanes<bool, L>> {
    static bool read(std::byte const* from, PackMask<T, L>& x) {
        Lanes<bool, L> truths;
        bool const read = Encoding<Lanes<bool, L>>::read(from, truths);
        x = PackMask<T, L>(truths);
        return read;
    }
};

}  // namespace rlslab

template <class T, int L>
struct Eigen::NumTraits<rlslab::Pack<T, L>> : rlslab::detail::StorageTraits<rlslab::Pack<T, L>> {
    using Number = rlslab::Pack<T, L>;
    static Number highest() { return Number(NumTraits<T>::highest()); }
    static Number lowest() { return Number(NumTraits<T>::lowest()); }
};
