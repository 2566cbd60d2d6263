// The wide scalars: Quad (113 bits), Reference (257 bits), Rational (exact); and `widen`, an exact conversion.
//
// Their precision is fixed, no global precision is read, and expression templates are off: `auto` holds a value.
#pragma once

#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/arithmetic/storage_traits.hpp>

#include <boost/multiprecision/gmp.hpp>
#include <boost/multiprecision/mpfr.hpp>

namespace rlslab {

/// MPFR at 77 decimal digits, 257 bits: long enough that an error seen in it comes from the method, not from rounding.
using Reference =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<77, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;
/// Exact rationals: the identities of recursive least squares hold with ==.
using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;

template <>
struct ArithmeticTraits<Reference> {
    static constexpr std::string_view name = "reference";
    static constexpr int digits = 257, min_exp = -1073741824, max_exp = 1073741822;
};

template <>
struct Encoding<Reference> {
    using Bytes = detail::MpfrEncoding<257>;
    static constexpr std::size_t size = Bytes::size;
    static void write(Reference const& x, std::byte* to) { Bytes::write(x.backend().data(), to); }
    static bool read(std::byte const* from, Reference& x) { return Bytes::read(from, x.backend().data()); }
};

template <>
inline bool is_finite(Rational const&) {
    return true;
}

/// The same number in the Reference arithmetic, exactly: every arithmetic of the lab has at most 257 bits.
inline Reference widen(Reference const& x) { return x; }
inline Reference widen(std::floating_point auto x) { return Reference(x); }
template <class T>
    requires(!std::floating_point<T> && ArithmeticTraits<T>::digits <= 53)
Reference widen(T const& x) {
    return Reference(static_cast<double>(x));
}
inline Reference widen(Quad const& x) {
    Reference out;
    Quad::View const exact = x.mpfr();  // named: mpfr_set may be a macro
    mpfr_set(out.backend().data(), exact, MPFR_RNDN);
    return out;
}

}  // namespace rlslab

template <>
struct Eigen::NumTraits<rlslab::Reference> : rlslab::detail::StorageTraits<rlslab::Reference> {};
template <>
struct Eigen::NumTraits<rlslab::Rational> : rlslab::detail::StorageTraits<rlslab::Rational> {
    /// There is no largest rational. Eigen gets double's largest number, which bounds all data.
    static rlslab::Rational highest() { return rlslab::Rational((std::numeric_limits<double>::max)()); }
    static rlslab::Rational lowest() { return -highest(); }
    static rlslab::Rational epsilon() { return 0; }
    static rlslab::Rational dummy_precision() { return 0; }
    static int digits10() { return 0; }
};
