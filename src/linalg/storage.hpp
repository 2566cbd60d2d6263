// Where a variant keeps its numbers: a column of d, a square of d x d stored by columns; inline when d is fixed.
#pragma once

#include <rlslab/problem.hpp>

#include <array>
#include <vector>

namespace rlslab {

namespace detail {
/// size() numbers: an array when the capacity is fixed, else a vector that is never resized after construction.
template <class T, int Capacity>
struct Buffer {
    std::array<T, Capacity> values;
    explicit Buffer(Index) { values.fill(T(0)); }
};
template <class T>
struct Buffer<T, Dynamic> {
    std::vector<T> values;
    explicit Buffer(Index size) : values(size_t(size), T(0)) {}
};
}  // namespace detail

/// d numbers, zero at first.
template <class T, int N = Dynamic>
class Column {
    detail::Buffer<T, N> buffer_;

public:
    explicit Column(Index size) : buffer_(size) {}
    Index size() const { return N == Dynamic ? Index(buffer_.values.size()) : N; }
    T* data() { return buffer_.values.data(); }
    T const* data() const { return buffer_.values.data(); }
    T& operator[](Index i) { return data()[i]; }
    T const& operator[](Index i) const { return data()[i]; }
    auto view() const { return Eigen::Map<Vector<T, N> const>(data(), size()); }
};

/// d x d numbers by columns, zero at first.
template <class T, int N = Dynamic>
class Square {
    static constexpr int Capacity = N == Dynamic ? Dynamic : N * N;
    detail::Buffer<T, Capacity> buffer_;
    Index size_;

public:
    explicit Square(Index size) : buffer_(size * size), size_(size) {}
    Index size() const { return N == Dynamic ? size_ : N; }
    T* column(Index j) { return buffer_.values.data() + j * size(); }
    T const* column(Index j) const { return buffer_.values.data() + j * size(); }
    T& operator()(Index i, Index j) { return column(j)[i]; }
    T const& operator()(Index i, Index j) const { return column(j)[i]; }
    auto view() const { return Eigen::Map<Matrix<T, N> const>(column(0), size(), size()); }
};

}  // namespace rlslab
