// Rolling regressions over rows of double and of float.
#include <rlslab/catalogue/native/rolling.hpp>

#include <rlslab/many/rolling.hpp>

namespace rlslab::native {

void rolling(RollingRows<double> const& rows, RollingOptions const& options, Rolled const& out) {
    rlslab::rolling(rows, options, out);
}
void rolling(RollingRows<float> const& rows, RollingOptions const& options, Rolled const& out) {
    rlslab::rolling(rows, options, out);
}
std::ptrdiff_t threads() { return detail::threads_of_team(); }

}  // namespace rlslab::native
