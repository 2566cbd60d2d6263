// The dot product: eight running lanes, then the tree ((0+4)+(2+6)) + ((1+5)+(3+7)), absent lanes left out.
#pragma once

#include <rlslab/arithmetic/field.hpp>

#include <Eigen/Core>
#include <algorithm>

namespace rlslab {

using Index = Eigen::Index;

/// x'y over n numbers; n >= 1.
template <Field T>
T dot(T const* x, T const* y, Index n) {
    T lane[8];
    Index const lanes = std::min<Index>(n, 8);
    for (Index i = 0; i < lanes; ++i) lane[i] = x[i] * y[i];
    Index k = 8;
    for (; k + 8 <= n; k += 8)
        for (Index i = 0; i < 8; ++i) lane[i] += x[k + i] * y[k + i];
    for (Index i = 0; k + i < n; ++i) lane[i] += x[k + i] * y[k + i];
    for (Index half = 4; half >= 1; half /= 2)
        for (Index i = 0; i < half && i + half < lanes; ++i) lane[i] += lane[i + half];
    return lane[0];
}

}  // namespace rlslab
