// What rows leave of each dense variant, by the types of C++: one line each, with a hash. For other processors and
// compilers (portability.cpp compiles it for them), languages (tests/doors) and Python (tests/python).
//
//   digest              1000 rows, float and double, 5 parameters: theta, K, and P or P^-1 by columns
//   digest save DIR     also saves the states after 500 rows: DIR/VARIANT.ARITHMETIC
//   digest load DIR     starts from those states
//   digest outputs      20 rows and 600 more at once of three outputs: theta by rows, and the state
//   digest all          300 rows, more sizes: every step and report, and the state; and the next two, in asked.cpp:
//   digest short        the same in bfloat16 and 12 bits, and of complex filters
//   digest asked        100 rows of the weights (k mod 5) / 2, a removal, psi'P psi, draws, the least excited direction
// and, where of_doors.cpp and complex_of_doors.cpp are linked:
//   digest composed DIR saves states of compositions after 100 rows; theta after 200
//   digest complex      60 rows of eleven complex filters: theta, and the state
//   digest fleets       60 weighted rows of eleven filters of two outputs, likewise
//
// Rows: s = (1664525 s + 1013904223) mod 2^32 from s = 1 on, and each number is floor(s / 2^8) / 2^23 - 1: five of psi,
// then y. Every language computes them exactly, and float holds them. Hash: of the bytes b of numbers as binary64, the
// lowest first, h = (m h + b) mod 4294967291 from 1 on, for m = 257 and for m = 65599: a language without integers of
// 64 bits has them in binary64. One NaN for all.
#include "tests/portability/digest.hpp"

#include <rlslab/arithmetic/pack.hpp>
#include <rlslab/core/rounding.hpp>

namespace rlslab::digests {
namespace {

enum class Halfway { nothing, save, load };
template <class F>
int after_1000_rows(Halfway halfway, std::string const& folder) {
    using T = typename F::scalar;
    F filter(Problem<T>{.size = d, .forgetting = T(0.9921875)});
    std::string const path = folder + "/" + std::string(F::name) + "." + std::string(ArithmeticTraits<T>::name);
    Numbers numbers;
    take(filter, 500, numbers);
    if (halfway == Halfway::save) save_in(path, filter);
    if (halfway == Halfway::load) {
        std::ifstream file(path, std::ios::binary);
        std::string const bytes{std::istreambuf_iterator<char>(file), {}};
        filter = F(Problem<T>{.size = d});
        if (load(filter, std::as_bytes(std::span(bytes))) != StateFault::none) {
            std::fprintf(stderr, "%s is no state\n", path.c_str());
            return 1;
        }
    }
    take(filter, 500, numbers);
    Hash hash;
    hash.add(Vector<T>(filter.theta()));
    hash.add(Vector<T>(filter.gain()));
    if constexpr (ReportsCovariance<F>) hash.add(Matrix<T>(filter.covariance()));
    else hash.add(Matrix<T>(filter.information()));
    hash.print(name_of_type<F>());
    return 0;
}
template <class F>
void several_outputs() {
    using T = typename F::scalar;
    MultiOutput<F> filter(Problem<T>{.size = d, .forgetting = T(0.9921875)}, 3);
    Numbers numbers;
    Matrix<T> X(d, 620), Y(3, 620);
    for (Index k = 0; k < X.cols(); ++k) {
        for (Index i = 0; i < d; ++i) X(i, k) = T(numbers.next());
        for (Index j = 0; j < 3; ++j) Y(j, k) = T(numbers.next());
    }
    auto const row = [&](Index k) { filter.update(X.col(k), Y.col(k)); };
    for (Index k = 0; k < 20; ++k) row(k);
    Index at_once = 64;
    if constexpr (TakesBlocks<F>) at_once = F::block;
    for (Index k = 20; k < 620; k += at_once) {
        Index const count = std::min(at_once, 620 - k);
        if constexpr (requires { filter.update_block(X, Y); })
            filter.update_block(X.middleCols(k, count), Y.middleCols(k, count).transpose());
        else
            for (Index i = k; i < k + count; ++i) row(i);
    }
    Hash hash;
    hash.add(filter.theta().transpose());
    for (std::byte const byte : state_of(filter)) hash.add(byte);
    hash.print(name_of_type<F>());
}

int outputs(std::string const&) {
    auto const left_by = []<class F>() {
        if constexpr (requires { typename MultiOutput<F>; }) several_outputs<F>();
    };
    for_each(Variants<float>{}, left_by);
    for_each(Variants<double>{}, left_by);
    return 0;
}
void lanes() {
    using T = Pack<double, 4>;
    Ud<T> filter(Problem<T>{.size = 3});
    Seed seed{7};
    Vector<T> psi(3);
    for (int k = 0; k < 100; ++k) {
        for (T& x : psi)
            for (int lane = 0; lane < 4; ++lane) x.set(lane, seed.bell());
        filter.update(psi, psi[0]);
    }
    Hash out;
    for (T const& x : Vector<T>(filter.theta()))
        for (int lane = 0; lane < 4; ++lane) out.add(x[lane]);
    out.print("ud pack 3");
}

template <Halfway halfway>
int after_1000_rows_in(std::string const& folder) {
    int code = 0;
    auto const left_by = [&]<class F>() { code |= after_1000_rows<F>(halfway, folder); };
    for_each(Variants<float>{}, left_by);
    for_each(Variants<double>{}, left_by);
    return code;
}
int all(std::string const& folder) {
    for (std::string_view const fault : rounding_faults()) std::printf("%s\n", fault.data());
    everything_in<float>();
    everything_in<double>();
    lanes();
    verbs.at("short")(folder);
    return verbs.at("asked")(folder);
}

}  // namespace
}  // namespace rlslab::digests

int main(int count, char** arguments) {
    using namespace rlslab::digests;
    verbs.insert({{"", after_1000_rows_in<Halfway::nothing>},
                  {"save", after_1000_rows_in<Halfway::save>},
                  {"load", after_1000_rows_in<Halfway::load>},
                  {"outputs", outputs},
                  {"all", all}});
    std::string const verb = count > 1 ? arguments[1] : "";
    auto const found = verbs.find(verb);
    if (found != verbs.end()) return found->second(count > 2 ? arguments[2] : "");
    std::fprintf(stderr, "%s: no verb of this program\n", verb.c_str());
    return 2;
}
