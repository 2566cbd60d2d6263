// Variants in formats that are chosen at run time, against those of the hardware and those that are compiled in. (The
// operations are tested in tests/arithmetic/rounded.cpp.)
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/qr_block.hpp>
#include <rlslab/variants/qr.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

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
    EXPECT_THROW(PrecisionScope const scope(1), std::invalid_argument);
    EXPECT_THROW(PrecisionScope const scope(54), std::invalid_argument);
}

void expect_the_bits_of(CatalogueEntry const* other, CatalogueEntry const& e, Records const& records) {
    ASSERT_TRUE(other) << e.variant;
    auto const f = e.make(laws::problem(5, 0.96875), Seed{1}), g = other->make(laws::problem(5, 0.96875), Seed{1});
    laws::process_rows(*f, records);
    laws::process_rows(*g, records);
    EXPECT_TRUE(laws::identical(f->stored(), g->stored())) << e.variant << ' ' << other->arithmetic->name;
    EXPECT_TRUE(laws::identical(f->theta(), g->theta())) << e.variant << ' ' << other->arithmetic->name;
}
/// Of double and float, where kernels run.
TEST(VariablePrecision, VariantsGiveTheBitsOfTheHardware) {
    for (auto const& [bits, name] : {std::pair{53, "double"}, std::pair{24, "float"}})
        for (CatalogueEntry const& e : variable_precision_catalogue()) {
            PrecisionScope const precision(bits);
            CatalogueEntry const* const other = find_entry(e.variant, name);
            expect_the_bits_of(other, e, as_stored(laws::noise_records(5, 60, Seed{4}), *other->arithmetic));
        }
}
TEST(RunTimeFormat, VariantsGiveTheBitsOfTheArithmeticThatIsCompiledIn) {
    for (auto const& [name, compiled] : {std::pair{"p8:-126:127", "bfloat16"},
                                         {"p8:-126:127:stochastic", "bfloat16-stochastic"},
                                         {"p11:-14:15", "binary16"},
                                         {"p11:-14:15:stochastic", "binary16-stochastic"}})
        for (CatalogueEntry const& e : *entries_at_run_time(name, "here")) {
            CatalogueEntry const* const other = find_entry(e.variant, compiled);
            EXPECT_EQ(e.arithmetic->name, name);
            EXPECT_EQ(e.arithmetic->stochastic, other->arithmetic->stochastic);
            expect_the_bits_of(other, e, laws::noise_records(5, 60, Seed{4}));  // rounded on the way
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
