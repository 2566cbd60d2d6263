// What studies are made of. The families of variants that they compare are what their names say, by what the filters
// store; formulas of pages; the map of winners: its laws where they are known, and the statistics of its claims on a
// table that obeys the laws; the records of the survey.
#include "src/lab/report/page.hpp"
#include "studies/maps/winner_map.hpp"
#include "studies/published/data.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/studies/study.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
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

// --- the map of winners ----------------------------------------------------------------------------------------------

MapCell cell(int bits, double kappa, bool rotated, double c2 = 1, double rows = 1000) {
    return {bits, 1, rows, c2, 1e-3, {1, 1 / std::sqrt(kappa), 1 / kappa}, rotated, "generic"};
}

TEST(Map, TheErrorInUDependsOnNoWordWithoutDrift) {
    for (char const* const form : {"symmetric", "joseph", "information", "ud"}) {
        MapCell const of_float = cell(24, 100, true), of_double = cell(53, 100, true);
        EXPECT_DOUBLE_EQ(law_of(form, of_float).covariance / of_float.u(),
                         law_of(form, of_double).covariance / of_double.u())
            << form;
    }
}
TEST(Map, InUnitsTheConditionIsInNoErrorOfP) {
    for (std::string const& form : all_forms()) {
        if (form == "conventional" || form == "potter") continue;
        double const at_10 = law_of(form, cell(53, 10, false, 1e-6)).covariance,
                     at_1e6 = law_of(form, cell(53, 1e6, false, 1e-6)).covariance;
        EXPECT_NEAR(at_1e6 / at_10, 1, 1e-3) << form;
    }
}
TEST(Map, RotatedItIsInAStoredPAsItsSquareAndInAFactorOnce) {
    auto const grows = [](char const* form) {  // with P0 beyond kappa^2, so that the data decide
        double const N = 1e6, low = law_of(form, cell(53, 1e4, true, 1e9, N)).covariance,
                     high = law_of(form, cell(53, 1e5, true, 1e9, N)).covariance;
        return std::log10(high / low);
    };
    EXPECT_NEAR(grows("ud"), 1, 0.1);
    EXPECT_NEAR(grows("information"), 2, 0.1);
    EXPECT_NEAR(grows("symmetric"), 2, 0.1);
}
TEST(Map, DefinitenessEndsNearTheReciprocalOfU) {
    EXPECT_FALSE(law_of("symmetric", cell(24, 1, false, 0x1p20)).broken);
    EXPECT_TRUE(law_of("symmetric", cell(24, 1, false, 0x1p24)).broken);
    EXPECT_FALSE(law_of("ud", cell(24, 1, false, 0x1p60)).broken);
}

/// A line of cells in which every form keeps what the laws say, less `sabotage` digits of P in symmetric.
Table obedient(double sabotage) {
    std::vector<std::string> columns{"regime", "size",           "spectrum",       "theta",    "noise",
                                     "basis",  "prior_exponent", "kappa_exponent", "replicate"};
    size_t const factors = columns.size();
    for (std::string const& measure : map_measures()) columns.push_back(measure);
    Table out(columns);
    for (double const kappa : {0.0, 0.125, 0.25, 0.375, 0.5}) {
        std::vector<Cell> row{"float memory 100", 4.0, "geometric", "generic", 1e-3, "rotated", 0.5, kappa, 1.0};
        MapCell const at = map_cell([&](std::string_view name) -> Cell const& { return row[out.index(name)]; });
        for (std::string const& form : all_forms()) {
            MapLaw const law = law_of(form, at);
            double const broken = law.broken ? NAN : 0, less = form == "symmetric" ? sabotage : 0;
            for (double const error : {law.theta, law.theta, law.covariance})
                row.emplace_back(broken - std::log10(std::min(error, 1.0)) - less);
        }
        row.insert(row.end(), {"S", "F"});
        EXPECT_EQ(row.size(), factors + map_measures().size());
        out.add(row);
    }
    return out;
}
TEST(Map, ItsStatisticsAreOneWhereTheLawsHoldAndCanFail) {
    Table const good = obedient(0), bad = obedient(4);
    for (Statistic const& statistic : {boundaries_foretold(0.01), family_foretold(all_forms()),
                                       family_foretold(plain_forms()), loss_foretold("symmetric", 1e-6)})
        EXPECT_EQ(statistic(good), 1);
    EXPECT_EQ(loss_foretold("symmetric", 0.5)(bad), 0);
    EXPECT_GT(largest_loss("symmetric", all_forms())(bad), 3);
    EXPECT_GT(cells_lost("symmetric", all_forms(), 3)(bad), cells_lost("symmetric", all_forms(), 3)(good));
}

// The records of the survey: the list, those in the program, their scaling; and one line where the others are not.
using namespace studies::survey_data;

std::vector<std::string> records_of_study(Budget budget) {
    std::vector<std::string> out;
    for (Study const* study : studies::studies()) {
        if (study->name != "survey") continue;
        std::vector<Factor> const factors = study->factors(budget);
        for (Cell const& record : factors.front().values) out.push_back(std::get<std::string>(record));
    }
    return out;
}

TEST(Survey, UsesEachRecordOnce) {
    std::vector<std::string> const all = used();
    EXPECT_EQ(all.size(), 326u);
    EXPECT_EQ(std::set<std::string>(all.begin(), all.end()).size(), all.size());
    EXPECT_EQ(records_of_study(Budget::full).size(), 109u);
}
TEST(Survey, HasTheQuickBudgetsRecordsInTheProgramWithTheRowsOfTheList) {
    std::string const list(file("records.csv"));
    EXPECT_THAT(records_of_study(Budget::quick),
                testing::UnorderedElementsAre("NIST.longley", "statsmodels.danish_data", "statsmodels.elnino",
                                              "statsmodels.statecrime", "statsmodels.strikes"));
    for (std::string const& name : records_of_study(Budget::quick)) {
        Records const records = records_of(name);
        std::size_t const at = list.find("\n" + name + ",");
        ASSERT_NE(at, list.npos) << name;
        std::string const line = list.substr(at + 1, list.find('\n', at + 1) - at - 1);
        EXPECT_NE(line.find("," + std::to_string(records.rows()) + "," + std::to_string(records.parameters()) + ","),
                  line.npos)
            << line;
    }
}
TEST(Survey, ScalesColumnsAndLeavesTheConstant) {
    Records const records = scaled(records_of("NIST.longley"));
    EXPECT_TRUE((records.psi.row(0).array() == 1).all());
    for (Index i = 1; i < records.parameters(); ++i) {
        EXPECT_NEAR(records.psi.row(i).mean(), 0, 1e-13);
        EXPECT_NEAR(records.psi.row(i).squaredNorm(), double(records.rows() - 1), 1e-12);
    }
    double const mean = records.y.mean();
    EXPECT_NEAR((records.y.array() - mean).matrix().squaredNorm(), double(records.rows() - 1), 1e-10);
    EXPECT_GT(mean, 1) << "y keeps its mean";
    EXPECT_EQ(first_half(records).rows(), 8);
}
TEST(Survey, SaysInOneLineThatTheOtherRecordsAreNotThere) {
    unsetenv("RLSLAB_RECORDS");
    EXPECT_THAT([] { records_of("MASS.hills"); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("RLSLAB_RECORDS=FOLDER")));
    setenv("RLSLAB_RECORDS", "/nowhere", 1);
    EXPECT_THAT([] { records_of("MASS.hills"); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("/nowhere/MASS.hills.csv")));
    unsetenv("RLSLAB_RECORDS");
}

}  // namespace
}  // namespace rlslab
