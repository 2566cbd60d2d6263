// Fleets by the C interface, of real and of complex numbers, with weights and several outputs: the bytes of
// rlslab::OutputFleet by its type, the bits of filters alone, and what is refused.
#include "tests/capi/filters.hpp"

#include <rlslab/many/output_fleet.hpp>
#include <rlslab/variants/variants.hpp>

#include <cstring>

namespace rlslab::c {
namespace {

using testing::HasSubstr;

constexpr std::size_t d = 3, M = 10, rows = 40;

using Handle = std::unique_ptr<rlslab_complex, Free>;
Handle made(char const* variant, char const* arithmetic, std::size_t m, std::size_t filters = M) {
    rlslab_options const options = options_of(d, 0.98);
    rlslab_complex* out = nullptr;
    rlslab_complex_new(variant, arithmetic, filters, m, &options, &out);
    return Handle(out);
}
FleetHandle fleet_of(char const* variant, char const* arithmetic, rlslab_options const& options, std::size_t m = 1) {
    rlslab_fleet* out = nullptr;
    rlslab_fleet_new_outputs(variant, arithmetic, M, m, &options, &out);
    return FleetHandle(out);
}
/// 0, 1, and others; some that are none.
template <class T>
std::vector<T> weights() {
    std::vector<T> out(rows * M);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = i % 41 == 0 ? T(-1) : i % 43 == 0 ? T(nan) : T(i % 5) / 2;
    return out;
}

template <class F>
void expect_the_bytes_of(std::size_t m) {
    using Fleet = OutputFleet<F>;
    using T = typename Fleet::real;
    using N = typename Fleet::number;
    SCOPED_TRACE(std::string(F::name));
    constexpr std::size_t parts = sizeof(N) / sizeof(T);
    auto const psi = numbers<T>(parts * rows * M * d, 5), y = numbers<T>(parts * rows * M * m, 6), w = weights<T>();
    Fleet fleet(Index(M), {.size = Index(d), .forgetting = T(0.98)}, Index(m));
    FleetSteps<N> last{Index(M), Index(m)};
    auto const at = [](std::vector<T> const& x, std::size_t from) {
        return reinterpret_cast<N const*>(x.data() + parts * from);
    };
    Index expected = 0;
    for (std::size_t k = 0; k < rows; ++k)
        expected += fleet.update(at(psi, k * M * d), at(y, k * M * m), &w[k * M], &last);

    std::size_t missing = 7;
    std::vector<double> theta(parts * M * d * m), P(parts * d * d), told(parts * rows * M * m);
    constexpr bool covariance = ReportsCovariance<F>;
    char const *const variant = F::name.data(), *const arithmetic = ArithmeticTraits<T>::name.data();
    auto const check = [&](auto handle, auto update, auto copy, auto load, auto P_of) {
        ASSERT_NE(handle, nullptr) << rlslab_message();
        ASSERT_EQ(update(handle.get()), RLSLAB_OK) << rlslab_message();
        EXPECT_EQ(missing, std::size_t(expected));
        auto const state = state_of(handle.get());
        EXPECT_EQ(state, rlslab::state_of(fleet));
        typename decltype(handle)::pointer copied = nullptr;
        ASSERT_EQ(copy(handle.get(), &copied), RLSLAB_OK);
        decltype(handle) const other(copied);
        EXPECT_EQ(load(other.get(), state.data(), state.size()), RLSLAB_OK);
        EXPECT_EQ(state_of(other.get()), state);
        EXPECT_EQ(P_of(handle.get()), RLSLAB_OK);
    };
    if constexpr (parts == 2) {
        rlslab_complex_steps const to{told.data(), nullptr, nullptr, nullptr};
        auto const update = [&](rlslab_complex* f) {
            if constexpr (std::same_as<T, float>)
                return rlslab_complex_update_weighted_f32(f, psi.data(), y.data(), w.data(), rows, &to, &missing);
            else return rlslab_complex_update_weighted(f, psi.data(), y.data(), w.data(), rows, &to, &missing);
        };
        check(made(variant, arithmetic, m), update, rlslab_complex_copy, rlslab_complex_load, [&](rlslab_complex* f) {
            rlslab_complex_theta(f, theta.data());
            EXPECT_EQ((covariance ? rlslab_complex_information : rlslab_complex_covariance)(f, 9, P.data()),
                      RLSLAB_ABILITY);
            return (covariance ? rlslab_complex_covariance : rlslab_complex_information)(f, 9, P.data());
        });
    } else {
        std::vector<rlslab_step> steps(rows * M * m);
        auto const update = [&](rlslab_fleet* f) {
            if constexpr (std::same_as<T, float>)
                return rlslab_fleet_update_many_f32(f, psi.data(), y.data(), w.data(), rows, steps.data(), &missing);
            else return rlslab_fleet_update_many(f, psi.data(), y.data(), w.data(), rows, steps.data(), &missing);
        };
        check(fleet_of(variant, arithmetic, options_of(d, 0.98), m), update, rlslab_fleet_copy, rlslab_fleet_load,
              [&](rlslab_fleet* f) {
                  for (std::size_t i = 0; i < M; ++i) rlslab_fleet_theta(f, i, &theta[i * d * m]);
                  EXPECT_EQ(rlslab_fleet_information(f, 9, P.data()), RLSLAB_ABILITY);
                  return rlslab_fleet_covariance(f, 9, P.data());
              });
        for (std::size_t i = 0; i < told.size(); ++i) told[i] = steps[i].innovation;
    }
    auto const part = [](N const& x, std::size_t which) {
        if constexpr (parts == 2) return double(which ? x.im : x.re);
        else return double(x);
    };
    auto const one = fleet.filter(9);
    Matrix<N> reported;
    if constexpr (covariance) reported = one.covariance();
    else reported = one.information();
    for (std::size_t i = 0; i < M * m * parts; ++i) {
        double const expected_part = part(last.innovation[Index(i / parts)], i % parts),
                     found = told[told.size() - M * m * parts + i];
        EXPECT_TRUE(found == expected_part || (found != found && expected_part != expected_part)) << i;
    }
    for (std::size_t i = 0; i < theta.size(); ++i)
        EXPECT_EQ(
            theta[i],
            part(fleet.theta(Index(i / (d * m * parts)))(Index(i / (m * parts) % d), Index(i / parts % m)), i % parts));
    for (std::size_t i = 0; i < P.size(); ++i) EXPECT_EQ(P[i], part(reported.data()[i / parts], i % parts));
}

TEST(FleetsOfC, LeaveTheBytesOfCpp) {
    expect_the_bytes_of<Ud<Complex<Pack<float, 8>>>>(2);
    expect_the_bytes_of<Symmetric<Complex<Pack<double, 8>>>>(1);
    expect_the_bytes_of<Gentleman<Complex<Pack<double, 8>>>>(1);
    expect_the_bytes_of<Ud<Pack<float, 8>>>(3);
    expect_the_bytes_of<Symmetric<Pack<double, 8>>>(2);
}
/// Also with what is around a filter; a row that is none for a fleet is not offered to the filter alone.
TEST(FleetsOfC, AWeightedRowIsThatOfAFilterAlone) {
    auto const psi = numbers(rows * M * d, 5), y = numbers(rows * M, 6), w = weights<double>();
    std::vector<rlslab_step> steps(rows * M);
    for (std::string const& variant : names(RLSLAB_VARIANTS))
        for (char const* const guard : {"", "reset"})
            for (char const* const arithmetic : {"double", "float"}) {
                SCOPED_TRACE(variant + arithmetic + guard);
                rlslab_options options = options_of(d, 0.98);
                if (*guard) options.guard = guard;
                FleetHandle const fleet = fleet_of(variant.c_str(), arithmetic, options);
                if (!fleet) continue;  // qr_block
                ASSERT_EQ(
                    rlslab_fleet_update_many(fleet.get(), psi.data(), y.data(), w.data(), rows, steps.data(), nullptr),
                    RLSLAB_OK);
                for (std::size_t m = 0; m < M; ++m) {
                    FilterHandle const alone = filter_of(variant.c_str(), arithmetic, options);
                    double theta[d];
                    bool equal = true;
                    for (std::size_t k = m; k < rows * M; k += M) {
                        rlslab_step step, found = steps[k];
                        rlslab_update_weighted(alone.get(), &psi[k * d], y[k], w[k], &step);
                        for (auto [a, b] :
                             {std::pair(&step.innovation, &found.innovation),
                              std::pair(&step.residual, &found.residual), std::pair(&step.gamma, &found.gamma)})
                            if (*a != *a && *b != *b) *a = *b = 0;
                        equal = equal && std::memcmp(&step, &found, sizeof step) == 0;
                    }
                    EXPECT_TRUE(equal) << m;
                    rlslab_fleet_theta(fleet.get(), m, theta);
                    EXPECT_EQ(std::memcmp(theta, theta_of(alone.get()).data(), sizeof theta), 0);
                }
                FleetHandle const ones = fleet_of(variant.c_str(), arithmetic, options),
                                  none = fleet_of(variant.c_str(), arithmetic, options);
                std::vector<double> const one(rows * M, 1.0);
                rlslab_fleet_update_many(ones.get(), psi.data(), y.data(), one.data(), rows, nullptr, nullptr);
                rlslab_fleet_update_many(none.get(), psi.data(), y.data(), nullptr, rows, nullptr, nullptr);
                EXPECT_EQ(state_of(ones.get()), state_of(none.get()));
            }
}
TEST(FleetsOfC, RefuseInALine) {
    rlslab_options options = options_of(d);
    EXPECT_EQ(fleet_of("qr", "double", options, 2), nullptr);
    EXPECT_THAT(rlslab_message(), HasSubstr("one output"));
    EXPECT_EQ(fleet_of("ud", "double", options, 0), nullptr);
    EXPECT_EQ(fleet_of("ud", "double", options, most), nullptr);
    options.guard = "reset";
    EXPECT_EQ(fleet_of("ud", "double", options, 2), nullptr);
    EXPECT_THAT(rlslab_message(), HasSubstr("plain variant"));
    FleetHandle const fleet = fleet_of("ud", "double", options_of(d), 2);
    auto const before = state_of(fleet.get());
    double x[2 * M * d] = {};
    std::vector<double> const none(M, -1.0);
    std::size_t missing = 0;
    EXPECT_EQ(rlslab_fleet_outputs(fleet.get()), 2u);
    EXPECT_EQ(rlslab_fleet_outputs(nullptr), 0u);
    EXPECT_EQ(rlslab_fleet_update_many(fleet.get(), x, x, none.data(), 1, nullptr, &missing), RLSLAB_OK);
    EXPECT_EQ(missing, M);
    EXPECT_EQ(rlslab_fleet_update_many(fleet.get(), x, nullptr, nullptr, 1, nullptr, nullptr), RLSLAB_NULL);
    EXPECT_EQ(rlslab_fleet_update_many(nullptr, x, x, nullptr, 1, nullptr, nullptr), RLSLAB_NULL);
    EXPECT_EQ(rlslab_fleet_update_many(fleet.get(), nullptr, nullptr, nullptr, 0, nullptr, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_fleet_update_many(fleet.get(), x, x, nullptr, PTRDIFF_MAX, nullptr, nullptr), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_fleet_covariance(fleet.get(), M, x), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_fleet_covariance(fleet.get(), 0, nullptr), RLSLAB_NULL);
    EXPECT_EQ(state_of(fleet.get()), before);
}
TEST(ComplexOfC, RefusesInALine) {
    rlslab_options options = options_of(d);
    rlslab_complex* out = nullptr;
    EXPECT_EQ(rlslab_complex_new("ut", "double", M, 1, &options, &out), RLSLAB_NAME);
    EXPECT_EQ(rlslab_complex_new("qr_block", "double", M, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_new("qr", "double", M, 2, &options, &out), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("one output"));
    EXPECT_EQ(rlslab_complex_new("ud", "double", 0, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 0, &options, &out), RLSLAB_INVALID);
    options.guard = "reset";
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_THAT(rlslab_message(), HasSubstr("plain variant"));
    options = options_of(d);
    double const theta[d] = {1, 2, 3};
    options.prior_theta = theta;
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, &options, &out), RLSLAB_INVALID);
    EXPECT_EQ(out, nullptr);
    EXPECT_NE(rlslab_complex_new("ud", "double", most, 1, &options, &out), RLSLAB_OK);
    EXPECT_EQ(rlslab_complex_new("ud", "double", 1, 1, nullptr, &out), RLSLAB_NULL);

    Handle const filter = made("ud", "double", 1, 1);
    double const psi[2 * d] = {1, 2, 3, 4, 5, std::numeric_limits<double>::infinity()}, y[2] = {1, 1};
    auto const before = state_of(filter.get());
    std::size_t missing = 0;
    EXPECT_EQ(rlslab_complex_update(filter.get(), psi, y, 1, nullptr, &missing), RLSLAB_OK);
    EXPECT_EQ(missing, 1u);
    EXPECT_EQ(rlslab_complex_update(filter.get(), nullptr, nullptr, 0, nullptr, nullptr), RLSLAB_OK);
    EXPECT_EQ(rlslab_complex_update(filter.get(), nullptr, y, 1, nullptr, nullptr), RLSLAB_NULL);
    EXPECT_EQ(rlslab_complex_update(filter.get(), psi, y, most, nullptr, nullptr), RLSLAB_INVALID);
    double P[2 * d * d];
    EXPECT_EQ(rlslab_complex_covariance(filter.get(), 1, P), RLSLAB_INVALID);
    EXPECT_EQ(rlslab_complex_health(filter.get(), 1), -1);
    std::byte few[4] = {};
    EXPECT_EQ(rlslab_complex_save(filter.get(), few, sizeof few), RLSLAB_ROOM);
    EXPECT_EQ(rlslab_complex_load(filter.get(), few, sizeof few), RLSLAB_STATE);
    EXPECT_EQ(state_of(filter.get()), before);
    EXPECT_EQ(rlslab_complex_health(nullptr, 0), -1);
    EXPECT_EQ(rlslab_complex_size(nullptr) + rlslab_complex_filters(nullptr) + rlslab_complex_outputs(nullptr), 0u);
    rlslab_complex_free(nullptr);
}

}  // namespace
}  // namespace rlslab::c
