// large/VARIANT/double/SIZE: one filter of many parameters, rows one by one; VARIANT_rows_known: in blocks.
#include "bench/large.hpp"

#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <class F>
void add() {
    add_large_rows<F>();
    add_large_rows<F>(std::string(F::name) + "_rows_known",
                      [](F& filter, auto const& psi, auto const& y) { rows_at_once(filter, psi, y); });
}

Rows const added([] {
    add<Conventional<double>>();
    add<Ud<double>>();
    add<UdDelta<double>>();
    add<Carlson<double>>();
    add<InverseQr<double>>();
    add_large_rows<Symmetric<double>>();
    add_large_rows<CarlsonDelta<double>>();
    add_large_rows<InverseQrDelta<double>>();
    add_large_rows<Potter<double>>();
    add_large_rows<Qr<double>>();
    add_large_rows<Gentleman<double>>();
});

}  // namespace
}  // namespace rlslab::bench
