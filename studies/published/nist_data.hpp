// Data sets of the NIST Statistical Reference Datasets (StRD), linear regression: the published decimals.
#pragma once

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/core/records.hpp>

#include <array>
#include <string>
#include <string_view>

namespace rlslab::strd {

/// Longley 1967: x1 ... x6, y.
constexpr std::array<std::array<double, 7>, 16> longley{{{83, 234289, 2356, 1590, 107608, 1947, 60323},
                                                         {88.5, 259426, 2325, 1456, 108632, 1948, 61122},
                                                         {88.2, 258054, 3682, 1616, 109773, 1949, 60171},
                                                         {89.5, 284599, 3351, 1650, 110929, 1950, 61187},
                                                         {96.2, 328975, 2099, 3099, 112075, 1951, 63221},
                                                         {98.1, 346999, 1932, 3594, 113270, 1952, 63639},
                                                         {99, 365385, 1870, 3547, 115094, 1953, 64989},
                                                         {100, 363112, 3578, 3350, 116219, 1954, 63761},
                                                         {101.2, 397469, 2904, 3048, 117388, 1955, 66019},
                                                         {104.6, 419180, 2822, 2857, 118734, 1956, 67857},
                                                         {108.4, 442769, 2936, 2798, 120445, 1957, 68169},
                                                         {110.8, 444546, 4681, 2637, 121950, 1958, 66513},
                                                         {112.6, 482704, 3813, 2552, 123366, 1959, 68655},
                                                         {114.2, 502601, 3931, 2514, 125368, 1960, 69564},
                                                         {115.7, 518173, 4806, 2572, 127852, 1961, 69331},
                                                         {116.9, 554894, 4007, 2827, 130081, 1962, 70551}}};

/// A. Filippelli: x, y; the model is a polynomial of degree 10.
constexpr std::array<std::array<double, 2>, 82> filip{
    {{-6.860120914, 0.8116}, {-4.324130045, 0.9072}, {-4.358625055, 0.9052}, {-4.358426747, 0.9039}, {-6.955852379, 0.8053},
     {-6.661145254, 0.8377}, {-6.355462942, 0.8667}, {-6.118102026, 0.8809}, {-7.115148017, 0.7975}, {-6.815308569, 0.8162},
     {-6.519993057, 0.8515}, {-6.204119983, 0.8766}, {-5.853871964, 0.8885}, {-6.109523091, 0.8859}, {-5.79832982, 0.8959},
     {-5.482672118, 0.8913}, {-5.171791386, 0.8959}, {-4.851705903, 0.8971}, {-4.517126416, 0.9021}, {-4.143573228, 0.909},
     {-3.709075441, 0.9139}, {-3.499489089, 0.9199}, {-6.300769497, 0.8692}, {-5.953504836, 0.8872}, {-5.642065153, 0.89},
     {-5.031376979, 0.891},  {-4.680685696, 0.8977}, {-4.329846955, 0.9035}, {-3.928486195, 0.9078}, {-8.56735134, 0.7675},
     {-8.363211311, 0.7705}, {-8.107682739, 0.7713}, {-7.823908741, 0.7736}, {-7.522878745, 0.7775}, {-7.218819279, 0.7841},
     {-6.920818754, 0.7971}, {-6.628932138, 0.8329}, {-6.323946875, 0.8641}, {-5.991399828, 0.8804}, {-8.781464495, 0.7668},
     {-8.663140179, 0.7633}, {-8.473531488, 0.7678}, {-8.247337057, 0.7697}, {-7.971428747, 0.77},   {-7.676129393, 0.7749},
     {-7.352812702, 0.7796}, {-7.072065318, 0.7897}, {-6.774174009, 0.8131}, {-6.478861916, 0.8498}, {-6.159517513, 0.8741},
     {-6.835647144, 0.8061}, {-6.53165267, 0.846},   {-6.224098421, 0.8751}, {-5.910094889, 0.8856}, {-5.598599459, 0.8919},
     {-5.290645224, 0.8934}, {-4.974284616, 0.894},  {-4.64454848, 0.8957},  {-4.290560426, 0.9047}, {-3.885055584, 0.9129},
     {-3.408378962, 0.9209}, {-3.13200249, 0.9219},  {-8.726767166, 0.7739}, {-8.66695597, 0.7681},  {-8.511026475, 0.7665},
     {-8.165388579, 0.7703}, {-7.886056648, 0.7702}, {-7.588043762, 0.7761}, {-7.283412422, 0.7809}, {-6.995678626, 0.7961},
     {-6.691862621, 0.8253}, {-6.392544977, 0.8602}, {-6.067374056, 0.8809}, {-6.684029655, 0.8301}, {-6.378719832, 0.8664},
     {-6.065855188, 0.8834}, {-5.752272167, 0.8898}, {-5.132414673, 0.8964}, {-4.811352704, 0.8963}, {-4.098269308, 0.9074},
     {-3.66174277, 0.9119},  {-3.2644011, 0.9228}}};

/// Wampler 1970: what Wampler3 adds to the polynomial at x = 0 ... 20, orthogonal to it; Wampler4 adds 100
/// times that, Wampler5 10000 times.
constexpr std::array<double, 21> wampler_residual{759,   -2048, 2048,  -2048, 2523,  -2048, 2048,  -2048, 1838,  -2048, 2048,
                                                  -2048, 1838,  -2048, 2048,  -2048, 2523,  -2048, 2048,  -2048, 759};

/// The exact solution of the decimals, to 30 digits; it agrees with all 15 that NIST certifies.
constexpr std::array<std::string_view, 7> longley_theta{"-3.48225863459581832527689742876e+6", "1.50618722713732949699884679430e+1",
                                                        "-3.58191792925910166168577525360e-2", "-2.02022980381682508565347406204e+0",
                                                        "-1.03322686717359197549469146328e+0", "-5.11041056535807144706642656987e-2",
                                                        "1.82915146461355184522976668424e+3"};

/// The exact solution of the decimals, to 30 digits; it agrees with all 15 that NIST certifies.
constexpr std::array<std::string_view, 11> filip_theta{
    "-1.46748961422979588228784851531e+3", "-2.77217959193342392802844755665e+3", "-2.31637108160893075882196791650e+3",
    "-1.12797394098371569857167001527e+3", "-3.54478233703348771610738485260e+2", "-7.51242017393757138905220755748e+1",
    "-1.08753180355342510852810811829e+1", "-1.06221498588946766459661122059e+0", "-6.70191154593408375926734122885e-2",
    "-2.46781078275478650840854452419e-3", "-4.02962525080403671297131548528e-5"};

/// Powers by repeated multiplication in double, as a program makes them; `y` of (row, powers).
template <class X, class Y>
Records polynomial(Index rows, Index size, X x, Y y) {
    Records out{.psi = Matrix<double>(size, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        out.psi(0, k) = 1;
        for (Index j = 1; j < size; ++j) out.psi(j, k) = out.psi(j - 1, k) * x(k);
        out.y[k] = y(k);
    }
    return out;
}
inline Records records_of(std::string const& set) {
    if (set == "longley") {
        Records out{.psi = Matrix<double>(7, Index(longley.size())), .y = Vector<double>(Index(longley.size())), .names = {}};
        for (Index k = 0; k < out.rows(); ++k) {
            out.psi(0, k) = 1;
            for (Index j = 1; j < 7; ++j) out.psi(j, k) = longley[size_t(k)][size_t(j - 1)];
            out.y[k] = longley[size_t(k)].back();
        }
        return out;
    }
    if (set == "filip") {
        auto const x = [](Index k) { return filip[size_t(k)][0]; };
        return polynomial(Index(filip.size()), 11, x, [](Index k) { return filip[size_t(k)][1]; });
    }
    char const number = set.back();  // Wampler: y = sum x^j + residual, Wampler2: y = sum (x/10)^j in five decimals
    return polynomial(
        21, 6, [](Index k) { return double(k); },
        [number](Index k) {
            long const x = k, tenths = 100000 + x * (10000 + x * (1000 + x * (100 + x * (10 + x))));
            long const sum = 1 + x * (1 + x * (1 + x * (1 + x * (1 + x))));
            double const scale = number == '3' ? 1 : number == '4' ? 100 : number == '5' ? 10000 : 0;
            return number == '2' ? double(tenths) / 100000 : double(sum) + scale * wampler_residual[size_t(k)];
        });
}
/// The solution of the published decimals, component i.
inline Reference decimal(std::string const& set, Index i) {
    if (set == "longley") return Reference(std::string(longley_theta[size_t(i)]));
    if (set == "filip") return Reference(std::string(filip_theta[size_t(i)]));
    return set == "wampler2" ? Reference(1) / pow(Reference(10), int(i)) : Reference(1);
}

}  // namespace rlslab::strd
