// A list of types, and the walk over it.
#pragma once

#include <rlslab/core/scalar.hpp>

#include <type_traits>

namespace rlslab {

template <class... Types>
struct TypeList {
    static constexpr int size = sizeof...(Types);
};

/// Calls visit.template operator()<Type>() for each type in order.
template <class... Types, class Visit>
void for_each(TypeList<Types...>, Visit visit) {
    (visit.template operator()<Types>(), ...);
}

namespace detail {
template <class T, class Chosen, class... Types>
struct OverScalar {
    using type = Chosen;
};
template <class T, class... Chosen, class First, class... Rest>
struct OverScalar<T, TypeList<Chosen...>, First, Rest...> {
    using type = typename OverScalar<
        T,
        std::conditional_t<std::is_same_v<typename First::scalar, T>, TypeList<Chosen..., First>, TypeList<Chosen...>>,
        Rest...>::type;
};
template <int N, template <RootedScalar, int> class F, RootedScalar T, int M>
std::type_identity<F<T, N>> at_size(std::type_identity<F<T, M>>);
template <int N>
std::type_identity<void> at_size(...);
}  // namespace detail

/// F with the fixed size N in place of its own: Ud<double, 4> for Ud<double>. void if F has no size as template
/// argument.
template <class F, int N>
using AtSize = typename decltype(detail::at_size<N>(std::type_identity<F>{}))::type;

/// A TypeList of those of the types whose member `scalar` is T, in order.
template <class T, class... Types>
using OverScalar = typename detail::OverScalar<T, TypeList<>, Types...>::type;

}  // namespace rlslab
