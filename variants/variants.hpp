// THE list of variants. A new one is its file and two lines here; tests, studies and the program go through the list.
#pragma once

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/carlson_delta.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/conventional_two_sided.hpp>
#include <rlslab/variants/extended_qr.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/inverse_qr_delta.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/kalman.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/qr_block.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>
#ifdef RLSLAB_SPARSE
#include <rlslab/variants/cholesky_sparse.hpp>
#include <rlslab/variants/qr_sparse.hpp>
#endif

namespace rlslab {

namespace detail {
/// T if T has a square root. Otherwise double, so that `OverScalar` leaves the square-root forms out of T's list.
template <Scalar T>
using Rooted = std::conditional_t<RootedScalar<T>, T, double>;
}  // namespace detail

/// Every variant that exists in the arithmetic T, in the order in which people read about them.
template <Scalar T, class R = detail::Rooted<T>>
using Variants = OverScalar<T,
    Conventional<T>,
    ConventionalTwoSided<T>,
    Symmetric<T>,
    Joseph<T>,
    JosephRankTwo<T>,
    Potter<R>,
    Carlson<R>,
    CarlsonDelta<R>,
    Ud<T>,
    UdDelta<T>,
    InverseQr<R>,
    InverseQrDelta<R>,
    Kalman<T>,
    Information<T>,
    Qr<R>,
    Gentleman<T>,
    ExtendedQr<R>,
    QrBlock<R>
#ifdef RLSLAB_SPARSE
    ,
    QrSparse,
    CholeskySparse
#endif
    >;

}  // namespace rlslab
