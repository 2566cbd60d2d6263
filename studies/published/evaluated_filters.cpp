// The only place where variants are compiled with another evaluation.
#include "studies/published/evaluated_filters.hpp"

#include <rlslab/catalogue/erase.hpp>
#include "studies/published/evaluated_double.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {
namespace {

template <class T>
CatalogueEntry const* found(std::string_view variant) {
    static Arithmetic const arithmetic = arithmetic_of<T>();
    static std::vector<CatalogueEntry> const entries = [] {
        std::vector<CatalogueEntry> out;
        using Some = TypeList<ConventionalTwoSided<T>, Symmetric<T>, Joseph<T>, JosephRankTwo<T>, Potter<T>, Carlson<T>,
                              Ud<T>, InverseQr<T>, Information<T>, Qr<T>, Gentleman<T>, ExtendedQr<T>>;
        for_each(Some{}, [&]<class F>() { out.push_back(untimed_entry_of<F>(&arithmetic)); });
        return out;
    }();
    for (CatalogueEntry const& entry : entries)
        if (entry.variant == variant) return &entry;
    return nullptr;
}

}  // namespace

CatalogueEntry const& evaluated(std::string_view variant, std::string_view evaluation) {
    CatalogueEntry const* const entry = evaluation == "lanes" ? found<EvaluatedDouble<false, DotOrder::lanes>>(variant)
                                        : evaluation == "fused"    ? found<FusedDouble>(variant)
                                        : evaluation == "forward"  ? found<ForwardDouble>(variant)
                                        : evaluation == "backward" ? found<BackwardDouble>(variant)
                                                                   : nullptr;
    if (!entry) throw std::logic_error("no such variant, or no such evaluation");
    return *entry;
}

}  // namespace rlslab::studies
