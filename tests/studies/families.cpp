// The families of variants that studies compare are what their names say: by what the filters store.
#include "src/lab/report/page.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/study.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

namespace rlslab {

using namespace studies;
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Quantity = Stored<double>::Quantity;
using Form = Stored<double>::Form;

Stored<double> stored_by(std::string const& variant) {
    auto const filter = find_entry(variant)->make({.size = 3}, Seed{1});
    Records const records = white(3, 10, Seed{2});
    for (Index k = 0; k < records.rows(); ++k) filter->update(records.sample(k), records.y[k]);
    return filter->stored_in_double();
}
bool is_triangular(Matrix<double> const& F) { return F.isUpperTriangular(0) || F.isLowerTriangular(0); }

/// Those for which `holds` does not.
std::vector<std::string> misfits(std::vector<Cell> const& family, bool (*holds)(Stored<double> const&)) {
    std::vector<std::string> out;
    for (std::string const& variant : words(family))
        if (!holds(stored_by(variant))) out.push_back(variant);
    return out;
}

TEST(Families, StoreWhatTheirNamesSay) {
    auto const plain_P = [](Stored<double> const& s) {
        return s.quantity == Quantity::covariance && s.form == Form::plain;
    };
    auto const factor = [](Stored<double> const& s) { return s.form == Form::factor; };
    auto const triangle = [](Stored<double> const& s) { return s.form == Form::factor && is_triangular(s.F); };
    auto const of_P = [](Stored<double> const& s) { return s.quantity == Quantity::covariance; };
    EXPECT_THAT(misfits(covariance_forms(), plain_P), IsEmpty());
    EXPECT_THAT(misfits(factor_forms(), factor), IsEmpty());
    EXPECT_THAT(misfits(triangular_forms(), triangle), IsEmpty());
    EXPECT_THAT(misfits(corrected_forms(), of_P), IsEmpty());
    // The check sees what does not belong.
    EXPECT_THAT(misfits(factor_forms(), triangle), ElementsAre("potter"));
    EXPECT_THAT(misfits(row_forms(), factor),
                testing::ElementsAreArray(words(joined(covariance_forms(), {"information"}))));
}
TEST(Families, AreOfEveryArithmeticAndTakeRowsOneByOne) {
    std::set<std::string> seen;
    for (std::string const& variant : words(row_forms())) {
        EXPECT_TRUE(seen.insert(variant).second) << variant << " is there twice";
        for (Arithmetic const& arithmetic : arithmetics()) {
            CatalogueEntry const* const entry = find_entry(variant, arithmetic.name);
            ASSERT_TRUE(entry) << variant << " in " << arithmetic.name;
            EXPECT_EQ(entry->block, 1) << variant;
        }
    }
    EXPECT_EQ(find_entry("qr_sparse", "float"), nullptr);
    EXPECT_EQ(find_entry("no such variant"), nullptr);
}
TEST(Families, NoDenseVariantIsMissing) {
    std::vector<std::string> const all = words(row_forms());
    for (VariantForm const& f : variant_forms())
        EXPECT_EQ(std::ranges::count(all, f.variant),
                  f.single_rows && f.variant != "kalman" && !f.variant.ends_with("_delta"))
            << f.variant;
    std::set<std::pair<int, int>> looks;
    for (auto const* const entry : one_entry_each())
        EXPECT_TRUE(looks.insert({entry->family.kind, entry->family.place}).second)
            << entry->variant << " looks like another";
}
TEST(Families, LessSomeIsTheRestInItsOrder) {
    EXPECT_EQ(without({"c", "a", "b"}, {"a", "z"}), (std::vector<Cell>{"c", "b"}));
    EXPECT_EQ(without({}, {"a"}), std::vector<Cell>{});
}
TEST(Families, AnEntryIsFoundInAnyList) {
    for (CatalogueEntry const& entry : catalogue())
        EXPECT_EQ(find_entry(entry.variant, entry.arithmetic->name), &entry);
    std::vector<CatalogueEntry const*> const each = one_entry_each();
    std::set<std::string_view> variants;
    for (CatalogueEntry const* const entry : each) EXPECT_TRUE(variants.insert(entry->variant).second);
    for (CatalogueEntry const& entry : catalogue()) EXPECT_TRUE(variants.contains(entry.variant));
}

// Formulas of pages: MathML where pandoc was there when the program was built, and text that can be read elsewhere.
using namespace report;

TEST(Formulas, OfEveryStudyAreMathML) {
    for (Study const* study : studies::studies()) {
        if (study->formula.empty()) continue;
        EXPECT_EQ(study->formula.find('"'), std::string::npos)
            << study->name << ": a string's quotes inside the formula";
        EXPECT_EQ(std::ranges::count(study->formula, '{'), std::ranges::count(study->formula, '}')) << study->name;
        std::string const text = readable(study->formula);
        EXPECT_EQ(text.find_first_of("\\{}&\n"), std::string::npos) << study->name << ": " << text;
        if (has_mathml()) {
            EXPECT_TRUE(mathml(study->formula).starts_with("<math"))
                << study->name << ": pandoc does not understand it, or it is not marked R\"tex(...)tex\"";
        }
    }
}
TEST(Formulas, WithoutATypesetterAreReadable) {
    EXPECT_EQ(readable(R"(P_k = \frac{1}{\lambda}(I - K\psi^\top) P_{k-1})"), "P_k = 1/λ(I - Kψᵀ) P_(k-1)");
    EXPECT_EQ(readable(R"(\sqrt{1 + x} \le \|\hat\theta\|_2 \\ \mathrm{fl}(a) \neq 0)"),
              "√(1 + x) ≤ ‖θ̂‖_2 ;  fl(a) ≠ 0");
    EXPECT_EQ(readable("\\frac{"), "/");
    EXPECT_EQ(readable("}}a^"), "a^");
    EXPECT_EQ(readable("\\"), "");
    EXPECT_THAT(formula_html("a < b \\unknown"), testing::HasSubstr("<code>a &lt; b unknown</code>"));
}

}  // namespace
}  // namespace rlslab
