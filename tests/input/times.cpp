// Cells that are times, and columns of them.
#include "tests/common/files.hpp"

#include <rlslab/input/times.hpp>

#include <fmt/format.h>

#include <cmath>

namespace rlslab {
namespace {

TEST(Times, AreNumbersOrAsPeopleWriteThem) {
    EXPECT_EQ(time_in("12.5"), 12.5);
    EXPECT_TRUE(std::isnan(time_in("").value()));
    EXPECT_EQ(time_in("1970-01-02"), 86400);
    EXPECT_EQ(time_in("2024-02-29 00:00:00").value() + 86400, time_in("2024-03-01 00:00:00"));
    EXPECT_EQ(time_in("1970-01-01T01:02:03.25Z"), 3723.25);
    for (char const* const zone : {"+02:00", "+0200", "+02", " +0200"})
        EXPECT_EQ(time_in(std::string("1970-01-01 01:02:03") + zone), 3723 - 7200) << zone;
    EXPECT_EQ(time_in("1970-01-01T01:02-03:30"), 3720 + 12600);
    EXPECT_EQ(time_in("2024-10-27 02:55:00+02:00").value() + 420, time_in("2024-10-27 02:02:00+01:00"));
    EXPECT_EQ(time_in("1970-01-01T00:00:01,250"), 1.25);
    EXPECT_EQ(time_in("17.05.2024 06:00:00"), time_in("2024-05-17 06:00"));
    EXPECT_EQ(time_in("2024/05/17 06:00"), time_in("2024-05-17 06:00"));
    EXPECT_EQ(time_in("01:02"), 3720);
    EXPECT_EQ(time_in("23:59:60"), 86400) << "a leap second";
    for (char const* const other : {"soon",
                                    "2023-02-29",
                                    "2024-13-01",
                                    "2024-02-28x",
                                    "25:00",
                                    "01:60",
                                    "01:02:",
                                    "01:02:70",
                                    "1:2",
                                    "01:02:3x",
                                    "2024-02-28 ",
                                    "-5:00",
                                    "2024-10-27 00:00Zfoo",
                                    "2024-10-27 00:00+",
                                    "2024-10-27 00:00+2",
                                    "06:00-07:00",
                                    "2024-10-27 00:00+15",
                                    "2024-10-27 00:00+02:0",
                                    "2024-10-27 00:00+02:00x",
                                    "01:02:3e1",
                                    "01:02:03,4,5"})
        EXPECT_EQ(time_in(other), std::nullopt) << other;
}
TEST(Times, HaveTheNamesThatPeopleGive) {
    for (char const* const name : {"t", "T", "time", "Time [s]", "time(ms)", "timestamp", "Zeit", "DATE", "t (s)"})
        EXPECT_TRUE(named_as_time(name)) << name;
    for (char const* const name : {"", "u", "temperature", "torque", "timer", "2", "_t", "today"})
        EXPECT_FALSE(named_as_time(name)) << name;
}
std::optional<std::string> said(std::vector<double> const& times, std::string const& name = "t") {
    Columns data{.file = "f"};
    data.time = name, data.times = times;
    return sentence_on_times(data);
}
/// What counts evenly says nothing, nor what does not count.
TEST(Times, ThatCountEvenlyOrNotAtAllSayNothing) {
    std::vector<double> even, third, values, levels;
    for (int k = 0; k < 200; ++k) {
        even.push_back(1e9 + 0.01 * k), third.push_back(std::round(100.0 / 3 * k) / 100);
        values.push_back(std::fmod(k * 0.618033988749895, 1)), levels.push_back(k % 7);
    }
    EXPECT_EQ(said(even), std::nullopt);
    EXPECT_EQ(said(third), std::nullopt) << "0.33 0.67 1";
    EXPECT_EQ(said(levels), std::nullopt);
    EXPECT_EQ(said({1, 2, 3, 5, 9}), std::nullopt) << "too few";
    even.erase(even.begin() + 50, even.begin() + 60);
    EXPECT_TRUE(said(even).has_value());
    std::swap(even[3], even[90]);
    EXPECT_TRUE(said(even, "u").has_value()) << "the first column, nearly in order";
    for (size_t k = 0; k + 1 < even.size(); k += 2) std::swap(even[k], even[(k * 37) % even.size()]);
    EXPECT_EQ(said(even, "u"), std::nullopt) << "another column, in no order";
    EXPECT_TRUE(said(even, "t").has_value());
}
/// Runs of one step after another.
std::vector<double> counted(std::vector<std::pair<int, double>> const& runs) {
    std::vector<double> out{0};
    for (auto const& [n, step] : runs)
        for (int k = 0; k < n; ++k) out.push_back(out.back() + step);
    return out;
}
/// In order of their times, or why not.
std::string ordered(std::vector<double> times) {
    Columns data{.file = "f", .names = {"y"}, .values = {{}}};
    for (size_t k = 0; k < times.size(); ++k) data.values[0].push_back(double(k)), data.lines.push_back(long(k) + 2);
    data.time = "t", data.times = std::move(times);
    return files::message_of([&] { in_order_of_time(data, 1000); });
}
TEST(Times, AreEvenlyApartOrItIsSaid) {
    std::vector<double> const two_rates = counted({{500, 2}, {490, 1}});
    EXPECT_THAT(said(two_rates).value(), Names("t: 490 shorter 2"));
    EXPECT_THAT(said(counted({{400, 2}, {600, 1}})).value(), Names("t: 400 longer 1 --time t"));
    EXPECT_THAT(ordered(two_rates), Names("f t 2 490 line 503"));
    EXPECT_EQ(ordered(counted({{400, 2}, {600, 1}})), "no error") << "whole steps";
    EXPECT_THAT(said(counted({{50, 1}, {3, 0.4}, {50, 1}})).value(), Names("t: 3 shorter 1 --time t"));
    EXPECT_EQ(ordered(counted({{50, 1}, {3, 0.4}, {50, 1}})), "no error") << "a few";
    std::vector<double> jitter, uneven, rounded;
    for (int k = 0; k < 200; ++k) {
        double const by = std::fmod(k * 0.618033988749895, 1) - 0.5;
        jitter.push_back(k + 0.09 * by), uneven.push_back(k + 0.8 * by);
        rounded.push_back(1.7e9 + std::floor(2.5 * k) / 1000);  // 400 Hz in ms
    }
    EXPECT_EQ(said(jitter), std::nullopt);
    EXPECT_EQ(ordered(jitter), "no error");
    EXPECT_EQ(said(rounded), std::nullopt);
    EXPECT_EQ(ordered(rounded), "no error");
    EXPECT_THAT(said(uneven).value(), Names("t: median refuses"));
    EXPECT_EQ(said(uneven, "u"), std::nullopt);
    EXPECT_THAT(ordered(uneven), Names("f t whole line"));
}
TEST(Times, OfRowsThatStandTwiceAreSaidInAColumnCalledSo) {
    std::vector<double> twice;
    for (int k = 0; k < 200; ++k) twice.push_back(k / 2);
    EXPECT_THAT(said(twice).value(), Names("t: 100 rows --time t"));
    EXPECT_EQ(said(twice, "u"), std::nullopt);
    Columns days{.file = "f", .names = {"y"}, .values = {{}}};
    days.time = "date", days.times = twice;
    for (int k = 0; k < 200; ++k) days.values[0].push_back(k);
    EXPECT_EQ(sentence_on_times(days), std::nullopt) << "days, whose hours are elsewhere";
}
Columns read(std::string const& text, std::string const& time = "", CsvFormat format = {}) {
    files::Folder const folder;
    return CsvFile(folder.file(text), std::move(format)).read({"y"}, time);
}
std::string refusal(std::string const& text, std::string const& time, CsvFormat format = {}) {
    files::Folder const folder;
    std::string const path = folder.file(text);
    return folder.without(files::message_of([&] { CsvFile(path, format).read({"y"}, time); }));
}
/// Rows of two cells.
std::string table(std::vector<std::string> const& times, char separator = ',', std::string const& y = "1") {
    std::string out = std::string("t") + separator + "y\n";
    for (std::string const& time : times) out += time + separator + y + "\n";
    return out;
}
TEST(Times, OfOneColumnAreWrittenAlike) {
    std::string const mixed = table({"2024-10-27 02:55:00+02:00", "", "2024-10-27 02:02:00"});
    EXPECT_TRUE(read(mixed).times.empty());
    EXPECT_THAT(sentence_on_times(read(mixed)).value(), Names("t: 02:02:00 line 4 line 2 gaps"));
    EXPECT_THAT(refusal(mixed, "t"), Names("data.csv:4 column 1 t offset line 2 02:02:00"));
    EXPECT_THAT(refusal(table({"2024-10-27 02:55", "2024-10-27 02:02Z"}), "t"), Names("data.csv:3 t offset line 2"));
    EXPECT_THAT(refusal(table({"5", "06:00"}), "t"), Names("data.csv:3 t number line 2 06:00"));
    EXPECT_EQ(read(table({"2024-10-27", "2024-10-27 06:00"}), "t").times.size(), 2u) << "midnight without its hour";
    EXPECT_TRUE(std::isnan(read(table({"-999", "1"}), "t", {.missing = {"-999"}}).times[0]));
}
TEST(Times, WithMarksAreReadAsTheNumbersAre) {
    std::string const grouped = table({"\"7\"", "\"1,007\""}), pointed = table({"7", "1.000"}, '\t'),
                      comma = table({"0,5", "1,000"}, ';', "1,5"), other = table({"7", "1.000"}, ';', "1,5");
    for (std::string const& text : {grouped, pointed, other}) {
        Columns const data = read(text);
        EXPECT_TRUE(data.times.empty()) << text;
        EXPECT_THAT(sentence_on_times(data).value(), Names("t: line 3 gaps")) << text;
        EXPECT_THAT(refusal(text, "t"), Names("data.csv:3 column 1 t 1")) << text;
    }
    EXPECT_EQ(read(comma, "t").times, (std::vector<double>{0.5, 1}));
    EXPECT_EQ(read(comma).times, (std::vector<double>{0.5, 1}));
    EXPECT_EQ(read(pointed, "t", {.decimal = '.'}).times, (std::vector<double>{7, 1}));
}
TEST(Times, AsStampsAreDates) {
    std::vector<std::string> hours;
    for (int k = 0; k < 48; ++k) hours.push_back(fmt::format("202410{:02}{:02}00", 27 + k / 24, k % 24));
    EXPECT_EQ(sentence_on_times(read(table(hours))), std::nullopt);
    EXPECT_EQ(read(table({"20241027", "20241101"})).times[1], time_in("2024-11-01"));
    EXPECT_EQ(read(table({"20241027060059"})).times[0], time_in("2024-10-27 06:00:59"));
    for (char const* const number : {"1714000000", "20241301", "20240230", "18991231", "202410272500", "5"})
        EXPECT_EQ(read(table({"20241027", number})).times[0], 20241027) << number;
    EXPECT_EQ(read("k,y\n20241027,1\n").times[0], 20241027) << "not called so";
}
TEST(Times, AreNeitherOutputNorInput) {
    auto const refused = [](std::string const& time) {
        return files::message_of([&] { expect_times_apart(time, "y", {"u", "v"}); });
    };
    EXPECT_THAT(refused("y"), Names("--time y output"));
    EXPECT_THAT(refused("v"), Names("--time v input"));
    EXPECT_EQ(refused("t"), "no error");
    EXPECT_EQ(refused(""), "no error");
}
/// A long pause is a gap of so many rows at most, and the lines are those of the rows behind it.
TEST(Times, PutRowsWhereTheyBelong) {
    Columns data{.file = "f", .names = {"y"}, .values = {{0, 2, 1, 1, 5}}, .lines = {2, 3, 4, 5, 6}};
    data.time = "t", data.times = {0, 2, 1, 1, 1000};
    Columns const out = in_order_of_time(data, 3);
    std::vector<double> const& y = out.values[0];
    ASSERT_EQ(y.size(), 7u);
    EXPECT_EQ(std::vector<double>(y.begin(), y.begin() + 3), (std::vector<double>{0, 1, 2}));
    EXPECT_TRUE(std::isnan(y[3]) && std::isnan(y[4]) && std::isnan(y[5]));
    EXPECT_EQ(y[6], 5);
    EXPECT_EQ(out.lines, (std::vector<long>{2, 4, 3, 6, 6, 6, 6}));
}

}  // namespace
}  // namespace rlslab
