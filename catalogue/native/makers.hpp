// The filters that the object library of one arithmetic makes.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/core/problem.hpp>

#include <vector>

namespace rlslab::native {

template <class T>
struct Maker {
    std::string_view variant;
    std::unique_ptr<Filter> (*make)(Problem<T> const&);
};
/// In the order of the list of variants; for float and for double.
template <class T>
std::vector<Maker<T>> const& makers();
template <>
std::vector<Maker<float>> const& makers<float>();
template <>
std::vector<Maker<double>> const& makers<double>();

}  // namespace rlslab::native
