// The cheap proof comes first; if it fails, definiteness is decided exactly.
#include <rlslab/catalogue/breakdown.hpp>

#include <rlslab/reference/definiteness.hpp>

namespace rlslab {

Health breakdown(AnyFilter const& filter, Arithmetic const& arithmetic, Health last) {
    double const widening = arithmetic.digits > 53 ? 0x1p-53 : 0;
    Health const stored =
        surely_positive(filter.stored_in_double(), widening) ? Health::sound : definiteness(filter.stored());
    return stored == Health::sound && last == Health::nonfinite && !is_finite(filter.theta()) ? last : stored;
}

bool is_finite(Vector<Reference> const& x) { return x.allFinite(); }

}  // namespace rlslab
