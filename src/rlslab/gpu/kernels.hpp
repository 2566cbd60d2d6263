// The forms of fleets on a GPU, and their kernels by form and size: RLSLAB_LANES(form, class, scalar, size) and
// RLSLAB_TEAM(form, scalar, lanes, size or 0 for any), for the device (kernels.cu) and for what stands for it in tests.
#pragma once

#include <rlslab/gpu/team.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

namespace rlslab::gpu {

/// f(std::type_identity<F>) of the form F of that name over T; false where there is none.
template <class T, class Function>
bool of_form(std::string_view name, Function const& f) {
    auto const one = [&]<class F>(std::type_identity<F> type) { return F::name == name && (f(type), true); };
    using std::type_identity;
    return one(type_identity<Ud<T>>{}) || one(type_identity<UdDelta<T>>{}) || one(type_identity<Conventional<T>>{}) ||
           one(type_identity<Carlson<T>>{}) || one(type_identity<Gentleman<T>>{}) || one(type_identity<Qr<T>>{}) ||
           one(type_identity<InverseQr<T>>{});
}

}  // namespace rlslab::gpu

#define RLSLAB_BOTH(NAME, F, D) RLSLAB_LANES(NAME, F, float, D) RLSLAB_LANES(NAME, F, double, D)
#define RLSLAB_WITH_TEAMS(D) \
    RLSLAB_BOTH(ud, Ud, D) RLSLAB_BOTH(ud_delta, UdDelta, D) RLSLAB_BOTH(conventional, Conventional, D)
#define RLSLAB_WITHOUT_TEAMS(D)      \
    RLSLAB_BOTH(carlson, Carlson, D) \
    RLSLAB_BOTH(inverse_qr, InverseQr, D) RLSLAB_BOTH(qr, Qr, D) RLSLAB_BOTH(gentleman, Gentleman, D)
#define RLSLAB_TEAMS_OF(NAME, T, LANES) RLSLAB_TEAM(NAME, T, LANES, 0) RLSLAB_TEAM(NAME, T, LANES, LANES)
#define RLSLAB_TEAMS(NAME)           \
    RLSLAB_TEAMS_OF(NAME, float, 16) \
    RLSLAB_TEAMS_OF(NAME, float, 32) RLSLAB_TEAMS_OF(NAME, double, 16) RLSLAB_TEAMS_OF(NAME, double, 32)
