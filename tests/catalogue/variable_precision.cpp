// VariablePrecision rounds as its format does: against float, double, the chopped formats, and exact
// rationals.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/qr_block.hpp>
#include <rlslab/variants/qr.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

/// Numbers of p bits with short and long significands, so that sums cancel and midpoints come up.
double draw(Seed& seed, int p) {
    PrecisionScope const precision(p);
    double const x = std::ldexp(seed.bell(), int(6 * seed.bell()));
    return double(VariablePrecision(seed.uniform() < 0.3 ? std::nearbyint(x * 4) / 4 : x));
}

/// One rounding of an exact value to p bits, ties to even, by its definition.
double rounded(Rational const& exact, int p) {
    if (exact == 0) return 0;
    int e = 0;
    Rational size = abs(exact);
    for (; size >= 2; size /= 2) ++e;
    for (; size < 1; size *= 2) --e;
    Rational const scaled = size * Rational(std::ldexp(1.0, p - 1));
    boost::multiprecision::mpz_int whole = numerator(scaled) / denominator(scaled);
    Rational const rest = scaled - Rational(whole);
    if (rest > Rational(1, 2) || (rest == Rational(1, 2) && whole % 2 != 0)) ++whole;
    return (exact < 0 ? -1 : 1) * std::ldexp(static_cast<double>(whole), e - p + 1);
}

TEST(VariablePrecision, EveryOperationIsRoundedOnce) {
    Seed seed{7};
    for (int p = 2; p <= 53; ++p)
        for (int k = 0; k < 2000; ++k) {
            double const x = draw(seed, p), y = draw(seed, p);
            PrecisionScope const precision(p);
            Rational const a(x), b(y);
            EXPECT_EQ(double(VariablePrecision(x) + VariablePrecision(y)), rounded(a + b, p))
                << p << ' ' << x << ' ' << y;
            EXPECT_EQ(double(VariablePrecision(x) - VariablePrecision(y)), rounded(a - b, p))
                << p << ' ' << x << ' ' << y;
            EXPECT_EQ(double(VariablePrecision(x) * VariablePrecision(y)), rounded(a * b, p))
                << p << ' ' << x << ' ' << y;
            if (y != 0) {
                EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), rounded(a / b, p))
                    << p << ' ' << x << ' ' << y;
            }
        }
}

/// A root lies on the right side of both midpoints beside it.
TEST(VariablePrecision, RootsAreRoundedOnce) {
    Seed seed{8};
    for (int p = 2; p <= 53; ++p)
        for (int k = 0; k < 500; ++k) {
            double const x = std::abs(draw(seed, p));
            if (x == 0) continue;
            PrecisionScope const precision(p);
            double const root = double(sqrt(VariablePrecision(x)));
            int e = 0;
            std::frexp(root, &e);
            Rational const half(std::ldexp(0.5, e - p)), r(root);
            EXPECT_TRUE((r - half) * (r - half) <= Rational(x) || root == std::ldexp(0.5, e)) << p << ' ' << x;
            EXPECT_LE(Rational(x), (r + half) * (r + half)) << p << ' ' << x;
        }
}

TEST(VariablePrecision, TwentyFourAreFloatAndElevenBinary16) {
    Seed seed{9};
    for (int k = 0; k < 20000; ++k) {
        {
            PrecisionScope const precision(24);
            float const x = float(seed.bell()), y = float(seed.bell());
            EXPECT_EQ(double(VariablePrecision(x) * VariablePrecision(y)), double(x * y));
            EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), double(x / y));
            EXPECT_EQ(double(sqrt(VariablePrecision(std::abs(x)))), double(std::sqrt(std::abs(x))));
        }
        {
            PrecisionScope const precision(11);
            double const x = 1 + seed.uniform(), y = 1 + seed.uniform();
            EXPECT_EQ(double(VariablePrecision(x) / VariablePrecision(y)), double(Half(x) / Half(y)));
            EXPECT_EQ(double(VariablePrecision(x) + VariablePrecision(y)), double(Half(x) + Half(y)));
        }
    }
}

TEST(VariablePrecision, ThePrecisionIsTheThreadsAndComesBack) {
    EXPECT_EQ(PrecisionScope::bits(), 53);
    {
        PrecisionScope const outer(8);
        {
            PrecisionScope const inner(20);
            EXPECT_EQ(PrecisionScope::bits(), 20);
        }
        EXPECT_EQ(double(VariablePrecision(257.0)), 256);
    }
    EXPECT_EQ(PrecisionScope::bits(), 53);
    EXPECT_THROW(PrecisionScope(1), std::invalid_argument);
    EXPECT_THROW(PrecisionScope(54), std::invalid_argument);
}

