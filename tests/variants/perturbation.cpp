// A gain error reaches a filter or is refused; it is never ignored silently.
#include <rlslab/catalogue/catalogue.hpp>
#include "tests/common/laws.hpp"

#include <gmock/gmock.h>

namespace rlslab {
namespace {

/// theta and P after one row whose gain was `relative` off. Empty and the message where that is refused.
struct Answer {
    std::vector<double> numbers;
    std::string refusal;
};
Answer after(CatalogueEntry const& entry, double relative) {
    auto const f = entry.make(laws::problem(2), Seed{1});
    std::vector<double> const row{1.0, 2.0};
    Answer out;
    f->update(row, 1.0);
    try {
        f->update(std::vector<double>{2.0, -1.0}, 3.0, Vector<double>{{relative, -relative}});
    } catch (std::invalid_argument const& refused) {
        out.refusal = refused.what();
        return out;
    }
    for (Reference const& x : Vector<Reference>(f->theta())) out.numbers.push_back(double(x));
    Stored<double> const stored = f->stored_in_double();
    out.numbers.insert(out.numbers.end(), stored.F.reshaped().begin(), stored.F.reshaped().end());
    out.numbers.insert(out.numbers.end(), stored.D.begin(), stored.D.end());
    return out;
}

TEST(GainError, ReachesTheFilterOrIsRefused) {
    int taken = 0, refused = 0;
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double") continue;
        Answer const exact = after(entry, 0), off = after(entry, 0.25);
        if (entry.gain_perturbable) {
            ++taken;
            EXPECT_EQ(off.refusal, "") << entry.variant;
            EXPECT_NE(off.numbers, exact.numbers) << entry.variant << " dropped the error";
        } else {
            ++refused;
            EXPECT_THAT(off.refusal, testing::HasSubstr(std::string(entry.variant))) << entry.variant;
            EXPECT_EQ(off.refusal, exact.refusal) << "an error of zero is refused like any other";
        }
    }
    EXPECT_EQ(taken, 11);   // all that form a gain, or the vector that plays it
    EXPECT_GE(refused, 4);  // information, and what rotates or reflects rows into R
}

TEST(GainError, OfTheLastColumnReachesPOnlyWhereTheGainIsComputedAtOnce) {
    Matrix<double> relative = Matrix<double>::Zero(2, 2);
    relative.col(1) << 0.25, -0.25;
    int nothing = 0;
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double" || !entry.gain_perturbable) continue;
        auto const right = entry.make(laws::problem(2), Seed{1}), wrong = entry.make(laws::problem(2), Seed{1});
        std::vector<double> const row{2.0, -1.0};
        right->update(row, 3.0);
        wrong->update(row, 3.0, relative);
        EXPECT_FALSE(laws::identical(right->theta(), wrong->theta())) << entry.variant;
        nothing += laws::identical(right->stored(), wrong->stored());
    }
    EXPECT_EQ(nothing, 4);  // carlson, ud, inverse_qr, extended_qr
}

TEST(GainError, OfAnotherShapeIsRefused) {
    for (CatalogueEntry const& entry : catalogue()) {
        if (entry.arithmetic->name != "double" || !entry.gain_perturbable) continue;
        auto const f = entry.make(laws::problem(3), Seed{1});
        for (auto const& [rows, columns] : {std::pair<Index, Index>{2, 1}, {4, 1}, {3, 2}, {3, 0}, {0, 0}, {1, 3}})
            EXPECT_THROW(
                f->update(std::vector<double>{1.0, 2.0, 3.0}, 1.0, Matrix<double>(Matrix<double>::Zero(rows, columns))),
                std::invalid_argument)
                << entry.variant << " " << rows << " x " << columns;
    }
}

}  // namespace
}  // namespace rlslab
