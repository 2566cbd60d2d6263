// The storage of a variant's state: a vector of d numbers, and a d x d matrix stored by columns. A fixed d needs no
// heap.
#pragma once

#include <rlslab/core/problem.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <new>
#include <utility>
#include <vector>

namespace rlslab {

/// The arithmetics whose kernels are compiled for the machine's registers. A Cortex-M has none that hold several
/// numbers: beyond eight parameters the text for any arithmetic takes fewer instructions there, with the same bits.
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M'
template <class T>
concept Hardware = false;
#else
template <class T>
concept Hardware = std::same_as<T, float> || std::same_as<T, double>;
#endif

/// The length of a column of `size` numbers in memory. For float and double it is a multiple of the block of rows on
/// which kernels work (8; 4 for fixed sizes up to 4). What the padding holds never enters a result.
template <class T, int N>
constexpr Index padded(Index size) {
    if (!Hardware<T>) return size;
    return N != Dynamic && N <= 4 ? 4 : (size + 7) & ~Index(7);
}

/// Numbers from one column of a matrix to the next: a column's length and, where that is a multiple of 1024 bytes, a
/// few cache lines more. Without them the numbers of a row would fall into the same few sets of the caches. (Of 1, 3
/// and 5 lines, 5 was the fastest from 512 doubles on, and 1 at 128.)
template <class T, int N>
constexpr Index column_stride(Index size) {
    Index const length = padded<T, N>(size), bytes = length * Index(sizeof(T)), line = 64;
    if (!Hardware<T> || bytes % 1024 != 0) return length;
    return length + std::min<Index>(bytes / 1024, 5) * line / Index(sizeof(T));
}

namespace detail {
/// An allocator of memory that begins on a cache line.
template <class T>
struct Aligned {
    using value_type = T;
    static constexpr std::align_val_t alignment{64};
    Aligned() = default;
    template <class Other>
    Aligned(Aligned<Other> const&) {}
    T* allocate(size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
    void deallocate(T* p, size_t) { ::operator delete(p, alignment); }
    friend bool operator==(Aligned, Aligned) { return true; }
};

/// A size that becomes 0 when it is moved from: a filter that was moved from has size 0 and refuses every row.
struct MovedSize {
    Index value;
    explicit MovedSize(Index size) : value(size) {}
    MovedSize(MovedSize const&) = default;
    MovedSize(MovedSize&& other) noexcept : value(std::exchange(other.value, 0)) {}
    MovedSize& operator=(MovedSize const&) = default;
    MovedSize& operator=(MovedSize&& other) noexcept {  // of itself, too: the numbers are gone then
        Index const moved = this == &other ? 0 : other.value;
        other.value = 0;
        value = moved;
        return *this;
    }
};

/// Whether n numbers at a and m at b have none in common.
template <class T>
bool disjoint(T const* a, Index n, T const* b, Index m) {
    std::less_equal<> const up_to;
    return up_to(a + n, b) || up_to(b + m, a);
}

/// `numbers` zeros: an array when the capacity is fixed, otherwise a vector that is never resized after construction,
/// with the size d that it was made for. A fixed d is not stored.
template <class T, int Capacity>
struct Buffer {
    static constexpr size_t alignment = Hardware<T> ? std::min<size_t>(32, size_t(Capacity) * sizeof(T)) : alignof(T);
    alignas(alignment) std::array<T, size_t(Capacity)> values;
    Buffer(Index, Index) { values.fill(T(0)); }
};
template <class T>
struct Buffer<T, Dynamic> {
    std::vector<T, std::conditional_t<Hardware<T>, Aligned<T>, std::allocator<T>>> values;
    MovedSize held;
    Buffer(Index numbers, Index size) : values(size_t(numbers), T(0)), held(size) {}
};
}  // namespace detail

/// d numbers, zero at first. N: d if it is fixed, or Dynamic. The constructor may throw std::bad_alloc if N is Dynamic.
/// view() is Eigen's map of the d numbers; it is valid while this object exists and is not moved.
template <class T, int N = Dynamic>
class StateVector {
    static constexpr int Capacity = N == Dynamic ? Dynamic : int(padded<T, N>(N));
    detail::Buffer<T, Capacity> buffer_;

public:
    explicit StateVector(Index size) : buffer_(padded<T, N>(size), size) {}
    Index size() const {
        if constexpr (N == Dynamic) return buffer_.held.value;
        else return N;
    }
    T* data() { return buffer_.values.data(); }
    T const* data() const { return buffer_.values.data(); }
    T& operator[](Index i) { return data()[i]; }
    T const& operator[](Index i) const { return data()[i]; }
    auto view() const { return Eigen::Map<Vector<T, N> const>(data(), size()); }
};

namespace detail {
/// The stride of a matrix: stored where the size is not fixed, since every access needs it.
template <class T, int N>
struct Stride {
    explicit Stride(Index) {}
    static constexpr Index value() { return column_stride<T, N>(N); }
};
template <class T>
struct Stride<T, Dynamic> {
    Index numbers;
    explicit Stride(Index size) : numbers(column_stride<T, Dynamic>(size)) {}
    Index value() const { return numbers; }
};
}  // namespace detail

/// d x d numbers by columns, zero at first; N and view() as above. A column has stride() >= d numbers in memory.
template <class T, int N = Dynamic>
class StateMatrix {
    static constexpr int Capacity = N == Dynamic ? Dynamic : N * int(column_stride<T, N>(N));
    detail::Buffer<T, Capacity> buffer_;
    [[no_unique_address]] detail::Stride<T, N> stride_;

public:
    explicit StateMatrix(Index size) : buffer_(size * column_stride<T, N>(size), size), stride_(size) {}
    Index size() const {
        if constexpr (N == Dynamic) return buffer_.held.value;
        else return N;
    }
    Index stride() const { return stride_.value(); }  ///< numbers from one column to the next
    T* column(Index j) { return buffer_.values.data() + j * stride(); }
    T const* column(Index j) const { return buffer_.values.data() + j * stride(); }
    T& operator()(Index i, Index j) { return column(j)[i]; }
    T const& operator()(Index i, Index j) const { return column(j)[i]; }
    auto view() const {
        using Stride = Eigen::OuterStride<>;
        return Eigen::Map<Matrix<T, N> const, 0, Stride>(column(0), size(), size(), Stride(stride()));
    }
};

/// A symmetric matrix of d x d numbers, zero at first; N as above. The blocks on and above the diagonal are stored,
/// each by columns, one block column after the other: half the memory of a square. A block is 8 x 8 (4 x 4 at fixed
/// sizes up to 4).
template <class T, int N = Dynamic>
class SymmetricMatrix {
public:
    static constexpr Index side = padded<T, N>(1);  ///< of a block

private:
    static constexpr Index numbers(Index size) {
        Index const blocks = (size + side - 1) / side;
        return blocks * (blocks + 1) / 2 * side * side;
    }
    static constexpr int Capacity = N == Dynamic ? Dynamic : int(numbers(N));
    detail::Buffer<T, Capacity> buffer_;

public:
    explicit SymmetricMatrix(Index size) : buffer_(numbers(size), size) {}
    explicit SymmetricMatrix(StateMatrix<T, N> const& A) : SymmetricMatrix(A.size()) {
        for (Index j = 0; j < size(); ++j)
            for (Index i = 0; i < size(); ++i) (*this)(i, j) = A(i, j);
    }
    Index size() const {
        if constexpr (N == Dynamic) return buffer_.held.value;
        else return N;
    }
    T* data() { return buffer_.values.data(); }
    T const* data() const { return buffer_.values.data(); }
    auto& stored() { return buffer_.values; }  ///< every number, padding too