/// With double's bits, and float's, every variant gives what it gives in double and float, where kernels run.
TEST(VariablePrecision, VariantsGiveTheBitsOfTheHardware) {
    for (auto const& [bits, name] : {std::pair{53, "double"}, std::pair{24, "float"}})
        for (CatalogueEntry const& e : variable_precision_catalogue()) {
            PrecisionScope const precision(bits);
            CatalogueEntry const* const hardware = find_entry(e.variant, name);
            ASSERT_TRUE(hardware);
            Records const records = as_stored(laws::noise_records(5, 60, Seed{4}), *hardware->arithmetic);
            auto const f = e.make(laws::problem(5, 0.96875), Seed{1}),
                       g = hardware->make(laws::problem(5, 0.96875), Seed{1});
            laws::process_rows(*f, records);
            laws::process_rows(*g, records);
            EXPECT_TRUE(laws::identical(f->stored(), g->stored())) << e.variant << ' ' << bits;
            EXPECT_TRUE(laws::identical(f->theta(), g->theta())) << e.variant << ' ' << bits;
        }
}

// --- formats with a range, and their roundings -----------------------------------------------------------------------

template <Format F, Rounding R>
void expect_the_operations_of_chopped() {
    Seed seed{7}, first{3}, second{3};
    StochasticStream const common(first);
    PrecisionScope const precision(RunTimeFormat{F, R});
    for (int i = 0; i < 20000; ++i) {
        int const reach = F.max_exp + F.digits;  // also what overflows and what is subnormal
        auto const drawn = [&] {
            return round_to_nearest(std::ldexp(seed.bell(), int(seed.uniform() * 2 * reach) - reach), F);
        };
        double const x = drawn(), y = i % 5 == 0 ? x : drawn();
        using One = Chopped<F, R>;
        using Other = VariablePrecision;
        auto const same = [&](auto const& operation) {
            Seed const before = first;
            double const a = double(operation(One(x), One(y)));
            second = first;
            first = before;
            double const b = double(operation(Other(x), Other(y)));
            EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b))
                << x << ' ' << y << ' ' << F.digits << ' ' << int(R);
            EXPECT_TRUE(first == second);  // as many bits drawn
        };
        same([](auto a, auto b) { return a + b; });
        same([](auto a, auto b) { return a - b; });
        same([](auto a, auto b) { return a * b; });
        same([](auto a, auto b) { return a / b; });
        same([](auto a, auto) { return sqrt(abs(a)); });
    }
}

TEST(RunTimeFormat, RoundsAsTheFormatThatIsCompiledIn) {
    expect_the_operations_of_chopped<binary16, Rounding::nearest>();
    expect_the_operations_of_chopped<binary16, Rounding::toward_zero>();
    expect_the_operations_of_chopped<binary16, Rounding::stochastic>();
    expect_the_operations_of_chopped<bfloat16, Rounding::nearest>();
    expect_the_operations_of_chopped<bfloat16, Rounding::stochastic>();
    expect_the_operations_of_chopped<Format{25, -400, 400}, Rounding::nearest>();
    expect_the_operations_of_chopped<Format{25, -400, 400}, Rounding::toward_zero>();
    expect_the_operations_of_chopped<Format{25, -400, 400}, Rounding::stochastic>();
}

TEST(RunTimeFormat, VariantsGiveTheBitsOfTheArithmeticThatIsCompiledIn) {
    for (auto const& [name, compiled] : {std::pair{"p8:-126:127", "bfloat16"},
                                         {"p8:-126:127:stochastic", "bfloat16-stochastic"},
                                         {"p11:-14:15", "binary16"},
                                         {"p11:-14:15:stochastic", "binary16-stochastic"}})
        for (CatalogueEntry const* const e : entries_in(arithmetic_named(name, "here"))) {
            CatalogueEntry const* const other = find_entry(e->variant, compiled);
            ASSERT_TRUE(other);
            EXPECT_EQ(e->arithmetic->name, name);
            EXPECT_EQ(e->arithmetic->stochastic, other->arithmetic->stochastic);
            Records const records = laws::noise_records(5, 60, Seed{4});  // rounded on the way
            auto const f = e->make(laws::problem(5, 0.96875), Seed{1}),
                       g = other->make(laws::problem(5, 0.96875), Seed{1});
            laws::process_rows(*f, records);
            laws::process_rows(*g, records);
            EXPECT_TRUE(laws::identical(f->stored(), g->stored())) << e->variant << ' ' << name;
            EXPECT_TRUE(laws::identical(f->theta(), g->theta())) << e->variant << ' ' << name;
        }
}

