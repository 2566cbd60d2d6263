// What the doors are compared with besides: compositions, several outputs, fleets. By C++'s types, as in digest.cpp.
#include "tests/portability/digest.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/adapt/window.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/variants/variants.hpp>

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

template <class F>
void several_outputs() {
    using T = typename F::scalar;
    MultiOutput<F> filter(Problem<T>{.size = d, .forgetting = T(0.9921875)}, 3);
    Numbers numbers;
    Matrix<T> X(d, 620), Y(3, 620);
    for (Index k = 0; k < X.cols(); ++k) {
        for (Index i = 0; i < d; ++i) X(i, k) = T(numbers.next());
        for (Index j = 0; j < 3; ++j) Y(j, k) = T(numbers.next());
    }
    auto const row = [&](Index k) { filter.update(X.col(k), Y.col(k)); };
    for (Index k = 0; k < 20; ++k) row(k);
    Index at_once = 64;
    if constexpr (TakesBlocks<F>) at_once = F::block;
    for (Index k = 20; k < 620; k += at_once) {
        Index const count = std::min(at_once, 620 - k);
        if constexpr (requires { filter.update_block(X, Y); })
            filter.update_block(X.middleCols(k, count), Y.middleCols(k, count).transpose());
        else
            for (Index i = k; i < k + count; ++i) row(i);
    }
    Hash hash;
    hash.add(filter.theta().transpose());
    for (std::byte const byte : state_of(filter)) hash.add(byte);
    hash.print(name_of_type<F>());
}

template <class... C>
void fleets() {
    auto const left_by = []<class F>() {
        if constexpr (InLockstep<F> && (ComplexScalar<typename F::scalar> || ReportsCovariance<F>)) output_fleet<F>();
    };
    (for_each(Variants<C>{}, left_by), ...);
}

}  // namespace

bool of_doors(std::string const& verb, std::string const& folder) {
    if (verb == "composed") {
        Problem<float> const f{.size = d, .forgetting = 0.99f};
        Problem<double> const p{.size = d, .forgetting = 0.99};
        composed(Guarded<Windowed<Ud<float>>>(Windowed<Ud<float>>(f, {.rows = 30}), f), folder, "windowed");
        composed(
            Guarded<Forgetting<Carlson<double>, Kulhavy<double>>, rebuilding>(p, {.innovation = 4, .rebuild_rows = 7}),
            folder, "ruled");
        composed(Forgetting<Qr<double>, Fortescue<double>>(p, {.noise_variance = 1e-6}), folder, "fortescue");
    } else if (verb == "complex") {
        fleets<Complex<Pack<float, 8>>, Complex<Pack<double, 8>>>();
    } else if (verb == "fleets") {
        fleets<Pack<float, 8>, Pack<double, 8>>();
    } else if (verb == "outputs") {
        auto const left_by = []<class F>() {
            if constexpr (requires { typename MultiOutput<F>; }) several_outputs<F>();
        };
        for_each(Variants<float>{}, left_by);
        for_each(Variants<double>{}, left_by);
    } else {
        return false;
    }
    return true;
}

}  // namespace rlslab::digests
