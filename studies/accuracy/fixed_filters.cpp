// The only place where the variants are compiled in fixed-point words.
#include "studies/accuracy/fixed_filters.hpp"

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {
namespace {

template <RecursiveLeastSquares F>
CatalogueEntry entry_in(Arithmetic const* arithmetic) {
    Index block = 1;
    if constexpr (TakesBlocks<F>) block = F::block;
    return {
        F::name,          arithmetic, StartsWithoutPrior<F>, block, ReportsCovariance<F> ? "covariance" : "information", GainPerturbable<F>,
        &Erased<F>::make, nullptr};
}

}  // namespace

std::vector<CatalogueEntry> const& fixed_point_filters() {
    static Arithmetic const arithmetic{"fixed", 53, -53, 0, false, [](double x) { return VariableFixed(x).value(); }};
    static std::vector<CatalogueEntry> const entries = [] {
        std::vector<CatalogueEntry> out;
        for_each(Variants<VariableFixed>{}, [&]<class F>() { out.push_back(entry_in<F>(&arithmetic)); });
        return out;
    }();
    return entries;
}

CatalogueEntry const& symmetric_of_any_length() {
    static Arithmetic const arithmetic = arithmetic_of<VariablePrecision>();
    static CatalogueEntry const entry = entry_in<Symmetric<VariablePrecision>>(&arithmetic);
    return entry;
}

}  // namespace rlslab::studies
