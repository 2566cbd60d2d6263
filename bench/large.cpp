// large/VARIANT/double/SIZE: one filter of many parameters, rows one by one; VARIANT_rows_known: in blocks; VARIANT_2_threads: in blocks,
// with a crew.
#include "bench/large.hpp"

#include <rlslab/linalg/crew.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::bench {
namespace {

template <class F>
void add() {
    add_large_rows<F>();
    std::string const name(F::name);
    add_large_rows<F>(name + "_rows_known", [](F& filter, auto const& psi, auto const& y) { filter.update_block(psi, y); });
    if constexpr (requires(F f, Matrix<double> psi, Vector<double> y, Crew crew) { f.update_block(psi, y, crew); })
        add_large_rows<F>(name + "_2_threads", [](F& filter, auto const& psi, auto const& y) {
            static Crew crew(2);
            filter.update_block(psi, y, crew);
        });
}

[[maybe_unused]] bool const added = [] {
    add<Conventional<double>>();
    add<Symmetric<double>>();
    add<Ud<double>>();
    add<Carlson<double>>();
    add<InverseQr<double>>();
    return true;
}();

}  // namespace
}  // namespace rlslab::bench
