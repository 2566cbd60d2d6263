// Autotune of a flight controller: an ARX model of 5 parameters from a body rate and its command, in float as on the
// board, by the textbook update and by UD; judged beside UD in double.
#include <rlslab/core/random.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/ud.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using rlslab::Index;
constexpr int d = 5;  // -y(k-1), -y(k-2), u(k-2), u(k-3), u(k-4)

/// Two poles and two zeros, from a prototype of cut-off frequency f by the bilinear map.
struct Biquad {
    double b0, b1, b2, a1, a2, x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    static Biquad low_pass(double f, double rate, double damping) {
        double const w = std::tan(std::numbers::pi * f / rate), n = 1 / (1 + 2 * damping * w + w * w);
        return {w * w * n, 2 * w * w * n, w * w * n, 2 * (w * w - 1) * n, (1 - 2 * damping * w + w * w) * n};
    }
    double operator()(double x) {
        double const y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
        x2 = x1, x1 = x, y2 = y1, y1 = y;
        return y;
    }
};
struct HighPass {
    double c, x1 = 0, y1 = 0;
    double operator()(double x) {
        y1 = c * (y1 + x - x1), x1 = x;
        return y1;
    }
};

/// What the filters take: command and rate of a roll axis (3 Hz, damping 0.4), each through the estimator's own low
/// pass at 30 Hz and high pass at 0.05 Hz; the command is a sine that sweeps from 0.5 to 15 Hz, the gyro has noise.
struct Flight {
    double rate, t = 0, phase = 0;
    Biquad axis = Biquad::low_pass(3, rate, 0.4), low_u = Biquad::low_pass(30, rate, 0.7), low_y = low_u;
    HighPass high_u{1 / (1 + 2 * std::numbers::pi * 0.05 / rate)}, high_y = high_u;
    rlslab::Seed noise;
    double u[4] = {}, y[2] = {};

    /// The next row and its output, rounded to float as the board has them.
    float row(float (&psi)[d]) {
        double const f = 0.5 * std::pow(30.0, std::fmod(t / 10, 1.0));
        phase += 2 * std::numbers::pi * f / rate, t += 1 / rate;
        double const command = std::sin(phase), seen = axis(command) + 1e-3 * noise.bell();
        for (int i = 3; i > 0; --i) u[i] = u[i - 1];
        u[0] = high_u(low_u(command));
        double const now = high_y(low_y(seen));
        psi[0] = float(-y[0]), psi[1] = float(-y[1]);
        for (int i = 0; i < 3; ++i) psi[2 + i] = float(u[i + 1]);
        y[1] = y[0], y[0] = now;
        return float(now);
    }
};

using Numbers = Eigen::Matrix<double, d, 1>;
using Square = Eigen::Matrix<double, d, d>;
struct Result {
    double theta, P;  // relative errors
    bool indefinite;  // P had an eigenvalue that is not positive
};
double median(std::vector<Result> results, double Result::*of) {
    std::ranges::sort(results, {}, of);
    return results[results.size() / 2].*of;
}
template <class F>
struct Followed {
    F filter;
    bool indefinite = false;
    Followed(double lambda)
        : filter({.forgetting = typename F::scalar(lambda),
                  .prior = rlslab::Prior<typename F::scalar>{.variance = 1e4}}) {}
    void take(float const (&psi)[d], float y) {
        typename F::scalar numbers[d];
        for (int i = 0; i < d; ++i) numbers[i] = psi[i];
        filter.update({numbers, d}, y);
        if (!indefinite)
            indefinite = !(Eigen::SelfAdjointEigenSolver<Square>(P(), Eigen::EigenvaluesOnly).eigenvalues()[0] > 0);
    }
    /// Of the numbers that the filter stores, formed in double.
    Square P() const {
        auto const stored = filter.stored();
        Square const A = stored.F.template cast<double>();
        if (stored.D.size() > 0) return A * stored.D.template cast<double>().asDiagonal() * A.transpose();
        return (A + A.transpose()) / 2;
    }
    Numbers theta() const { return filter.theta().template cast<double>(); }
};
Result beside(auto const& filter, auto const& reference) {
    return {(filter.theta() - reference.theta()).norm() / reference.theta().norm(),
            (filter.P() - reference.P()).norm() / reference.P().norm(), filter.indefinite};
}

}  // namespace

int main() {
    constexpr int flights = 20;
    bool right = true;
    std::printf("Hz   rows  form          theta    P        indefinite\n");
    for (auto const& [rate, rows] : {std::pair{200, 400}, std::pair{800, 8000}}) {
        double const lambda = float(1 - 1 / (60.0 * rate));  // a memory of a minute
        std::vector<Result> of_textbook, of_ud;
        for (int n = 1; n <= flights; ++n) {
            Followed<rlslab::Conventional<float, d>> textbook(lambda);
            Followed<rlslab::Ud<float, d>> ud(lambda);
            Followed<rlslab::Ud<double, d>> reference(lambda);
            Flight flight{.rate = double(rate), .noise = {std::uint64_t(n)}};
            for (int k = 0; k < rows; ++k) {
                float psi[d];
                float const y = flight.row(psi);
                textbook.take(psi, y), ud.take(psi, y), reference.take(psi, y);
            }
            of_textbook.push_back(beside(textbook, reference));
            of_ud.push_back(beside(ud, reference));
        }
        for (auto const& [name, results] : {std::pair{"conventional", &of_textbook}, std::pair{"ud", &of_ud}}) {
            int lost = 0;
            for (Result const& r : *results) lost += r.indefinite;
            std::printf("%-4d %-5d %-12s  %.0e    %.0e    %d of %d\n", rate, rows, name,
                        median(*results, &Result::theta), median(*results, &Result::P), lost, flights);
            right = right && (name[0] == 'c' ? rate < 800 || lost == flights : lost == 0);
        }
    }
    return right ? 0 : 1;
}