/// A block's reflections by panels, too, where the format's squares are in range, and where they are not.
template <Format F>
void expect_the_blocks_of_chopped() {
    auto const theta_of = [](auto one, double scale) {
        using T = decltype(one);
        QrBlock<T> f({.size = 10, .forgetting = T(1), .prior = std::nullopt});
        Seed seed{5};
        Matrix<T> const psi = Matrix<T>::NullaryExpr(10, 40, [&] { return T(scale * seed.bell()); });
        Vector<T> const y = Vector<T>::NullaryExpr(40, [&] { return T(scale * seed.bell()); });
        f.update_block(psi, y);
        std::vector<double> theta;
        for (T const& x : f.theta()) theta.push_back(double(x));
        return theta;
    };
    PrecisionScope const precision(RunTimeFormat{F});
    for (double scale : {0x1p-11, 1.0, 100.0}) {
        auto const expected = theta_of(Chopped<F>(1), scale);
        EXPECT_TRUE(std::isfinite(expected[0])) << scale;
        EXPECT_EQ(theta_of(VariablePrecision(1), scale), expected) << scale;
    }
}
TEST(RunTimeFormat, BlocksGiveTheBitsOfTheArithmeticThatIsCompiledIn) {
    expect_the_blocks_of_chopped<binary16>();
    expect_the_blocks_of_chopped<bfloat16>();
}

/// The stored numbers of qr after 40 rows.
template <class T>
Vector<double> stored_by_qr() {
    Records const records = laws::noise_records(3, 40, Seed{4});
    auto const stored = [](double x) { return T(x); };
    Qr<T> filter(laws::problem(3, 0.75).mapped<T>(stored));
    for (Index k = 0; k < records.rows(); ++k)
        filter.update(Vector<T>(records.psi.col(k).unaryExpr(stored)), T(records.y[k]));
    Vector<double> out(9);
    for (Index i = 0; i < 9; ++i) out[i] = double(filter.information()(i % 3, i / 3));
    return out;
}
TEST(RunTimeFormat, QrTakesTheSamePathWhereSubnormalNumbersBeginHigh) {
    constexpr Format F{11, -8, 15};  // -8 + 11 >= 0: errors are not relative
    Vector<double> const compiled = stored_by_qr<Chopped<F>>();
    PrecisionScope const precision(RunTimeFormat{F});
    EXPECT_EQ(compiled, stored_by_qr<VariablePrecision>());
    EXPECT_EQ(double(Eigen::NumTraits<VariablePrecision>::highest()), largest(F));
}

TEST(RunTimeFormat, AFilterKeepsTheFormatInWhichItWasMade) {
    Records const records = laws::noise_records(3, 40, Seed{4});
    auto const made = [&](char const* name) {
        return entries_in(arithmetic_named(name, ""))[0]->make(laws::problem(3, 0.96875), Seed{1});
    };
    auto const alone = made("p8");
    laws::process_rows(*alone, records);
    auto const f = made("p8"), other = made("p20");
    PrecisionScope const outside(5);
    for (Index k = 0; k < 40; ++k) {
        f->update(records.sample(k), records.y[k]);
        other->update(records.sample(k), records.y[k]);
    }
    EXPECT_EQ(PrecisionScope::bits(), 5);
    EXPECT_TRUE(laws::identical(f->stored(), alone->stored()));
    EXPECT_FALSE(laws::identical(f->stored(), other->stored()));
    std::vector<std::byte> const saved = f->saved();
    auto const loaded = made("p8");
    loaded->load(saved);
    EXPECT_TRUE(laws::identical(loaded->stored(), alone->stored()));
    for (char const* const wrong : {"p9", "p8:-126:127", "p8:-126:127:toward_zero"})
        EXPECT_THROW(made(wrong)->load(saved), InputError) << wrong;
}

TEST(RunTimeFormat, ANameThatIsNoneSaysWhatIsOne) {
    EXPECT_EQ(entries_at_run_time("ud", "--arithmetic"), nullptr);
    EXPECT_EQ(entries_at_run_time("p", "--arithmetic"), nullptr);
    EXPECT_EQ(entries_at_run_time("p011", "here")->front().arithmetic->name, "p11");
    EXPECT_EQ(entries_at_run_time("p11", "here"), entries_at_run_time("p11", "there"));
    for (char const* const wrong :
         {"p1", "p54", "p0", "p-3", "p11:", "p11:3", "p11::", "p11:-14:15:", "p11:-14:15:up",
          "p11:-14:15:stochastic:", "p26:-100:100", "p11:15:-14", "p11:-14:511", "p11:-600:15", "p2147483649",
          "p11:-14:99999999999", "p11.5", "p53:-1022:1023:stochastic", "p 11"})
        EXPECT_THROW(
            {
                if (!entries_at_run_time(wrong, "--arithmetic")) throw InputError("none");
            },
            InputError)
            << wrong;
}

}  // namespace
}  // namespace rlslab
