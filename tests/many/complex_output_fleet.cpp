// Fleets of several complex outputs are complex filters, bit for bit.
#include "tests/many/output_fleet.hpp"

#include <complex>

namespace rlslab {
namespace {

using namespace outputs;

TEST(ComplexOutputFleet, KeepsTheBitsOfFiltersOfTheirOwn) {
    expect_the_bits<Ud, Complex<float>>(3, 3), expect_the_bits<Ud, Complex<double>>(7, 3);
    expect_the_bits<UdDelta, Complex<float>>(4, 2), expect_the_bits<Carlson, Complex<double>>(8, 2);
    expect_the_bits<Potter, Complex<float>>(3, 2), expect_the_bits<Conventional, Complex<double>>(9, 2);
    expect_the_bits<Symmetric, Complex<float>>(9, 2), expect_the_bits<JosephRankTwo, Complex<double>>(8, 3);
    expect_the_bits<InverseQr, Complex<float>>(4, 2);
}
TEST(ComplexOutputFleet, OfFormsThatSolveForThetaHasOneOutput) {
    expect_the_bits<Gentleman, Complex<double>>(9, 1), expect_the_bits<Information, Complex<double>>(3, 1);
    expect_the_bits<Qr, Complex<double>>(3, 1, Start::no_prior);
    expect_the_bits<Gentleman, Complex<float>>(2, 1, Start::no_prior);
}
TEST(ComplexOutputFleet, ABitOfOneOutputOrWeightIsFound) { expect_a_bit_to_be_found<Complex<double>>(); }
TEST(ComplexOutputFleet, FindsARoomsResponse) {
    OutputFleet<Ud<Complex<Pack<double, 8>>>> fleet(2, {.size = 2});
    Numbers<Complex<double>> numbers;
    std::complex<double> const theta[2] = {{1, -2}, {0.5, 3}};
    for (int k = 0; k < 40; ++k) {
        std::vector<Complex<double>> psi(4), y;
        for (auto& x : psi) x = numbers.next();
        for (int i = 0; i < 2; ++i) {
            std::complex<double> sum = 0;
            for (size_t j = 0; j < 2; ++j) sum += std::conj(std::complex<double>(psi[size_t(2 * i) + j])) * theta[j];
            y.push_back(sum);
        }
        fleet.update(psi.data(), y.data());
    }
    for (Index j = 0; j < 2; ++j) EXPECT_LT(std::abs(std::complex<double>(fleet.theta(1)(j, 0)) - theta[j]), 1e-3);
}

}  // namespace
}  // namespace rlslab
