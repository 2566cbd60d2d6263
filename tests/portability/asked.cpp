// What is asked of a filter besides its rows, and words that no processor has: digest.cpp.
#include "tests/portability/digest.hpp"

#include <rlslab/adapt/diagnostics.hpp>
#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>

namespace rlslab::digests {
namespace {

/// What a filter does not answer is not in the hash.
template <class F>
void asked() {
    using T = typename F::scalar;
    Weighted<F> weighted(Problem<T>{.size = d, .forgetting = T(0.9921875)});
    Numbers numbers;
    Vector<T> psi(d);
    T y(0);
    for (int k = 0; k < 100; ++k) {
        for (T& x : psi) x = T(numbers.next());
        y = T(numbers.next());
        weighted.update(psi, y, T(k % 5) / T(2));
    }
    Hash hash;
    hash.add(Vector<T>(weighted.theta()));
    hash.add(Vector<T>(weighted.gain()));
    F filter = weighted.filter();
    if constexpr (ReportsVariances<F>) hash.add(double(variance_along(filter, Regressor<T>(psi))));
    if (filter.stored().form == Stored<T>::Form::factor) {
        Matrix<T> draws(d, 3);
        Vector<T> u(d);
        sample(filter, 1, 3, T(0.5), draws.data());
        auto const found = least_excited(filter, u.data());
        hash.add(draws);
        hash.add(u);
        hash.add(double(found.deviation));
        hash.add(double(found.ratio));
    }
    if constexpr (Downdates<F>) {
        auto const removal = remove(filter, Regressor<T>(psi), y, T(2));
        hash.add(double(removal.remaining));
        hash.add(double(removal.noise));
    }
    hash.add(Vector<T>(filter.theta()));
    hash.print(name_of_type<F>());
}

int of_short_words(std::string const&) {
    everything_in<Chopped<bfloat16>>();
    output_fleet<Ud<Complex<Pack<float, 8>>>>(), output_fleet<Gentleman<Complex<Pack<double, 8>>>>();
    PrecisionScope const precision(12);
    everything<Ud<VariablePrecision>>(5);
    return 0;
}
int asked_of_all(std::string const&) {
    for_each(Variants<float>{}, []<class F>() { asked<F>(); });
    for_each(Variants<double>{}, []<class F>() { asked<F>(); });
    return 0;
}
[[maybe_unused]] bool const added = (verbs.insert({{"short", of_short_words}, {"asked", asked_of_all}}), true);

}  // namespace
}  // namespace rlslab::digests
