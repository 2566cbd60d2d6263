// Relative errors in what a variant uses as its gain.
#pragma once

#include <rlslab/core/concept.hpp>

#include <span>
#include <vector>

namespace rlslab {

/// AnyFilter::update's errors.
template <class T>
struct RelativeErrors {
    Matrix<double> const& relative;
    std::vector<T> left;  ///< of the running gain, by the column before

    void operator()(auto& K) {
        for (Index i = 0; i < K.size(); ++i) K[i] += K[i] * T(relative(i, relative.cols() - 1));
    }
    void operator()(std::span<T> v, T const& kept) {
        bool const stays = relative.cols() > 1;
        Index const column = stays ? Index(v.size()) - 1 : 0;
        for (size_t i = 0; i < v.size(); ++i) {
            bool const fresh = stays || i + 1 == v.size();  // else what is new in v_i alone: the rest has its error
            T const changed = fresh ? v[i] : T(v[i] - kept * left[i]);
            left[i] = v[i] += changed * T(relative(Index(i), column));
        }
    }
};

}  // namespace rlslab
