// The only place where the variants are compiled in fixed-point words.
#include "studies/accuracy/fixed_runs.hpp"

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {

std::vector<CatalogueEntry> const& fixed_point_filters() {
    static Arithmetic const arithmetic{"fixed", 53, -53, 0, false, [](double x) { return VariableFixed(x).value(); }};
    static std::vector<CatalogueEntry> const entries = [] {
        std::vector<CatalogueEntry> out;
        for_each(Variants<VariableFixed>{}, [&]<class F>() { out.push_back(untimed_entry_of<F>(&arithmetic)); });
        return out;
    }();
    return entries;
}

CatalogueEntry const* rounding_every_operation(std::string_view variant) {
    using T = VariableFixedRounded;
    static Arithmetic const arithmetic{"fixed", 53, -53, 0, false, [](double x) { return T(x).value(); }};
    static CatalogueEntry const entries[] = {untimed_entry_of<Symmetric<T>>(&arithmetic),
                                             untimed_entry_of<Ud<T>>(&arithmetic),
                                             untimed_entry_of<Qr<T>>(&arithmetic)};
    for (CatalogueEntry const& entry : entries)
        if (entry.variant == variant) return &entry;
    return nullptr;
}

}  // namespace rlslab::studies
