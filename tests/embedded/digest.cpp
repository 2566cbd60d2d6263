// One line for each variant of fixed size: a digest of every bit that 100 rows leave. No heap, no exceptions, no
// streams. The same on a microcontroller as where it was compiled: tests/embedded compiles this for both and compares.
#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <bit>
#include <board.h>

namespace of_compare {
#include <of_compare.txt>  // what `rlslab compare --example sales --arithmetic float --code board` prints
}

using namespace rlslab;

namespace {

/// FNV-1a over the bits of doubles; one NaN for all.
struct Digest {
    std::uint64_t hash = 0xcbf29ce484222325;
    void add(double x) {
        std::uint64_t const bits = x == x ? std::bit_cast<std::uint64_t>(x) : 0x7ff8000000000000;
        for (int i = 0; i < 8; ++i) hash = (hash ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3;
    }
    void add(Complex<float> const& x) {
        add(double(x.re));
        add(double(x.im));
    }
    template <class M>
    void add_all(M const& A) {
        for (Index j = 0; j < A.cols(); ++j)
            for (Index i = 0; i < A.rows(); ++i) add(A(i, j));
    }
};

void print_hex(std::uint64_t x) {
    char text[17] = {};
    for (int i = 0; i < 16; ++i) text[i] = "0123456789abcdef"[x >> (60 - 4 * i) & 15];
    print(text);
}

void print_line(char const* what, std::uint64_t hash) {
    print(what);
    print_hex(hash);
    print("\n");
}

template <class T>
T number(Seed& seed, double scale) {
    if constexpr (ComplexScalar<T>) {
        float const re = float(seed.bell() * scale);
        return {re, float(seed.bell() * scale)};
    } else {
        return T(seed.bell() * scale);
    }
}

template <class F, int N>
[[gnu::noinline]] void digest(F& filter) {
    using T = typename F::scalar;
    Seed seed{std::uint64_t(N)};
    Digest out;
    T psi[N];
    for (int k = 0; k < 100; ++k) {
        // From rows of noise to rows of 2^40 or 2^-140: large, subnormal in float.
        double const scale = k % 17 == 11 ? 0x1p40 : k % 17 == 13 ? 0x1p-140 : 1;
        for (T& x : psi) x = number<T>(seed, scale);
        T const y = number<T>(seed, 1) + psi[0];
        Step<T> const step = filter.update({psi, N}, y);
        out.add(step.innovation);
        out.add(step.residual);
        out.add(step.gamma);
        out.add(int(step.health));
    }
    out.add_all(Vector<T, N>(filter.theta()));
    out.add_all(Vector<T, N>(filter.gain()));
    if constexpr (ReportsCovariance<F>) out.add_all(Matrix<T, N>(filter.covariance()));
    else out.add_all(Matrix<T, N>(filter.information()));
    print(F::name.data());
    print(ComplexScalar<T> ? " complex float " : sizeof(T) == 4 ? " float " : " double ");
    print(N < 10 ? "" : "1");
    char const digit[] = {char('0' + N % 10), ' ', 0};
    print_line(digit, out.hash);
}

template <class>
struct Sizes;
template <template <class, int> class V, class T>
struct Sizes<V<T, Dynamic>> {
    template <int N>
    static void run() {
        V<T, N> filter({.size = N, .forgetting = RealOf<T>(0.984375)});
        digest<V<T, N>, N>(filter);
    }
    static void all() {
        run<1>();
        run<3>();
        run<5>();
        run<10>();
    }
};

/// Rows from a delay line.
void digest_of_delayed() {
    DelayLine<float, 5> line;
    Ud<float, 5> filter({.size = 5});
    Seed seed{5};
    for (int k = 0; k < 50; ++k) filter.update(line.push(float(seed.bell())), line[3] + 0.125f * line[0]);
    Digest out;
    out.add_all(filter.covariance());
    print_line("ud delayed 5 ", out.hash);
}

/// Outliers, rows that are not finite and a change under a guard; half-way the state goes on in another filter.
void digest_of_guarded() {
    using F = Guarded<Ud<float, 5>>;
    Problem<float> const problem{.size = 5, .forgetting = 0.984375f, .prior = Prior<float>{.variance = 100}};
    F first(problem), second(problem);
    static std::byte memory[4096];
    Seed seed{5};
    float psi[5];
    for (int k = 0; k < 400; ++k) {
        for (float& x : psi) x = float(seed.bell());
        float y = (k < 300 ? psi[0] : psi[1]) + 0.125f * float(seed.bell());
        if (k % 50 == 20) y = 1e6f;
        if (k % 50 == 30) psi[2] = std::numeric_limits<float>::infinity();
        (k < 200 ? first : second).update(psi, y);
        if (k == 199 && load(second, std::span<std::byte const>(memory, save(first, memory))) != StateFault::none)
            return;
    }
    Digest out;
    out.add_all(second.filter().covariance());
    out.add_all(Vector<float, 5>(second.theta()));
    out.add(double(second.counts().outliers));
    out.add(double(second.counts().changes));
    print_line("ud guarded 5 ", out.hash);
}

void digest_of_compared() {
    constexpr int d = std::size(of_compare::scale);
    Seed seed{5};
    Digest out;
    float row[d];
    for (int k = 0; k < 100; ++k) {
        for (int i = 0; i < d; ++i) row[i] = float(seed.bell()) / of_compare::scale[i];
        out.add(of_compare::take(row, row[0] + float(seed.bell())).residual);
    }
    of_compare::theta(row);
    for (float const x : row) out.add(x);
    print_line("code of compare ", out.hash);
}

}  // namespace

int main() {
    digest_of_compared();
    digest_of_delayed();
    digest_of_guarded();
    for_each(Variants<float>{}, []<class F>() { Sizes<F>::all(); });
    for_each(Variants<double>{}, []<class F>() { Sizes<F>::all(); });
    for_each(Variants<Complex<float>>{}, []<class F>() { Sizes<F>::all(); });
}
