// What rows leave of each dense variant, by the types of C++: one line each, with a hash. For other processors and
// compilers (tests/house/portability.cpp compiles it for them), languages (tests/doors) and Python (tests/python).
//
//   digest              1000 rows, float and double, 5 parameters: theta, K, and P or P^-1 by columns
//   digest save DIR     also saves the states after 500 rows: DIR/VARIANT.ARITHMETIC
//   digest load DIR     starts from those states
//   digest composed DIR saves states of compositions after 100 rows; theta after 200
//   digest outputs      20 rows and 600 more at once of three outputs: theta by rows, and the state
//   digest complex      60 rows of eleven complex filters: theta, and the state
//   digest fleets       60 weighted rows of eleven filters of two outputs, likewise
//   digest asked        100 rows of the weights (k mod 5) / 2, a removal, psi'P psi, draws, the least excited direction
//   digest all          300 rows, more arithmetics and sizes: every step and report, and the state; and what is asked
//
// Rows: s = (1664525 s + 1013904223) mod 2^32 from s = 1 on, and each number is floor(s / 2^8) / 2^23 - 1: five of psi,
// then y. Every language computes them exactly, and float holds them. Hash: of the bytes b of numbers as binary64, the
// lowest first, h = (m h + b) mod 4294967291 from 1 on, for m = 257 and for m = 65599: a language without integers of
// 64 bits has them in binary64. One NaN for all.
#include <rlslab/adapt/excitation.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/adapt/remove.hpp>
#include <rlslab/adapt/rules.hpp>
#include <rlslab/adapt/sample.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/core/rounding.hpp>
#include <rlslab/many/output_fleet.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <cstdio>
#include <fstream>
#include <string>

namespace rlslab {
namespace {

constexpr Index d = 5;

struct Numbers {
    std::uint32_t s = 1;
    double next() {
        s = 1664525 * s + 1013904223;
        return (s >> 8) / 8388608.0 - 1;
    }
};
struct Hash {
    std::uint64_t first = 1, second = 1;
    void add(std::byte byte) {
        first = (257 * first + std::uint64_t(byte)) % 4294967291;
        second = (65599 * second + std::uint64_t(byte)) % 4294967291;
    }
    void add(double x) {
        std::uint64_t const bits = detail::bits_of(x == x ? x : std::numeric_limits<double>::quiet_NaN());
        for (int i = 0; i < 8; ++i) add(std::byte(bits >> (8 * i) & 255));
    }
    template <class Derived>
    void add(Eigen::DenseBase<Derived> const& A) {
        for (Index j = 0; j < A.cols(); ++j)
            for (Index i = 0; i < A.rows(); ++i) add(static_cast<double>(A(i, j)));
    }
    void print(std::string const& what) const {
        std::printf("%s %08llx%08llx\n", what.c_str(), static_cast<unsigned long long>(first),
                    static_cast<unsigned long long>(second));
    }
};
template <class F>
std::string name_of_type() {
    return std::string(F::name) + " " + std::string(ArithmeticTraits<typename F::scalar>::name);
}

template <class F>
void take(F& filter, int rows, Numbers& numbers) {
    using T = typename F::scalar;
    for (int k = 0; k < rows; ++k) {
        Vector<T> psi(d);
        for (T& x : psi) x = T(numbers.next());
        filter.update(psi, T(numbers.next()));
    }
}
void save_in(std::string const& path, auto const& filter) {
    auto const state = state_of(filter);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<char const*>(state.data()), std::streamsize(state.size()));
}
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

/// Two outputs, where P is reported: else one. Real ones with weights.
template <class F>
void output_fleet() {
    using Fleet = OutputFleet<F>;
    using N = typename Fleet::number;
    using T = typename Fleet::real;
    Index const M = 11, m = ReportsCovariance<F> ? 2 : 1;
    Fleet fleet(M, {.size = d, .forgetting = T(0.9921875)}, m);
    Numbers numbers;
    std::vector<N> psi(size_t(M * d)), y(size_t(M * m));
    std::vector<T> w(static_cast<size_t>(M));
    auto const draw = [&](std::vector<N>& to) {
        for (N& x : to) {
            if constexpr (ComplexScalar<N>) x.re = T(numbers.next()), x.im = T(numbers.next());
            else x = T(numbers.next());
        }
    };
    for (int k = 0; k < 60; ++k) {
        draw(psi), draw(y);
        for (int i = 0; i < M; ++i) w[size_t(i)] = T((k + i) % 5) / 2;
        fleet.update(psi.data(), y.data(), ComplexScalar<N> ? nullptr : w.data(), nullptr);
    }
    Hash hash;
    for (Index i = 0; i < M; ++i) {
        Matrix<N> const theta = fleet.theta(i).transpose();
        for (N const& x : theta.reshaped()) {
            hash.add(double(real_part(x)));
            if constexpr (ComplexScalar<N>) hash.add(double(x.im));
        }
    }
    for (std::byte const byte : state_of(fleet)) hash.add(byte);
    hash.print(std::string(F::name) + (ComplexScalar<N> ? " complex " : " fleet ") +
               std::string(ArithmeticTraits<T>::name));
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
}  // namespace rlslab

int main(int count, char** arguments) {
    using namespace rlslab;
    std::string const verb = count > 1 ? arguments[1] : "", folder = count > 2 ? arguments[2] : "";
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
    } else if (verb == "composed") {
        Problem<float> const f{.size = d, .forgetting = 0.99f};
        Problem<double> const p{.size = d, .forgetting = 0.99};
        composed(Guarded<Windowed<Ud<float>>>(Windowed<Ud<float>>(f, {.rows = 30}), f), folder, "windowed");
        composed(
            Guarded<Forgetting<Carlson<double>, Kulhavy<double>>, rebuilding>(p, {.innovation = 4, .rebuild_rows = 7}),
            folder, "ruled");
        composed(Forgetting<Qr<double>, Fortescue<double>>(p, {.noise_variance = 1e-6}), folder, "fortescue");
    } else if (verb == "complex" || verb == "fleets") {
        auto const left_by = []<class F>() {
            if constexpr (InLockstep<F> && (ComplexScalar<typename F::scalar> || ReportsCovariance<F>))
                output_fleet<F>();
        };
        if (verb == "complex") {
            for_each(Variants<Complex<Pack<float, 8>>>{}, left_by);
            for_each(Variants<Complex<Pack<double, 8>>>{}, left_by);
        } else {
            for_each(Variants<Pack<float, 8>>{}, left_by);
            for_each(Variants<Pack<double, 8>>{}, left_by);
        }
    } else if (verb == "asked") {
        asked_in<float>();
        asked_in<double>();
    } else if (verb == "outputs") {
        auto const left_by = []<class F>() {
            if constexpr (requires { typename MultiOutput<F>; }) several_outputs<F>();
        };
        for_each(Variants<float>{}, left_by);
        for_each(Variants<double>{}, left_by);
    } else {
        int code = 0;
        for_each(Variants<float>{}, [&]<class F>() { code |= after_1000_rows<F>(verb, folder); });
        for_each(Variants<double>{}, [&]<class F>() { code |= after_1000_rows<F>(verb, folder); });
        return code;
    }
}
