// What 1000 rows leave of each dense variant in float and double, one line each, by the types of C++. The programs
// bits.* beside this one do the same through the C interface, and tests/doors/doors.sh compares them.
//
//   bits           prints the lines
//   bits save DIR  also saves the states after 500 rows: DIR/VARIANT.ARITHMETIC
//   bits load DIR  starts from those states
//
// Rows: s = (1664525 s + 1013904223) mod 2^32 from s = 1 on, and each number is floor(s / 2^8) / 2^23 - 1: five of psi,
// then y. Every language computes them exactly, and float holds them. Hash: of the bytes b of theta, K, and P or P^-1
// by columns as binary64, the lowest first, h = (m h + b) mod 4294967291 from 1 on, for m = 257 and for m = 65599: a
// language without integers of 64 bits has them in binary64.
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

namespace {

using rlslab::Index;

constexpr int d = 5, rows = 1000, half = 500;

struct Row {
    std::array<double, d> psi;
    double y;
};
std::vector<Row> records() {
    std::uint32_t s = 1;
    auto const draw = [&] {
        s = 1664525 * s + 1013904223;
        return (s >> 8) / 8388608.0 - 1;
    };
    std::vector<Row> out(rows);
    for (Row& row : out) {
        for (double& x : row.psi) x = draw();
        row.y = draw();
    }
    return out;
}

struct Hash {
    std::uint64_t first = 1, second = 1;
    void add(double x) {
        for (int i = 0; i < 8; ++i) {
            std::uint64_t const byte = std::bit_cast<std::uint64_t>(x) >> (8 * i) & 255;
            first = (257 * first + byte) % 4294967291;
            second = (65599 * second + byte) % 4294967291;
        }
    }
    void add_all(auto const& A) {
        for (Index j = 0; j < A.cols(); ++j)
            for (Index i = 0; i < A.rows(); ++i) add(double(A(i, j)));
    }
};

template <class F>
int process(std::string const& verb, std::string const& folder) {
    using T = typename F::scalar;
    F filter(rlslab::Problem<T>{.size = d, .forgetting = T(0.9921875)});
    std::string const name(F::name), arithmetic(rlslab::ArithmeticTraits<T>::name),
        path = folder + "/" + name + "." + arithmetic;
    int from = 0;
    if (verb == "load") {
        std::ifstream file(path, std::ios::binary);
        std::string const bytes{std::istreambuf_iterator<char>(file), {}};
        if (load(filter, std::as_bytes(std::span(bytes))) != rlslab::StateFault::none) {
            std::fprintf(stderr, "%s is no state\n", path.c_str());
            return 1;
        }
        from = half;
    }
    std::vector<Row> const all = records();
    for (int k = from; k < rows; ++k) {
        if (k == half && verb == "save") {
            std::vector<std::byte> const state = rlslab::state_of(filter);
            std::ofstream(path, std::ios::binary)
                .write(reinterpret_cast<char const*>(state.data()), std::streamsize(state.size()));
        }
        rlslab::Vector<T> psi(d);
        for (int i = 0; i < d; ++i) psi[i] = T(all[std::size_t(k)].psi[std::size_t(i)]);
        filter.update(psi, T(all[std::size_t(k)].y));
    }
    Hash hash;
    hash.add_all(rlslab::Vector<T>(filter.theta()));
    hash.add_all(rlslab::Vector<T>(filter.gain()));
    if constexpr (rlslab::ReportsCovariance<F>) hash.add_all(rlslab::Matrix<T>(filter.covariance()));
    else hash.add_all(rlslab::Matrix<T>(filter.information()));
    std::printf("%s %s %08llx%08llx\n", name.c_str(), arithmetic.c_str(), (unsigned long long)hash.first,
                (unsigned long long)hash.second);
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    std::string const verb = count > 1 ? arguments[1] : "", folder = count > 2 ? arguments[2] : "";
    int code = 0;
    rlslab::for_each(rlslab::Variants<float>{}, [&]<class F>() { code |= process<F>(verb, folder); });
    rlslab::for_each(rlslab::Variants<double>{}, [&]<class F>() { code |= process<F>(verb, folder); });
    return code;
}
