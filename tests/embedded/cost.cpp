// What one update costs: -DFILTER='Ud<float, 5>' -DPARAMETERS=5 prints the ticks of 1000 updates by rows of noise,
// whose Step and state are read, and the filter's bytes. Nothing<float, 5> is the loop around them. With -DCOUNTED, on
// the host, a tick is an operation. tests/embedded/cost.sh makes docs/embedded.md's table of it.
#include <rlslab/adapt/assessed.hpp>
#include <rlslab/adapt/certified.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/variants/variants.hpp>

#include <board.h>
#ifdef COUNTED
#include <rlslab/arithmetic/counted.hpp>

#include <cstdio>

void print(char const* text) { std::fputs(text, stdout); }
unsigned long ticks() { return rlslab::detail::operations_so_far.total(); }
#endif

using namespace rlslab;

namespace {

void print_number(unsigned long n) {
    char text[12] = {};
    int at = 11;
    do text[--at] = char('0' + n % 10);
    while (n /= 10);
    print(text + at);
    print("\n");
}

template <class T, int>
struct Nothing {
    using scalar = T;
    struct Problem {
        int size;
        T forgetting;
    };
    explicit Nothing(Problem const&) {}
    int update(Regressor<T>, T) { return 0; }
};

/// The textbook's form in the lines that are written by hand: all of P is stored, and nothing is reported.
template <class T, int N>
class ByHand {
    struct Problem {
        int size;
        T forgetting;
    };
    T lambda_, theta_[N] = {}, P_[N][N] = {};

public:
    using scalar = T;
    explicit ByHand(Problem const& problem) : lambda_(problem.forgetting) {
        for (int i = 0; i < N; ++i) P_[i][i] = T(1024);
    }
    T update(Regressor<T> psi, T y) {
        T g[N], s = lambda_, e = y;
        for (int i = 0; i < N; ++i) {
            g[i] = T(0);
            for (int j = 0; j < N; ++j) g[i] += P_[i][j] * psi[j];
            s += psi[i] * g[i];
            e -= psi[i] * theta_[i];
        }
        for (int i = 0; i < N; ++i) {
            T const k = g[i] / s;
            theta_[i] += k * e;
            for (int j = 0; j < N; ++j) P_[i][j] = (P_[i][j] - k * g[j]) / lambda_;
        }
        return e;
    }
};

}  // namespace

int main() {
    using F = FILTER;
    using T = F::scalar;
    F filter({.size = PARAMETERS, .forgetting = T(0.984375)});
    std::uint32_t drawn = 1;
    auto const draw = [&drawn] { return float(std::int32_t(drawn = 1664525 * drawn + 1013904223)) * 0x1p-31f; };
    unsigned long begin = 0;
    for (int k = 0; k < 1100; ++k) {
        if (k == 100) begin = ticks();
        T psi[PARAMETERS];
        for (T& x : psi) x = T(draw());
        T const y(draw());
        asm volatile("" : : "r"(psi), "r"(&y) : "memory");  // as if they came from elsewhere
        auto const step = filter.update({psi, PARAMETERS}, y);
        asm volatile("" : : "r"(&step), "r"(&filter) : "memory");  // as if a program read both
    }
    print_number(ticks() - begin);
    print_number(sizeof filter);
}
