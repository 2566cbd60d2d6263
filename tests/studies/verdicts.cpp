// Claims and their record: every claim says what it is; a verdict that changes is seen, and so is a verification that
// fails.
#include <rlslab/studies/report.hpp>
#include <rlslab/studies/verdicts.hpp>
#include "tests/common/files.hpp"

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace rlslab {
using namespace report;
using namespace studies;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Claims, EachSaysWhatItIsWhereItsBandIsFromAndOnWhichData) {
    std::set<std::string> texts;
    for (Study const* study : studies::studies()) {
        EXPECT_FALSE(study->data.empty()) << study->name;
        EXPECT_FALSE(study->claims.empty()) << study->name;
        for (Claim const& claim : study->claims) {
            EXPECT_FALSE(claim.text.empty()) << study->name;
            EXPECT_FALSE(claim.basis.band.empty()) << study->name << ": " << claim.text;
            EXPECT_TRUE(texts.insert(study->name + claim.text).second) << study->name << " says twice: " << claim.text;
        }
    }
}
TEST(Claims, EachIsInTheRecordOfTheQuickBudget) {
    std::vector<Outcome> all;
    for (Study const* study : studies::studies()) all.push_back({study, {}, {}, {}, 0, 0});
    EXPECT_THAT(unrecorded(all, recorded(Budget::quick)), IsEmpty())
        << "rlslab study NAME --record studies/verdicts.json";
}

Study of_three(char const* name = "three") {
    auto const any = [](Table const&) { return Judgement(true, ""); };
    return {.name = name,
            .question = "?",
            .source = "s",
            .formula = "",
            .interpretation = "",
            .data = "none",
            .factors = {},
            .measures = {},
            .measure = {},
            .plots = {},
            .claims = {{"a <law>", any, verification("docs/theory.md 1")},
                       {"a number", any, reproduction("a table", "the table's data")},
                       {"ours", any, own_result("set before the run")}}};
}
Outcome outcome(Study const& study, Verdict a, Verdict b, Verdict c) {
    return {&study, {}, {{a, "1"}, {b, "2", 0.001}, {c, "3", 0.001}}, {}, 0, 0};
}
constexpr Verdict yes = Verdict::holds, no = Verdict::fails, unknown = Verdict::undecided;
Record const record{{"three", {{"a <law>", yes}, {"a number", no}, {"ours", unknown}}}};

