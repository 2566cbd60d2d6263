// The only place where variants are compiled in significands that round at random.
#include "studies/definiteness/random_filters.hpp"

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {
namespace {

using T = RandomlyRounded;

template <RecursiveLeastSquares F>
CatalogueEntry entry_in(Arithmetic const* arithmetic) {
    return {F::name,          arithmetic, StartsWithoutPrior<F>, 1, ReportsCovariance<F> ? "covariance" : "information", GainPerturbable<F>,
            &Erased<F>::make, nullptr};
}

}  // namespace

CatalogueEntry const& randomly_rounded(std::string_view variant) {
    static Arithmetic const arithmetic = arithmetic_of<T>();
    static std::vector<CatalogueEntry> const entries{
        entry_in<Symmetric<T>>(&arithmetic), entry_in<Joseph<T>>(&arithmetic),  entry_in<JosephRankTwo<T>>(&arithmetic),
        entry_in<Ud<T>>(&arithmetic),        entry_in<Carlson<T>>(&arithmetic), entry_in<InverseQr<T>>(&arithmetic),
        entry_in<Qr<T>>(&arithmetic)};
    for (CatalogueEntry const& entry : entries)
        if (entry.variant == variant) return entry;
    throw std::logic_error("no such variant rounds at random");
}

}  // namespace rlslab::studies
