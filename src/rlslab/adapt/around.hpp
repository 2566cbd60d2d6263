// What every type around a filter answers as the filter does.
#pragma once

#include <rlslab/adapt/time_update.hpp>

namespace rlslab::detail {

/// The base of the types around a filter F: F itself, and F's answers where the type has none of its own. shows_form:
/// others may discount, inflate and reset F through the type.
template <class F, bool shows_form = false>
class AroundFilter {
protected:
    F filter_;
    explicit AroundFilter(F const& filter) : filter_(filter) {}

public:
    using scalar = typename F::scalar;
    static constexpr std::string_view name = F::name;

    auto theta() const { return filter_.theta(); }
    auto gain() const { return filter_.gain(); }
    Stored<scalar> stored() const { return filter_.stored(); }
    auto form()
        requires(shows_form && NamesItsForm<F>)
    {
        return filter_.form();
    }
    F const& filter() const { return filter_; }
};

}  // namespace rlslab::detail
