// One line for each variant, arithmetic and size: a digest of every bit that 300 rows leave. The same on every
// processor, with every compiler: tests/house/portability.cpp compiles this for others and compares.
#include <rlslab/state/state.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/rounding.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/variants/variants.hpp>

#include <cinttypes>
#include <cstdio>

namespace rlslab {
namespace {

/// FNV-1a over the bits of doubles, by value: the order of bytes in memory has no part in it; one NaN for all.
struct Digest {
    std::uint64_t hash = 0xcbf29ce484222325;
    void add(std::byte x) { hash = (hash ^ std::uint64_t(x)) * 0x100000001b3; }
    void add(double x) {
        std::uint64_t const bits = detail::bits_of(x == x ? x : std::numeric_limits<double>::quiet_NaN());
        for (int i = 0; i < 8; ++i) hash = (hash ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3;
    }
    template <class Derived>
    void add(Eigen::DenseBase<Derived> const& A) {
        for (Index j = 0; j < A.cols(); ++j)
            for (Index i = 0; i < A.rows(); ++i) add(static_cast<double>(A(i, j)));
    }
};

template <class F>
void digest(Index d) {
    using T = typename F::scalar;
    F filter(problem_as<T>({.size = d, .forgetting = 0.98}));
    Seed seed{std::uint64_t(d)};
    Digest out;
    for (int k = 0; k < 300; ++k) {
        Vector<T> psi(d);
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
    std::printf("%s %s %d %016" PRIx64 "\n", F::name.data(), ArithmeticTraits<T>::name.data(), int(d), out.hash);
}
template <class T>
void digests() {
    for_each(Variants<T>{}, []<class F>() {
        for (Index const d : {1, 3, 5, 10, 24}) digest<F>(d);
    });
}

void digest_of_lanes() {
    using T = Pack<double, 4>;
    Ud<T> filter(Problem<T>{.size = 3});
    Seed seed{7};
    Vector<T> psi(3);
    for (int k = 0; k < 100; ++k) {
        for (T& x : psi)
            for (int lane = 0; lane < 4; ++lane) x.set(lane, seed.bell());
        filter.update(psi, psi[0]);
    }
    Digest out;
    for (T const& x : Vector<T>(filter.theta()))
        for (int lane = 0; lane < 4; ++lane) out.add(x[lane]);
    std::printf("ud pack 3 %016" PRIx64 "\n", out.hash);
}

}  // namespace
}  // namespace rlslab

int main() {
    for (std::string_view const fault : rlslab::rounding_faults()) std::printf("%s\n", fault.data());
    rlslab::digests<float>();
    rlslab::digests<double>();
    rlslab::digests<rlslab::Chopped<rlslab::bfloat16>>();
    rlslab::digest_of_lanes();
    rlslab::PrecisionScope const precision(12);
    rlslab::digest<rlslab::Ud<rlslab::VariablePrecision>>(5);
}
