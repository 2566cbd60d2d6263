// The cheap proof comes first; if it fails, definiteness is decided exactly.
#include <rlslab/catalogue/breakdown.hpp>

#include <rlslab/reference/definiteness.hpp>

#include <algorithm>

namespace rlslab {

std::string breakdown(AnyFilter const& filter, Arithmetic const& arithmetic) {
    double const widening = arithmetic.digits > 53 ? 0x1p-53 : 0;
    if (surely_positive(filter.stored_in_double(), widening)) return "";
    switch (definiteness(filter.stored())) {
        case Definiteness::positive: return "";
        case Definiteness::not_positive: return "indefinite";
        default: return "nonfinite";
    }
}

bool is_finite(Vector<Reference> const& x) {
    return std::all_of(x.begin(), x.end(), [](Reference const& v) { return is_finite(v); });
}

}  // namespace rlslab
