// A motor's model on a microcontroller: no heap, no exceptions, no streams. The same source runs on the host.
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <board.hpp>

/// What the library calls on misuse where there are no exceptions: here as everywhere, a mistake of the program.
void rlslab::on_misuse(char const* expected) {
    print("misuse: expected ");
    print(expected);
    print("\n");
    stop(3);
}

namespace {

void print_number(char const* name, float x) {  // three decimals; printf would be larger than the filter
    print(name);
    long thousandths = long(x * 1000 + (x < 0 ? -0.5f : 0.5f));
    char text[16] = {};
    int at = 15;
    bool const negative = thousandths < 0;
    if (negative) thousandths = -thousandths;
    for (int digits = 0; digits < 4 || thousandths > 0; ++digits, thousandths /= 10) {
        if (digits == 3) text[--at] = '.';
        text[--at] = char('0' + thousandths % 10);
    }
    if (negative) text[--at] = '-';
    print(text + at);
    print("\n");
}

/// The motor: speed_k = a speed_{k-1} + b voltage_{k-1} - c, where c is friction.
constexpr float a = 0.95f, b = 0.4f, c = 0.2f;
rlslab::Ud<float, 3> filter({.size = 3, .forgetting = 0.999f});  // in static memory: nothing else to allocate

}  // namespace

int main() {
    rlslab::Seed seed{1};
    float speed = 0, voltage = 0;
    for (int k = 0; k < 1000; ++k) {
        float const next = a * speed + b * voltage - c + 0.01f * float(seed.bell());
        rlslab::Step<float> const step = filter.update({speed, voltage, -1.0f}, next);
        if (step.health != rlslab::Health::sound) return 1;
        speed = next;
        if (k % 10 == 0) voltage = 12 * float(seed.uniform());
    }
    auto const theta = filter.theta();
    print_number("a ", theta[0]);
    print_number("b ", theta[1]);
    print_number("c ", theta[2]);
    return 0.94f < theta[0] && theta[0] < 0.96f && 0.39f < theta[1] && theta[1] < 0.41f && 0.15f < theta[2] &&
                   theta[2] < 0.25f
               ? 0
               : 1;
}
