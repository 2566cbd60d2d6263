// Cells that are times, and columns of them.
#include <rlslab/input/times.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace rlslab {
namespace {

TEST(Times, AreNumbersOrAsPeopleWriteThem) {
    EXPECT_EQ(time_in("12.5"), 12.5);
    EXPECT_TRUE(std::isnan(time_in("").value()));
    EXPECT_EQ(time_in("1970-01-02"), 86400);
    EXPECT_EQ(time_in("2024-02-29 00:00:00").value() + 86400, time_in("2024-03-01 00:00:00"));
    EXPECT_EQ(time_in("1970-01-01T01:02:03.25Z"), 3723.25);
    EXPECT_EQ(time_in("1970-01-01 01:02:03+02:00"), 3723);
    EXPECT_EQ(time_in("17.05.2024 06:00:00"), time_in("2024-05-17 06:00"));
    EXPECT_EQ(time_in("2024/05/17 06:00"), time_in("2024-05-17 06:00"));
    EXPECT_EQ(time_in("01:02"), 3720);
    EXPECT_EQ(time_in("23:59:60"), 86400) << "a leap second";
    for (char const* const other : {"soon", "2023-02-29", "2024-13-01", "2024-02-28x", "25:00", "01:60",
                                    "01:02:", "01:02:70", "1:2", "01:02:3x", "2024-02-28 ", "-5:00"})
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
