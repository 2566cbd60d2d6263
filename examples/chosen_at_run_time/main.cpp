// The variant is an argument of the program: chosen_at_run_time [VARIANT...]
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <cstdio>
#include <memory>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace {

using rlslab::Vector;

/// Any filter, behind the operations that this program needs.
struct AnyFilter {
    std::function<rlslab::Step<double>(rlslab::Regressor<double>, double)> update;
    std::function<Vector<double>()> theta;
};

/// The variant of that name; nothing where there is none.
std::optional<AnyFilter> make(std::string_view name, rlslab::Problem<double> const& problem) {
    std::optional<AnyFilter> out;
    rlslab::for_each(rlslab::Variants<double>{}, [&]<class Filter>() {
        if (Filter::name != name) return;
        auto const filter = std::make_shared<Filter>(problem);
        out = AnyFilter{[filter](rlslab::Regressor<double> psi, double y) { return filter->update(psi, y); },
                        [filter] { return Vector<double>(filter->theta()); }};
    });
    return out;
}

}  // namespace

int main(int count, char** arguments) {
    std::vector<std::string_view> names(arguments + 1, arguments + count);
    if (names.empty()) names = {"ud", "qr", "conventional"};
    for (std::string_view const name : names) {
        auto const filter = make(name, {.size = 3, .forgetting = 0.999});
        if (!filter) {
            std::fprintf(stderr, "no variant '%.*s'; there are:", int(name.size()), name.data());
            rlslab::for_each(rlslab::Variants<double>{},
                             []<class Filter>() { std::fprintf(stderr, " %s", Filter::name.data()); });
            std::fprintf(stderr, "\n");
            return 2;
        }
        rlslab::Seed seed{1};
        for (int k = 0; k < 1000; ++k) {  // y = 1 - 2 x + 3 z, and noise
            double const x = seed.bell(), z = seed.bell();
            if (filter->update({1.0, x, z}, 1 - 2 * x + 3 * z + 0.1 * seed.bell()).health != rlslab::Health::sound)
                return 1;
        }
        Vector<double> const theta = filter->theta();
        std::printf("%-14.*s %.3f %.3f %.3f\n", int(name.size()), name.data(), theta[0], theta[1], theta[2]);
    }
}
