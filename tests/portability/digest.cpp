// What rows leave of each dense variant, by the types of C++: one line each, with a hash. For other processors and
// compilers (tests/house/portability.cpp compiles it for them), languages (tests/doors) and Python (tests/python).
//
//   digest              1000 rows, float and double, 5 parameters: theta, K, and P or P^-1 by columns
//   digest save DIR     also saves the states after 500 rows: DIR/VARIANT.ARITHMETIC
//   digest load DIR     starts from those states
// and, where of_doors.cpp is linked:
//   digest composed DIR saves states of compositions after 100 rows; theta after 200
//   digest outputs      20 rows and 600 more at once of three outputs: theta by rows, and the state
//   digest complex      60 rows of eleven complex filters: theta, and the state
//   digest fleets       60 weighted rows of eleven filters of two outputs, likewise
// and again of both:
//   digest asked        100 rows of the weights (k mod 5) / 2, a removal, psi'P psi, draws, the least excited direction
//   digest all          300 rows, more arithmetics and sizes: every step and report, and the state; and what is asked
//
// Rows: s = (1664525 s + 1013904223) mod 2^32 from s = 1 on, and each number is floor(s / 2^8) / 2^23 - 1: five of psi,
// then y. Every language computes them exactly, and float holds them. Hash: of the bytes b of numbers as binary64, the
// lowest first, h = (m h + b) mod 4294967291 from 1 on, for m = 257 and for m = 65599: a language without integers of
// 64 bits has them in binary64. One NaN for all.
#include "tests/portability/digest.hpp"

#include <rlslab/adapt/diagnostics.hpp>
#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/core/rounding.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::digests {
namespace {

template <class F>
int after_1000_rows(std::string const& verb, std::string const& folder) {
    using T = typename F::scalar;
    F filter(Problem<T>{.size = d, .forgetting = T(0.9921875)});
    std::string const path = folder + "/" + std::string(F::name) + "." + std::string(ArithmeticTraits<T>::name);
    Numbers numbers;
    take(filter, 500, numbers);
    if (verb == "save") save_in(path, filter);
    if (verb == "load") {
        std::ifstream file(path, std::ios::binary);
        std::string const bytes{std::istreambuf_iterator<char>(file), {}};
        filter = F(Problem<T>{.size = d});
        if (load(filter, std::as_bytes(std::span(bytes))) != StateFault::none) {
            std::fprintf(stderr, "%s is no state\n", path.c_str());
            return 1;
        }
    }
    take(filter, 500, numbers);
    Hash hash;
    hash.add(Vector<T>(filter.theta()));
    hash.add(Vector<T>(filter.gain()));
    if constexpr (ReportsCovariance<F>) hash.add(Matrix<T>(filter.covariance()));
    else hash.add(Matrix<T>(filter.information()));
    hash.print(name_of_type<F>());
    return 0;
}
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

template <class T>
void asked_in() {
    for_each(Variants<T>{}, []<class F>() { asked<F>(); });
}

template <class F>
void everything(Index size) {
    using T = typename F::scalar;
    F filter(problem_as<T>({.size = size, .forgetting = 0.98}));
    Seed seed{std::uint64_t(size)};
    Hash out;
    for (int k = 0; k < 300; ++k) {
        Vector<T> psi(size);
        for (T& x : psi) x = round_to<T>(seed.bell());
        Step<T> const step = filter.update(psi, round_to<T>(seed.bell() + static_cast<double>(psi[0])));
        for (T const& x : {step.innovation, step.residual, step.gamma}) out.add(static_cast<double>(x));
    }
    auto const stored = filter.stored();
    out.add(Vector<T>(filter.theta()));
    out.add(Vector<T>(filter.gain()));
    out.add(stored.F);
    out.add(stored.D);
    for (std::byte const byte : state_of(filter)) out.add(byte);
    out.print(name_of_type<F>() + " " + std::to_string(size));
}
/// Three outputs: 20 rows, then blocks of 40 rows where F takes them.
template <class F>
void three_outputs() {
    using T = typename F::scalar;
    MultiOutput<F> filter(problem_as<T>({.size = 24, .forgetting = 0.98}), 3);
    Seed seed{3};
    auto const drawn = [&](Index rows, Index columns) {
        Matrix<T> out(rows, columns);
        for (T& x : out.reshaped()) x = round_to<T>(seed.bell());
        return out;
    };
    for (int k = 0; k < 20; ++k) {
        Vector<T> const psi = drawn(24, 1), y = drawn(3, 1);
        filter.update(psi, y);
    }
    if constexpr (requires { filter.update_block(drawn(24, 40), drawn(40, 3)); })
        for (int k = 0; k < 2; ++k) {
            Matrix<T> const X = drawn(24, 40), Y = drawn(40, 3);
            filter.update_block(X, Y);
        }
    Hash out;
    for (std::byte const byte : state_of(filter)) out.add(byte);
    out.print(name_of_type<F>() + " outputs");
}
template <class T>
void everything_in() {
    for_each(Variants<T>{}, []<class F>() {
        for (Index const size : {1, 3, 5, 10, 24}) everything<F>(size);
        if constexpr (requires { typename MultiOutput<F>; }) three_outputs<F>();
    });
}
void lanes() {
    using T = Pack<double, 4>;
    Ud<T> filter(Problem<T>{.size = 3});
    Seed seed{7};
    Vector<T> psi(3);
    for (int k = 0; k < 100; ++k) {
        for (T& x : psi)
            for (int lane = 0; lane < 4; ++lane) x.set(lane, seed.bell());
        filter.update(psi, psi[0]);
    }
    Hash out;
    for (T const& x : Vector<T>(filter.theta()))
        for (int lane = 0; lane < 4; ++lane) out.add(x[lane]);
    out.print("ud pack 3");
}

}  // namespace
}  // namespace rlslab::digests

int main(int count, char** arguments) {
    using namespace rlslab;
    using namespace rlslab::digests;
    std::string const verb = count > 1 ? arguments[1] : "", folder = count > 2 ? arguments[2] : "";
#ifdef RLSLAB_DIGESTS_OF_DOORS
    if (of_doors(verb, folder)) return 0;
#endif
    if (verb == "all") {
        for (std::string_view const fault : rounding_faults()) std::printf("%s\n", fault.data());
        everything_in<float>();
        everything_in<double>();
        everything_in<Chopped<bfloat16>>();
        asked_in<float>();
        asked_in<double>();
        lanes();
        output_fleet<Ud<Complex<Pack<float, 8>>>>(), output_fleet<Gentleman<Complex<Pack<double, 8>>>>();
        PrecisionScope const precision(12);
        everything<Ud<VariablePrecision>>(5);
    } else if (verb == "asked") {
        asked_in<float>();
        asked_in<double>();
    } else if (verb.empty() || verb == "save" || verb == "load") {
        int code = 0;
        for_each(Variants<float>{}, [&]<class F>() { code |= after_1000_rows<F>(verb, folder); });
        for_each(Variants<double>{}, [&]<class F>() { code |= after_1000_rows<F>(verb, folder); });
        return code;
    } else {
        std::fprintf(stderr, "%s: no verb of this program\n", verb.c_str());
        return 2;
    }
}
