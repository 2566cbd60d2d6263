// The manners of the program: what it says to who mistypes, closes its pipe, interrupts it, or asks for help.
#include "program.hpp"

#include <rlslab/model/suggestion.hpp>

namespace {

using testing::HasSubstr;
using testing::Not;

// ---- did you mean -----------------------------------------------------------------------------------------------------------

TEST_F(Program, NamesTheCommandOptionVariantArithmeticStudyOrColumnThatWasMeant) {
    refused("compair ok.csv", "no command \"compair\" (did you mean \"compare\"?)");
    refused("stduy --all", "no command \"stduy\" (did you mean \"study\"?)");
    refused("compare ok.csv --input u --ouptut y --order 1", "no option \"--ouptut\" (did you mean \"--output\"?)");
    refused("compare ok.csv --input=u --ouptut=y --order 1", "no option \"--ouptut\" (did you mean \"--output\"?)");
    refused("compare ok.csv --threats 1", "no option \"--threats\" (did you mean \"--threads\"?)");
    refused("study gain_error --buget full", "no option \"--buget\" (did you mean \"--budget\"?)");
    refused("--versoin", "no option \"--versoin\" (did you mean \"--version\"?)");
    std::string const model = "ok.csv --input u --output y --order 1";
    refused("compare " + model + " --variants ud,jospeh", "--variants: no variant \"jospeh\" (did you mean \"joseph\"?)");
    refused("compare " + model + " --arithmetic doubel", "--arithmetic: no arithmetic \"doubel\" (did you mean \"double\"?)");
    refused("compare ok.csv --input U --output y --order 1", "no column \"U\" (did you mean \"u\"?)");
    refused("identify " + model + " --variant extended", "--variant: no variant \"extended\" (did you mean \"extended_qr\"?)");
    refused("study gain_memory", "study: no study \"gain_memory\"");
}
TEST(Suggestion, IsTheNearestNameOrNone) {
    std::vector<std::string_view> const names{"conventional", "joseph", "qr", "ud", "extended_qr", ""};
    auto const meant = [&](std::string_view asked) { return std::string(rlslab::nearest(asked, names)); };
    EXPECT_EQ(meant("josephs"), "joseph");
    EXPECT_EQ(meant("jsoeph"), "joseph") << "two letters swapped are one mistake";
    EXPECT_EQ(meant("jo"), "joseph") << "begins one name";
    EXPECT_EQ(meant("JOSEPH"), "joseph");
    EXPECT_EQ(meant("ux"), "") << "half of the word is wrong";
    EXPECT_EQ(meant("x"), "");
    EXPECT_EQ(meant(""), "");
    EXPECT_EQ(meant(std::string(1000000, 'j')), "");
    EXPECT_EQ(rlslab::nearest("gain", {"gain_error", "gain_error_memory"}), "") << "begins two names";
    EXPECT_EQ(rlslab::nearest("gain_eror", {}), "");
}

}  // namespace
