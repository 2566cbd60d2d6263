// What a filter and a fleet by name are made of, in one arithmetic.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/catalogue/native/outputs.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/core/stored.hpp>
#include <rlslab/state/state_format.hpp>

#include <functional>
#include <string>

namespace rlslab {
template <Real T>
class AnyAdaptive;
}

namespace rlslab::native {

[[noreturn]] inline void refuse(std::string const& why) { throw std::invalid_argument(why); }

/// F of the stored numbers, F F' = P or P^-1. Throws std::invalid_argument, in one line, where no square root is
/// stored.
template <class T>
Matrix<T> const& root_in(Stored<T> const& stored, std::string_view variant) {
    if (stored.form != Stored<T>::Form::factor || stored.D.size() > 0)
        refuse(std::string(variant) + " stores no square root of its matrix");
    return stored.F;
}

/// Why bytes are no state for a filter, and of what they are one.
std::string refusal_of(StateFault fault, std::span<std::byte const> from);

/// Made so, and made again where it is reset. For float and double.
template <Real T>
std::unique_ptr<Filter> filter_of(std::function<AnyAdaptive<T>()> const& make);

/// Filters like `fresh`, one after another; prior: whether they start with one. For float and double.
template <Real T>
std::unique_ptr<Fleet> fleet_of(Index filters, AnyAdaptive<T> const& fresh, bool prior);

/// Null where there is none. For float and double.
template <class T>
std::unique_ptr<Fleet> fleet_named(std::string_view variant, Index filters, Problem<T> const&);
template <class T>
std::unique_ptr<Outputs> outputs_named(std::string_view variant, Index outputs, Problem<T> const&);
/// Complex numbers of both, too.
template <class N>
std::unique_ptr<Fleet> output_fleet_named(std::string_view variant, Index filters, Index outputs, Problem<N> const&);

}  // namespace rlslab::native
