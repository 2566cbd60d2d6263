// A battery cell's resistances from its voltage and current, while it is driven; some samples are missing.
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <cmath>
#include <cstdio>
#include <limits>

namespace {

/// The cell that is measured: R0 in series with R1 parallel to C1, behind a voltage that falls with the charge drawn.
///   v = 3.70 V - 20 mV / Ah q - R0 i - w,   w' = (R1 i - w) / (R1 C1)
struct Cell {
    static constexpr double R0 = 2.0e-3, R1 = 1.2e-3, tau = 8.0;  // ohm, ohm, seconds
    double w = 0, q = 0;                                          // volt, ampere-hours
    double voltage(double i, double dt) {
        double const a = 1 - dt / tau;  // as a step of Euler has it
        double const v = 3.70 - 0.02 * q - R0 * i - w;
        w = a * w + (1 - a) * R1 * i;
        q += i * dt / 3600;
        return v;
    }
};

struct Parameters {
    double R0, R1, tau;
};

/// The cell as a difference equation, linear in five numbers:
///   v_k = a v_{k-1} + b0 i_k + b1 i_{k-1} + c + g q_k     with  a = 1 - dt / tau,  b0 = -R0,  g = -(1 - a) slope,
///                                                               b1 = a R0 - (1 - a) R1 - a slope dt / 3600
/// Voltages are taken from 3.7 V, currents in hundreds of amperes, charges in tenths of ampere-hours: float then has
/// digits to spare.
class CellObserver {
    rlslab::Ud<float, 5> filter_{{.size = 5, .forgetting = 0.9995f, .prior = rlslab::Prior<float>{.variance = 1e6f}}};
    float v_ = NAN, i_ = NAN, q_ = 0;
    float dt_;

public:
    explicit CellObserver(float dt) : dt_(dt) {}

    /// A sample, NaN where it is missing. A row is five numbers and an output, all of which must be there.
    void sample(float volts, float amperes) {
        float const v = volts - 3.7f;
        float const psi[] = {v_, amperes / 100, i_, 1, q_};
        bool complete = std::isfinite(v);
        for (float x : psi) complete = complete && std::isfinite(x);
        if (complete) filter_.update(psi, v);
        v_ = v;
        i_ = amperes / 100;
        if (std::isfinite(amperes)) q_ += amperes * dt_ / 360;
    }

    Parameters parameters() const {
        auto const theta = filter_.theta();
        double const a = theta[0], R0 = -theta[1] / 100, slope = -10 * theta[4] / (1 - a);  // volt per ampere-hour
        double const R1 = (a * R0 - theta[2] / 100 - a * slope * dt_ / 3600) / (1 - a);
        return {R0, R1, dt_ / (1 - a)};
    }
};

}  // namespace

int main() {
    constexpr double dt = 0.5;
    constexpr float missing = std::numeric_limits<float>::quiet_NaN();
    Cell cell;
    CellObserver observer(dt);
    rlslab::Seed seed{1};
    double i = 0;
    int lost = 0;
    for (int k = 0; k < 7200; ++k) {  // an hour
        if (k % 20 == 0) i = 20 * seed.bell() + 10;
        double const v = cell.voltage(i, dt) + 2e-5 * seed.bell();
        bool const gone = seed.uniform() < 0.1;
        lost += gone;
        observer.sample(gone ? missing : float(v), float(i));
    }
    auto const [R0, R1, tau] = observer.parameters();
    std::printf("%d of 7200 samples missing\n", lost);
    std::printf("R0  %.2f mOhm (2.00)\nR1  %.2f mOhm (1.20)\ntau %.1f s (8.0)\n", 1e3 * R0, 1e3 * R1, tau);
    return std::abs(R0 / Cell::R0 - 1) < 0.02 && std::abs(R1 / Cell::R1 - 1) < 0.02 &&
                   std::abs(tau / Cell::tau - 1) < 0.02
               ? 0
               : 1;
}
