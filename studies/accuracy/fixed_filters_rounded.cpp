// A few variants in fixed-point words that are rounded after every operation.
#include "studies/accuracy/fixed_runs.hpp"

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/arithmetic/fixed.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

namespace rlslab::studies {

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
