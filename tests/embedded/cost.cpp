// What one update costs: -DFILTER='Ud<float, 5>' -DSIZE=5 prints the ticks of 1000 updates; -DFILTER left out, of the
// loop around them. tests/embedded/cost.sh makes docs/embedded.md's table of it.
#include <rlslab/variants/variants.hpp>

#include <board.hpp>

namespace {

void print_number(unsigned long n) {
    char text[12] = {};
    int at = 11;
    do text[--at] = char('0' + n % 10);
    while (n /= 10);
    print(text + at);
    print("\n");
}

}  // namespace

int main() {
    using namespace rlslab;
#ifdef FILTER
    using F = FILTER;
    using T = F::scalar;
    F filter({.size = SIZE, .forgetting = T(0.984375)});
#else
    using T = float;
    constexpr int SIZE = 5;
#endif
    T psi[SIZE] = {};
    unsigned long begin = 0;
    for (int k = 0; k < 1100; ++k) {
        if (k == 100) begin = ticks();
        psi[k % SIZE] += T(0.25);
#ifdef FILTER
        filter.update({psi, SIZE}, T(3));
#else
        asm volatile("" : : "r"(psi) : "memory");
#endif
    }
    print_number(ticks() - begin);
}
