// Guarded filters by name.
#include "studies/adapt/watched.hpp"

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/core/random.hpp>

#include <cmath>
#include <fmt/format.h>

namespace rlslab::studies {

std::vector<std::string> const& guard_policies_by_name() {
    static std::vector<std::string> const names{"none", "report", "reset", "rebuild"};
    return names;
}
std::vector<std::string> const& guarded_variants() {
    static std::vector<std::string> const names{"conventional", "symmetric",  "potter", "carlson",
                                                "ud",           "inverse_qr", "qr",     "gentleman"};
    return names;
}

std::unique_ptr<Watched> watched(std::string_view variant, std::string_view arithmetic, std::string_view policy,
                                 Problem<double> const& problem, double innovation) {
    if (arithmetic != "float" && arithmetic != "double")
        throw InputError(fmt::format("guarded filters exist here in float and double, not in {}", arithmetic));
    auto const make = arithmetic == "float" ? watched_in_float(variant, policy) : watched_in_double(variant, policy);
    return make ? make(problem, innovation) : nullptr;
}

double operations_of_a_row(std::string_view variant, std::string_view policy, Index size) {
    auto const make = watched_counting(variant, policy);
    if (!make) return NAN;
    auto const filter = make({.size = size, .forgetting = 0.98, .prior = Prior<double>{.variance = 100}}, 6);
    Seed seed{1};
    std::vector<double> psi(size_t(size), 0.0);
    auto const process_rows = [&](Index rows) {
        for (Index k = 0; k < rows; ++k) {
            double y = 0.1 * seed.bell();
            for (double& x : psi) y += x = seed.bell();
            filter->update(psi.data(), y);
        }
    };
    process_rows(20 * size + 200);  // armed after 10 d + 20
    return double(rlslab::counted([&] { process_rows(20 * size); }).total()) / double(20 * size);
}

}  // namespace rlslab::studies
