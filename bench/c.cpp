// What rlslab.h adds to a row: rlslab_update of librlslab.so beside the same variant by its type, in turns.
//   rlslab_bench_c [ROUNDS [ROWS]]   nanoseconds a row, the least over the rounds (20000 by default), each of so many
//                                    rows (64); and the median over the rounds of the difference of the two neighbours
//                                    in time
#include "bindings/c/rlslab.h"

#include <rlslab/core/random.hpp>
#include <rlslab/variants/variants.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace rlslab::bench {
namespace {

double now() {
    using namespace std::chrono;
    return double(duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count());
}
rlslab_status update_c(rlslab_filter* filter, double const* psi, double y, rlslab_step* step) {
    return rlslab_update(filter, psi, y, step);
}
rlslab_status update_c(rlslab_filter* filter, float const* psi, float y, rlslab_step* step) {
    return rlslab_update_f32(filter, psi, y, step);
}

template <class F>
void compare(int rounds, Index rows, Index d) {
    using T = typename F::scalar;
    std::string const variant(F::name), arithmetic(ArithmeticTraits<T>::name);
    rlslab_options options;
    rlslab_defaults(&options, sizeof options);
    options.size = std::size_t(d);
    rlslab_filter* c = nullptr;
    if (rlslab_new(variant.c_str(), arithmetic.c_str(), &options, &c) != RLSLAB_OK) std::abort();
    F filter(Problem<T>{.size = d});

    Seed seed{1};
    std::vector<T> psi(std::size_t(rows * d)), y(psi.size() / std::size_t(d));
    for (T& x : psi) x = T(seed.bell());
    for (T& x : y) x = T(seed.bell());
    double least_cpp = std::numeric_limits<double>::infinity(), least_c = least_cpp;
    std::vector<double> differences;
    rlslab_step step{};
    double innovations = 0;
    for (int round = 0; round < rounds; ++round) {
        double const start = now();
        for (Index k = 0; k < rows; ++k) {
            Step<T> const one = filter.update(Regressor<T>(&psi[std::size_t(k * d)], d), y[std::size_t(k)]);
            asm volatile("" : : "g"(&one) : "memory");  // all of it is used
            innovations += double(one.innovation);
        }
        double const half = now();
        for (Index k = 0; k < rows; ++k) {
            if (update_c(c, &psi[std::size_t(k * d)], y[std::size_t(k)], &step) != RLSLAB_OK) std::abort();
            innovations -= step.innovation;
        }
        double const end = now();
        least_cpp = std::min(least_cpp, (half - start) / double(rows));
        least_c = std::min(least_c, (end - half) / double(rows));
        differences.push_back((end - half - (half - start)) / double(rows));
    }
    std::ranges::nth_element(differences, differences.begin() + rounds / 2);
    std::printf("| `%s` | %s | %d | %.1f | %.1f | %.1f | %.1f |%s\n", variant.c_str(), arithmetic.c_str(), int(d),
                least_cpp, least_c, least_c - least_cpp, differences[std::size_t(rounds / 2)],
                std::abs(innovations) < 1e-3 ? "" : " other numbers");
    rlslab_free(c);
}

}  // namespace
}  // namespace rlslab::bench

int main(int count, char** arguments) {
    using namespace rlslab;
    int const rounds = count > 1 ? std::max(2, std::atoi(arguments[1])) : 20000;
    Index const rows = count > 2 ? std::max(1, std::atoi(arguments[2])) : 64;
    std::printf("| variant | arithmetic | d | C++ | C | C - C++ | its median |\n|---|---|---|---|---|---|---|\n");
    for (Index const d : {4, 16}) {
        bench::compare<Ud<double>>(rounds, rows, d);
        bench::compare<Ud<float>>(rounds, rows, d);
        bench::compare<Conventional<double>>(rounds, rows, d);
        bench::compare<Carlson<double>>(rounds, rows, d);
        bench::compare<InverseQr<double>>(rounds, rows, d);
        bench::compare<Qr<double>>(rounds, rows, d);
    }
}
