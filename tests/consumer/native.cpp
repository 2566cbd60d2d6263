// A guarded filter by its name, saved and gone on with, by the installed native layer.
#include <rlslab/catalogue/native/filter.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

int main() {
    namespace native = rlslab::native;
    auto const filter = native::make("qr", "float", {.size = 2, .forgetting = 0.99, .guard = "reset"});
    for (int i = 0; i < 100; ++i) {
        double const psi[] = {1, i / 10.0};
        filter->update(psi, 3 + 20 * psi[1]);
    }
    std::vector<std::byte> state(filter->state_size());
    filter->save(state);
    auto const other = filter->clone();
    other->reset();
    other->load(state);
    double theta[2];
    other->theta(theta);
    std::printf("%.3f + %.3f t\n", theta[0], theta[1]);
    return std::abs(theta[0] - 3) < 1e-2 && std::abs(theta[1] - 20) < 1e-2 ? 0 : 1;
}
