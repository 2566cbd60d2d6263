// The row at which the stored P of the conventional form ends, foretold long before.
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/model/default_prior.hpp>
#include <rlslab/model/signals.hpp>
#include "src/lab/compare/score.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace rlslab {
using namespace compare;
namespace {

enum class Rows { white, coloured, graded };

Records rows_of(Rows kind, Index d, Index n, Seed seed) {
    Records out{.psi = Matrix<double>(d, n), .y = Vector<double>(n), .names = {}};
    for (Index i = 0; i < d; ++i) {
        Signal const x =
            kind == Rows::coloured ? coloured_noise(n, {-0.8}, Seed{seed.next()}) : white_noise(n, Seed{seed.next()});
        for (Index k = 0; k < n; ++k)
            out.psi(i, k) = kind == Rows::graded ? std::ldexp(x[size_t(k)], int(-2 * i)) : x[size_t(k)];
    }
    for (Index k = 0; k < n; ++k) out.y[k] = out.psi.col(k).sum() + 0.1 * seed.bell();
    return out;
}

struct Ends {
    Index broke = 0;                              ///< 0: it did not
    std::vector<std::optional<double>> foretold;  ///< of records that end at a quarter, a half, three quarters of (37)
};
/// One filter over the rows; at the end of each record it is asked what it would have been asked at 40 checkpoints.
Ends ends_of(std::string_view variant, std::string_view arithmetic, double lambda, Records const& rows, Index whole) {
    CatalogueEntry const* const entry = find_entry(variant, arithmetic);
    Problem<double> problem{.size = rows.parameters(), .forgetting = lambda};
    problem.prior =
        default_prior({.psi = rows.psi.leftCols(whole / 4), .y = rows.y.head(whole / 4), .names = {}}, lambda).prior();
    problem = as_stored(problem, *entry->arithmetic);
    auto const filter = entry->make(problem, Seed{1});
    std::vector<Foretold> records;
    std::vector<Index> length;
    for (Index quarter = 1; quarter <= 3; ++quarter)
        records.emplace_back(problem.forgetting, 40), length.push_back(whole * quarter / 4);
    Ends out{.broke = 0, .foretold = std::vector<std::optional<double>>(3)};
    for (Index k = 1; k <= rows.rows(); ++k) {
        Health const health = filter->update(rows.sample(k - 1), rows.y[k - 1]).health;
        if (breakdown(*filter, *entry->arithmetic, health) != Health::sound) {
            out.broke = k;
            return out;
        }
        for (size_t r = 0; r < 3; ++r) {
            for (Index c = 1; c <= 40; ++c)
                if (k == length[r] * c / 40) records[r].look(k, filter->stored());
            if (k == length[r]) out.foretold[r] = records[r].row();
        }
    }
    return out;
}

/// P = [1 1 + a/2; 1 - a/2 1], a = 2^-10 at row 10, divided by lambda = 1/2 at each row: a is 1 at row 20. From there
/// on no later row is foretold than the one looked at.
TEST(Foretold, AnAsymmetryOfOneAndMoreEndsAtOnce) {
    for (Index const last : {12, 19, 20, 25}) {
        Foretold of(0.5, 2);
        for (Index const row : {last - 1, last}) {
            double const half = std::ldexp(0.5, int(row) - 20);
            Matrix<Reference> P(2, 2);
            P << 1, 1 + half, 1 - half, 1;
            of.look(row, {Stored<Reference>::Quantity::covariance, Stored<Reference>::Form::plain, P});
        }
        ASSERT_TRUE(of.row()) << last;
        EXPECT_NEAR(*of.row(), double(std::max<Index>(last, 20)), 1e-9);
    }
}

TEST(Foretold, TheConventionalFormEndsNearTheRow) {
    std::vector<double> ratios;
    int runs = 0, broke = 0, asked = 0;
    for (Index const d : {3, 4, 8})
        for (double const lambda : {0.98, 0.99, 0.995, 0.999})
            for (char const* const arithmetic : {"float", "double"})
                for (Rows const kind : {Rows::white, Rows::coloured, Rows::graded}) {
                    double const u = arithmetic == std::string("float") ? 0x1p-24 : 0x1p-53;
                    Index const whole = Index(std::log(1 / u) / -std::log(lambda));  // docs/theory.md 37
                    Records const rows = rows_of(kind, d, 2 * whole, Seed{std::uint64_t(++runs)});
                    Ends const of = ends_of("conventional", arithmetic, lambda, rows, whole);
                    broke += of.broke > 0;
                    for (Index quarter = 1; quarter <= 3; ++quarter)
                        if (of.broke > whole * quarter / 4) {
                            ++asked;
                            if (auto const row = of.foretold[size_t(quarter - 1)])
                                ratios.push_back(double(of.broke) / *row);
                        }
                }
    std::ranges::sort(ratios);
    EXPECT_EQ(broke, runs);
    // Measured: 103 told of 110 asked, from 1.007 to 1.214, nine tenths of them up to 1.136 (docs/compare.md).
    EXPECT_GE(ratios.size(), 100u) << "of " << asked;
    EXPECT_GT(ratios.front(), 1.0);
    EXPECT_LT(ratios[size_t(0.9 * double(ratios.size() - 1))], 1.15);
    EXPECT_LT(ratios.back(), 1.25);
}

/// Forms whose P stays symmetric, or that damp what is not, are told nothing of.
TEST(Foretold, NothingIsToldOfFormsThatDampIt) {
    for (char const* const variant : {"conventional_two_sided", "symmetric", "joseph", "joseph_rank_two", "ud", "qr"})
        for (double const lambda : {0.98, 0.995, 0.999, 1.0})
            for (Index const n : {60, 300, 2000})
                for (char const* const arithmetic : {"float", "double"}) {
                    Ends const of = ends_of(variant, arithmetic, lambda, rows_of(Rows::white, 4, n, Seed{7}), n);
                    for (auto const& row : of.foretold)
                        EXPECT_FALSE(row)
                            << variant << ' ' << lambda << ' ' << n << ' ' << arithmetic << ' ' << row.value_or(0);
                }
}

}  // namespace
}  // namespace rlslab
