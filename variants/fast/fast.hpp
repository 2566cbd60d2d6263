// THE list of fast forms. A new one is its file and two lines here.
#pragma once

#include <rlslab/core/type_list.hpp>
#include <rlslab/fast/error_feedback_lattice.hpp>
#include <rlslab/fast/lattice.hpp>
#include <rlslab/fast/qr_lattice.hpp>
#include <rlslab/fast/stabilised_transversal.hpp>
#include <rlslab/fast/transversal.hpp>

namespace rlslab {

namespace detail {
/// T if T has a square root. Otherwise double, so that `OverScalar` leaves the form out of T's list.
template <Field T>
using RootedField = std::conditional_t<Real<T>, T, double>;
}  // namespace detail

/// Every fast form that exists in the arithmetic T, in the order in which people read about them.
template <Field T>
using FastForms = OverScalar<T,
    Transversal<T>,
    StabilisedTransversal<T>,
    Lattice<T>,
    ErrorFeedbackLattice<T>,
    QrLattice<detail::RootedField<T>>>;

}  // namespace rlslab
