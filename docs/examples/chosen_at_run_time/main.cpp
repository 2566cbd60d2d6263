// The variant is an argument of the program: chosen_at_run_time [VARIANT...]
#include <rlslab/catalogue/native/filter.hpp>
#include <rlslab/core/random.hpp>

#include <cstdio>
#include <exception>
#include <vector>

namespace native = rlslab::native;

int main(int count, char** arguments) try {
    std::vector<std::string_view> names(arguments + 1, arguments + count);
    if (names.empty()) names = {"ud", "qr", "conventional"};
    for (std::string_view const name : names) {
        native::Options const options{.size = 3, .forgetting = 0.999, .guard = "reset"};
        auto filter = native::make(name, "double", options);
        rlslab::Seed seed{1};
        for (int k = 0; k < 1000; ++k) {  // y = 1 - 2 x + 3 z, and noise; a faulty reading now and then
            double const x = seed.bell(), z = seed.bell(), psi[] = {1, x, z};
            double const y = 1 - 2 * x + 3 * z + 0.1 * seed.bell() + (k % 100 == 99 ? 50 : 0);
            if (!filter->update(psi, y).sound()) return 1;
            if (k == 500) {  // the program ends, and starts again
                std::vector<std::byte> state(filter->state_size());
                filter->save(state);
                filter = native::make(name, "double", options);
                filter->load(state);
            }
        }
        double theta[3];
        filter->theta(theta);
        std::printf("%-14.*s %.3f %.3f %.3f  outliers: %d\n", int(name.size()), name.data(), theta[0], theta[1],
                    theta[2], int(filter->counts().outliers));
    }
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
