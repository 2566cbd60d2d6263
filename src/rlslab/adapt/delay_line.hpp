// Regressors from the last N samples of a signal, none of them moved.
#pragma once

#include <rlslab/core/problem.hpp>

#include <algorithm>
#include <array>
#include <type_traits>
#include <vector>

namespace rlslab {

/// The last N samples of a signal, newest first: after push(u_k)
///
///   psi_k = (u_k, u_{k-1}, ..., u_{k-N+1}),    samples before the first being 0.
///
/// Each sample is written twice, N places apart, into a ring of 2 N. The last N then lie one after another, and a step
/// costs two stores, where a shift register moves N numbers.
///
///   (1) at = (at - 1) mod N        (2) ring[at] = ring[at + N] = u        (3) psi = ring[at ... at + N - 1]
///
/// u       stored as it is, also where it is not finite; N samples later it has left
/// N       d, fixed: no heap; or Dynamic: DelayLine<T>(d) allocates when it is made and never again
/// psi()   points into the line: good until the next push, and while the line is where it is. Copying copies the
/// samples. A line of Dynamic size that was moved from has size 0, and push leaves it so.
/// Throws std::invalid_argument where the size is below 1, or not N. Storage 2 N.
/// Source: folklore (a mirrored ring buffer).
template <Scalar T, int N = Dynamic>
class DelayLine {
    static_assert(N == Dynamic || N >= 1, "a delay line has at least one sample");
    std::conditional_t<N == Dynamic, std::vector<T>, std::array<T, size_t(N == Dynamic ? 1 : 2 * N)>> ring_;
    Index at_ = 0;

public:
    explicit DelayLine(Index size = N) {
        expects(size >= 1, "a delay line of at least one sample");
        expects(product_fits(2, size_t(size)), "a delay line that memory could hold");
        expects(N == Dynamic || size == N, "size equal to the delay line's fixed size");
        if constexpr (N == Dynamic) ring_.resize(size_t(2 * size), T(0));
        else ring_.fill(T(0));
    }

    Index size() const { return Index(ring_.size()) / 2; }

    /// Takes the next sample; psi_k.
    Regressor<T> push(T const& u) {
        if (size() == 0) return psi();
        T const sample = u;                                         // which may be one of the line's own
        at_ = (at_ == 0 ? size() : at_) - 1;                        // (1)
        ring_[size_t(at_)] = ring_[size_t(at_ + size())] = sample;  // (2)
        return psi();
    }

    Regressor<T> psi() const { return {size() == 0 ? nullptr : ring_.data() + at_, size()}; }  // (3)

    /// u_{k-i}, 0 <= i < size().
    T const& operator[](Index i) const { return ring_[size_t(at_ + i)]; }

    /// Forgets the samples: zeros.
    void clear() { std::fill(ring_.begin(), ring_.end(), T(0)); }
};

}  // namespace rlslab
