// What an app computes that is compiled for this processor at -O3, complex numbers among it: a line each. The bits must
// be those of -O1 for any processor: GCC's vectorizer fuses a sum beside a difference whatever -ffp-contract says.
#include <rlslab/core/complex.hpp>
#include <rlslab/variants/variants.hpp>

#include <cstdio>

using namespace rlslab;

namespace {

template <class T>
struct Numbers {
    std::uint32_t s = 1;
    double real() {
        s = 1664525 * s + 1013904223;
        return (s >> 8) / 8388608.0 - 1;
    }
    T next() {
        if constexpr (ComplexScalar<T>) {
            RealOf<T> const re = RealOf<T>(real());
            return {re, RealOf<T>(real())};
        } else {
            return T(real());
        }
    }
};

template <template <class, int> class V, class T, int N>
void print(Index size = N) {
    V<T, N> f(Problem<T>{.size = size, .forgetting = RealOf<T>(0.99)});
    std::vector<T> psi(static_cast<size_t>(size));
    Numbers<T> numbers;
    for (int k = 0; k < 100; ++k) {
        for (T& x : psi) x = numbers.next();
        f.update(Regressor<T>(psi), numbers.next());
    }
    std::printf("%s %s %d:", std::string(V<T, N>::name).c_str(), std::string(ArithmeticTraits<T>::name).c_str(),
                static_cast<int>(size));
    for (T const& x : f.theta())
        std::printf(" %a %a", double(real_part(x)), double(real_part(conjugate(x) * f.theta()[0])));
    std::printf("\n");
}
template <class T>
void print_all() {
    print<Ud, T, Dynamic>(11), print<JosephRankTwo, T, Dynamic>(11), print<Symmetric, T, Dynamic>(11);
    print<Conventional, T, Dynamic>(11), print<Gentleman, T, Dynamic>(11), print<InverseQr, T, Dynamic>(11);
    print<Ud, T, 4>(), print<Carlson, T, 4>(), print<Qr, T, 4>(), print<JosephRankTwo, T, 4>();
}

}  // namespace

int main() {
    print_all<float>(), print_all<double>();
    print_all<Complex<float>>(), print_all<Complex<double>>();
}
