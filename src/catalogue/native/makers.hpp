// The filters that the object library of one arithmetic makes.
#pragma once

#include <rlslab/adapt/guard.hpp>
#include <rlslab/catalogue/native/composition.hpp>
#include <rlslab/catalogue/native/filter.hpp>

namespace rlslab::native {

template <class T>
struct Maker {
    std::string_view variant;
    std::unique_ptr<Filter> (*make)(Problem<T> const&);
};
/// In the order of the list of variants. src/catalogue/native/variants_of.cpp defines them.
template <class T>
std::vector<Maker<T>> const& makers();
template <>
std::vector<Maker<float>> const& makers<float>();
template <>
std::vector<Maker<double>> const& makers<double>();

/// Null where there is none. src/catalogue/native/fleets_of.cpp defines them.
template <class T>
std::unique_ptr<Fleet> fleet_named(std::string_view variant, Index filters, Problem<T> const&);
template <>
std::unique_ptr<Fleet> fleet_named(std::string_view, Index, Problem<float> const&);
template <>
std::unique_ptr<Fleet> fleet_named(std::string_view, Index, Problem<double> const&);

/// A composition without contradiction or obstacle. src/catalogue/native/compose.cpp defines them.
template <class T>
std::unique_ptr<Filter> composed(Composition const&, GuardOptions<double> const&, std::string_view variant,
                                 Problem<T> const&);
template <>
std::unique_ptr<Filter> composed(Composition const&, GuardOptions<double> const&, std::string_view,
                                 Problem<float> const&);
template <>
std::unique_ptr<Filter> composed(Composition const&, GuardOptions<double> const&, std::string_view,
                                 Problem<double> const&);

}  // namespace rlslab::native