    /// A_ij and A_ji are one number, or two in a block on the diagonal: who changes one changes the other.
    T const& operator()(Index i, Index j) const {
        Index const I = i / side, J = j / side;
        return I > J ? (*this)(j, i) : data()[(J * (J + 1) / 2 + I) * side * side + j % side * side + i % side];
    }
    T& operator()(Index i, Index j) { return const_cast<T&>(std::as_const(*this)(i, j)); }
    /// column(j)[i] is A_ij.
    auto column(Index j) const {
        struct Column {
            SymmetricMatrix const& A;
            Index j;
            T const& operator[](Index i) const { return A(i, j); }
        };
        return Column{*this, j};
    }
    /// An expression of the d x d numbers, valid as above.
    auto view() const {
        auto entry = [this](Index i, Index j) { return (*this)(i, j); };
        // Matrix<T, N>::NullaryExpr would be of a type that Eigen aligns as the instruction set has it.
        return Eigen::CwiseNullaryOp<decltype(entry), Matrix<T, N>>(size(), size(), entry);
    }
};
/// The storage of a symmetric matrix in every arithmetic.
template <class T, int N>
using SymmetricStorage = std::conditional_t<Hardware<T>, SymmetricMatrix<T, N>, StateMatrix<T, N>>;

}  // namespace rlslab
