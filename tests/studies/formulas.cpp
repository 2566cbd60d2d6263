// Formulas of pages: MathML where pandoc was there when the program was built, and text that can be read elsewhere.
#include "src/lab/report/page.hpp"
#include <rlslab/studies/study.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rlslab {
using namespace report;
using namespace studies;
namespace {

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
