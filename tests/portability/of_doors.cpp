// What doors are compared with besides: compositions, and fleets of real numbers. By C++'s types, as in digest.cpp.
#include "tests/portability/digest.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/pack.hpp>

namespace rlslab::digests {
namespace {

template <class F>
void composed(F filter, std::string const& folder, std::string const& name) {
    Numbers numbers;
    take(filter, 100, numbers);
    save_in(folder + "/" + name, filter);
    take(filter, 100, numbers);
    Hash hash;
    hash.add(Vector<typename F::scalar>(filter.theta()));
    hash.print(name);
}

int compositions(std::string const& folder) {
    Problem<float> const f{.size = d, .forgetting = 0.99f};
    Problem<double> const p{.size = d, .forgetting = 0.99};
    composed(Guarded<Windowed<Ud<float>>>(Windowed<Ud<float>>(f, {.rows = 30}), f), folder, "windowed");
    composed(Guarded<Forgetting<Carlson<double>, Kulhavy<double>>, rebuilding>(p, {.innovation = 4, .rebuild_rows = 7}),
             folder, "ruled");
    composed(Forgetting<Qr<double>, Fortescue<double>>(p, {.noise_variance = 1e-6}), folder, "fortescue");
    return 0;
}
[[maybe_unused]] bool const added =
    (verbs.insert({{"composed", compositions}, {"fleets", output_fleets<Pack<float, 8>, Pack<double, 8>>}}), true);

}  // namespace
}  // namespace rlslab::digests
