// Ticks of 1000 rows of noise through unit_row, of -DUNIT: exported, by hand or empty (exported_cost.sh).
#include <board.h>

#include <cstdint>

extern "C" {
void unit_begin(void);
void unit_row(float const* psi, float y);
}

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
    unit_begin();
    std::uint32_t drawn = 1;
    auto const draw = [&drawn] { return float(std::int32_t(drawn = 1664525 * drawn + 1013904223)) * 0x1p-31f; };
    unsigned long begin = 0;
    for (int k = 0; k < 1100; ++k) {
        if (k == 100) begin = ticks();
        float psi[4];
        for (float& x : psi) x = draw();
        unit_row(psi, draw());
    }
    print_number(ticks() - begin);
}