TEST(Verdicts, AreCountedByKind) {
    Study const study = of_three();
    std::vector<Outcome> const outcomes{outcome(study, yes, no, unknown), outcome(study, yes, yes, unknown)};
    auto const [verified, reproduced, found] = counted(outcomes);
    EXPECT_EQ(verified.holds, 2u);
    EXPECT_EQ(reproduced.fails, 1u);
    EXPECT_EQ(reproduced.holds, 1u);
    EXPECT_EQ(found.undecided, 2u);
    EXPECT_EQ(count_lines(outcomes),
              "verified      2: 2 hold, 0 fail, 0 undecided\n"
              "reproduced    2: 1 hold, 1 fail, 0 undecided\n"
              "found         2: 0 hold, 0 fail, 2 undecided\n");
    EXPECT_NEAR(expected_errors(outcomes), 0.004, 1e-15);
    EXPECT_EQ(verdicts_csv({outcomes[0]}),
              "study,kind,hold,fail,undecided\nthree,verification,1,0,0\nthree,reproduction,0,1,0\n"
              "three,finding,0,0,1\n");
    auto const json = nlohmann::json::parse(verdicts_json(outcomes, {}));
    EXPECT_EQ(json["reproduction"]["fail"], 1);
    EXPECT_EQ(json["studies"][0]["claims"][1]["data"], "the table's data");
    EXPECT_EQ(json["studies"][0]["claims"][0]["data"], "none") << "the study's, where the claim has none";
    EXPECT_EQ(json["studies"][0]["claims"][2]["verdict"], "undecided");
}
TEST(Verdicts, FailuresAreListedFirst) {
    Study const study = of_three();
    std::string const lines = verdict_lines(outcome(study, yes, no, unknown), false),
                      page = report_html({outcome(study, yes, no, unknown)}, {});
    std::istringstream folded(verdict_lines(outcome(study, yes, no, unknown), false, 44));
    std::string line;
    std::getline(folded, line);  // the study's question
    while (std::getline(folded, line)) EXPECT_LE(line.size(), 44u) << line;
    EXPECT_LT(lines.find("FAILS      reproduction  a number"), lines.find("undecided  finding       ours"));
    EXPECT_LT(lines.find("undecided"), lines.find("holds      verification"));
    EXPECT_LT(page.find("What fails"), page.find("What is undecided"));
    EXPECT_LT(page.find("a number"), page.find("ours"));
    EXPECT_LT(page.find("ours"), page.find("a &lt;law&gt;"));
    EXPECT_THAT(page, HasSubstr("expected to be wrong"));
    EXPECT_THAT(
        page,
        HasSubstr("Of the findings 1 say that the band was set before the run, 0 that a result had been seen by then"));
}
TEST(Verdicts, AChangeIsSeenAndAFindingThatFailsAsRecordedIsNone) {
    Study const study = of_three();
    EXPECT_THAT(changes({outcome(study, yes, no, unknown)}, record), IsEmpty());
    EXPECT_THAT(changes({outcome(study, yes, yes, unknown)}, record),
                ElementsAre("three: a number: holds, fails in the record"));
    EXPECT_THAT(changes({outcome(study, yes, no, no)}, record),
                ElementsAre("three: ours: fails, undecided in the record"));
    EXPECT_THAT(failed_verifications({outcome(study, yes, no, no)}), IsEmpty());
    EXPECT_THAT(failed_verifications({outcome(study, no, yes, yes)}), ElementsAre("three: a <law>: 1"));
}
TEST(Verdicts, WhatIsNotRecordedIsNoChangeAndIsSaid) {
    Study const study = of_three(), other = of_three("other");
    EXPECT_THAT(changes({outcome(other, no, no, no)}, record), IsEmpty());
    EXPECT_EQ(unrecorded({outcome(other, no, no, no)}, record).size(), 3u);
    Record const longer{{"three", {{"a <law>", yes}, {"a number", no}, {"ours", unknown}, {"an old one", yes}}}};
    EXPECT_THAT(unrecorded({outcome(study, yes, yes, yes)}, longer),
                ElementsAre("three: an old one: in the record, no longer claimed"));
}
std::string page(std::string const& name) { return files::read(RLSLAB_SOURCE_DIR + name); }
/// The words of a page, a blank behind each.
std::string words_of(std::string const& name) {
    std::istringstream in(page(name));
    std::string text, word;
    while (in >> word) text += word + ' ';
    return text;
}
/// "| finding | 120 | 80 | 10 | 30 |" for each kind, and "34 studies with 219 claims", as they are recorded for the
/// quick budget.
TEST(Verdicts, AreThoseThatTheQuestionsCount) {
    std::array<Count, 3> counts;
    size_t claims = 0;
    for (Study const* study : studies::studies())
        for (Claim const& claim : study->claims) {
            auto const& verdicts = recorded(Budget::quick);
            auto const of_study = verdicts.find(study->name);
            if (of_study == verdicts.end() || !of_study->second.contains(claim.text)) {
                ADD_FAILURE() << study->name << ": not recorded; rlslab study " << study->name
                              << " --record studies/verdicts.json";
                return;
            }
            Verdict const verdict = of_study->second.at(claim.text);
            Count& c = counts[size_t(claim.basis.kind)];
            ++(verdict == yes ? c.holds : verdict == no ? c.fails : c.undecided), ++claims;
        }
    std::string const text = page("/docs/questions.md");
    EXPECT_THAT(text, HasSubstr("runs " + std::to_string(studies::studies().size()) + " studies with " +
                                std::to_string(claims) + " claims"));
    for (Kind const kind : {Kind::verification, Kind::reproduction, Kind::own_result}) {
        Count const& c = counts[size_t(kind)];
        std::ostringstream row;
        row << "| " << name_of(kind) << " | " << c.claims() << " | " << c.holds << " | " << c.fails << " | "
            << c.undecided << " |";
        EXPECT_THAT(text, HasSubstr(row.str()));
    }
}
/// Empty for a study that has not been run at the full budget.
std::map<std::string, Verdict> at_full_budget(Study const& study) {
    auto const of_study = recorded(Budget::full).find(study.name);
    return of_study == recorded(Budget::full).end() ? std::map<std::string, Verdict>{} : of_study->second;
}
/// By kind in docs/questions.md: "14, 0, 0, then 30, 3, 4, then 157, 47, 81 at seed 1". In README: "Of our 185
/// predictions that were registered before a run 87 hold, 38 fail and 60 are undecided", findings whose band was set
/// before a run and not moved after it. A claim that the record of the full budget does not have is not counted.
TEST(Verdicts, OfTheFullBudgetAreThoseThatReadmeAndQuestionsCount) {
    Count registered;
    std::array<Count, 3> kinds;
    auto const add = [](Count& to, Verdict v) { ++(v == yes ? to.holds : v == no ? to.fails : to.undecided); };
    for (Study const* study : studies::studies()) {
        auto const verdicts = at_full_budget(*study);
        for (Claim const& claim : study->claims) {
            auto const verdict = verdicts.find(claim.text);
            if (verdict == verdicts.end()) continue;
            std::string const& band = claim.basis.band;
            bool const before = band.find("before ") != band.npos && band.find("after") == band.npos;
            add(kinds[size_t(claim.basis.kind)], verdict->second);
            if (claim.basis.kind == Kind::own_result && before) add(registered, verdict->second);
        }
    }
    std::ostringstream readme, questions;
    readme << "Of our " << registered.claims() << " predictions that were registered before a run " << registered.holds
           << " hold, " << registered.fails << " fail and " << registered.undecided << " are undecided";
    for (Count const& c : kinds)
        questions << (&c == &kinds[0] ? "" : ", then ") << c.holds << ", " << c.fails << ", " << c.undecided;
    EXPECT_THAT(words_of("/README.md"), HasSubstr(readme.str()));
    EXPECT_THAT(words_of("/docs/questions.md"), HasSubstr(questions.str() + " at seed 1"));
}
/// A claim is fixed before its run: its words do not say what came out.
TEST(Verdicts, AreNotInTheWordsOfAClaim) {
    auto const says_its_outcome = [](std::string const& text) {
        for (char const* verdict : {"(fails", "(failed", "(holds", "(held", "(undecided"})
            if (text.find(verdict) != text.npos) return true;
        return false;
    };
    EXPECT_TRUE(says_its_outcome("P drifts (fails: part of the run lies before it)"));
    for (Study const* study : studies::studies())
        for (Claim const& claim : study->claims) EXPECT_FALSE(says_its_outcome(claim.text)) << claim.text;
}
/// Claims that are not in the full record, new or in other words, are named in one place.
TEST(Verdicts, ClaimsRestatedSinceTheFullRecordAreNamed) {
    std::string const text = words_of("/docs/questions.md");
    for (Study const* study : studies::studies())
        for (Claim const& claim : study->claims)
            if (!at_full_budget(*study).contains(claim.text)) {
                EXPECT_THAT(text, HasSubstr("- `" + study->name + "`: " + claim.text))
                    << "new, or restated: a line of docs/questions.md names it until the next full record";
            }
}
TEST(Verdicts, ARecordReadsBackAndKeepsWhatWasNotRun) {
    Study const* const study = studies::studies().front();
    Outcome all{study, {}, {}, {}, 0, 0};
    for (size_t i = 0; i < study->claims.size(); ++i) all.judgements.emplace_back(i % 2 ? no : unknown, "");
    Study const* const other = studies::studies().back();
    Record const old{{other->name, {{other->claims[0].text, no}, {"a claim that is no more", yes}}}};
    Record const read = record_from(record_json({all}, old));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read.at(study->name).size(), study->claims.size());
    EXPECT_EQ(read.at(study->name).at(study->claims[0].text), unknown);
    EXPECT_EQ(read.at(other->name), (std::map<std::string, Verdict>{{other->claims[0].text, no}}));
}
TEST(Verdicts, ARecordThatIsNoneIsRefused) {
    for (char const* text : {"", "{", "[]x", "{\"a\": 1}", "{\"a\": {\"b\": \"perhaps\"}}", "{\"a\": {\"b\": 1}}"})
        EXPECT_THROW(record_from(text), InputError) << text;
    EXPECT_TRUE(record_from("{}").empty());
}

}  // namespace
}  // namespace rlslab
