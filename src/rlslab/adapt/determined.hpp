// Whether the rows so far determine theta.
#pragma once

#include <rlslab/adapt/time_update.hpp>

namespace rlslab::detail {

/// Whether the rows determine theta, with what f holds: of a form of P^-1 that its pivots are above their rounding (as
/// its health asks), of qr_block also that none is 0; of what is around a filter, that filter's; true of a form of P,
/// which began with a prior. Cost O(d^2) at most; `information` may solve, as theta() does.
template <class F>
bool is_determined(F& f) {
    if constexpr (requires { f.determined(); }) {  // the run knows
        return f.determined();
    } else if constexpr (requires { f.form().lengths, f.form().D; }) {
        auto const form = f.form();
        return form.lengths.determined(form.L, form.D);
    } else if constexpr (requires { f.form().lengths; }) {
        auto const form = f.form();
        return form.lengths.determined(form.L);
    } else if constexpr (requires { f.form().started; }) {
        auto form = f.form();
        if (!form.solved) form.solve();
        return form.started && form.positive;
    } else if constexpr (requires { f.last_row().lengths; }) {
        auto const form = f.last_row();
        return form.lengths.determined(form.L) && nonsingular(form.L);
    } else if constexpr (requires { f.filter(); }) {
        return is_determined(const_cast<std::remove_cvref_t<decltype(f.filter())>&>(f.filter()));
    } else {
        return true;
    }
}

}  // namespace rlslab::detail
