// How often the intervals of claims miss their number, by simulation: of each statistic on the shapes that interval.hpp
// admits it for. RLSLAB_DRAWS=100000 in the environment draws as often as was done before the shapes were admitted; by
// default it is a part of that.
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/journal.hpp>

#include <rlslab/core/random.hpp>
#include <rlslab/reference/distributions.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <numeric>

namespace rlslab {
using namespace studies;
namespace {

int draws() {
    char const* const given = std::getenv("RLSLAB_DRAWS");
    return given ? std::atoi(given) : 4000;
}

/// By Marsaglia's polar method: Seed::bell has no tails.
double normal(Seed& seed) {
    for (;;) {
        double const x = 2 * seed.uniform() - 1, y = 2 * seed.uniform() - 1, square = x * x + y * y;
        if (square > 0 && square < 1) return x * std::sqrt(-2 * std::log(square) / square);
    }
}
double exponential(Seed& seed) { return -std::log(1 - seed.uniform()); }
double average(Seed& seed, int many, double (*of)(Seed&)) {
    double sum = 0;
    for (int i = 0; i < many; ++i) sum += of(seed);
    return sum / many;
}
double squares(Seed& seed, int many) {
    return average(seed, many, [](Seed& s) { return std::pow(normal(s), 2); });
}
/// Of `many` runs of one seed; with probability `alike` all come out like the first.
double share(Seed& seed, int many, double p, double alike) {
    bool const same = seed.uniform() < alike;
    double hits = seed.uniform() < p;
    if (same) return hits;
    for (int i = 1; i < many; ++i) hits += seed.uniform() < p;
    return hits / many;  // many is a power of two: sums of shares repeat
}

struct Shape {
    char const* name;
    Estimate estimate;
    double truth;
    std::function<double(Seed&)> draw;
};
double const median_of_error = 0.67448975019608171;  // of |Z|

std::vector<Shape> shapes() {
    return {
        {"median, normal", Estimate::middle, 0, &normal},
        {"median, errors |Z|", Estimate::middle, median_of_error, [](Seed& s) { return std::abs(normal(s)); }},
        {"median, exponential", Estimate::middle, std::numbers::ln2, &exponential},
        {"median, lognormal", Estimate::middle, 1, [](Seed& s) { return std::exp(normal(s)); }},
        {"median, 5 % outliers", Estimate::middle, 0,
         [](Seed& s) { return normal(s) * (s.uniform() < 0.05 ? 10 : 1); }},
        {"median, two points", Estimate::middle, 1, [](Seed& s) { return s.uniform() < 0.52 ? 1.0 : -1.0; }},
        {"mean, normal", Estimate::mean, 0, &normal},
        {"mean, averages of 100 exponentials", Estimate::mean, 1,
         [](Seed& s) { return average(s, 100, &exponential); }},
        {"geometric mean, lognormal", Estimate::geometric, 1, [](Seed& s) { return std::exp(normal(s)); }},
        {"root mean square, normal", Estimate::quadratic, 1, &normal},
        {"root mean square, of four", Estimate::quadratic, 1, [](Seed& s) { return std::sqrt(squares(s, 4)); }},
        {"root mean square, of twenty", Estimate::quadratic, 1, [](Seed& s) { return std::sqrt(squares(s, 20)); }},
        {"root mean square, of two scales", Estimate::quadratic, std::sqrt(5.0),
         [](Seed& s) { return std::sqrt((squares(s, 2) + 9 * squares(s, 2)) / 2); }},
        {"share, one run a seed, rare", Estimate::share, 0.02, [](Seed& s) { return share(s, 1, 0.02, 1); }},
        {"share, one run a seed", Estimate::share, 0.5, [](Seed& s) { return share(s, 1, 0.5, 1); }},
        {"share, eight runs a seed", Estimate::share, 0.1, [](Seed& s) { return share(s, 8, 0.1, 0); }},
        {"share, eight runs, half of the seeds alike", Estimate::share, 0.1,
         [](Seed& s) { return share(s, 8, 0.1, 0.5); }},
        {"share, eight runs, most seeds alike", Estimate::share, 0.02, [](Seed& s) { return share(s, 8, 0.02, 0.9); }},
    };
}

Interval interval(std::vector<double> x, Estimate estimate) {
    switch (estimate) {
        case Estimate::middle: return median_interval(x, claim_risk);
        case Estimate::geometric:
            for (double& v : x) v = std::log(v);
            return student_interval(x, claim_risk);
        case Estimate::quadratic:
            for (double& v : x) v *= v;
            return square_interval(x, claim_risk);
        case Estimate::share:
            return proportion_interval(std::accumulate(x.begin(), x.end(), 0.0), double(x.size()), claim_risk);
        default: return student_interval(x, claim_risk);
    }
}
double on_its_scale(Shape const& shape) {
    return shape.estimate == Estimate::geometric   ? std::log(shape.truth)
           : shape.estimate == Estimate::quadratic ? shape.truth * shape.truth
                                                   : shape.truth;
}

/// How many of draws() intervals over n values of the shape miss its number.
template <class OfValues>
int missed(Shape const& shape, size_t n, double truth, OfValues const& of_values) {
    Seed seed{hash(shape.name)};
    int missed = 0;
    for (int i = 0; i < draws(); ++i) {
        std::vector<double> x(n);
        for (double& v : x) v = shape.draw(seed);
        Interval const found = of_values(x);
        missed += !(found.low <= truth && truth <= found.high);
    }
    return missed;
}
/// 1.5 times the risk, and three standard deviations of the count.
double allowed() {
    double const most = 1.5 * claim_risk * draws();
    return most + 3 * std::sqrt(most);
}

TEST(Coverage, AnIntervalMissesItsNumberAsOftenAsItSays) {
    for (size_t const n : {11, 20, 40, 100})
        for (Shape const& shape : shapes()) {
            int const of =
                missed(shape, n, on_its_scale(shape), [&](auto const& x) { return interval(x, shape.estimate); });
            EXPECT_LE(of, allowed()) << shape.name << ", " << n << " seeds, of " << draws();
            if (draws() >= 100000) std::printf("%-45s %3d seeds: %d of %d\n", shape.name, int(n), of, draws());
        }
}
/// Intervals that are not admitted, each for its reason.
TEST(Coverage, IntervalsThatAreTooShortAreSeen) {
    Shape const skewed{"mean, lognormal", Estimate::mean, std::exp(0.5), [](Seed& s) { return std::exp(normal(s)); }},
        few{"mean, normal", Estimate::mean, 0, &normal},
        rare{"share, rare", Estimate::share, 0.02, [](Seed& s) { return share(s, 1, 0.02, 1); }};
    auto const student = [](auto const& x) { return student_interval(x, claim_risk); };
    auto const by_normal = [](std::vector<double> const& x) {  // 3.29 standard errors, as if the variance were known
        Interval const wide = student_interval(x, claim_risk);
        double const t = correctly::student_quantile(double(x.size() - 1), 1 - claim_risk / 2),
                     middle = (wide.low + wide.high) / 2;
        return Interval{middle - (wide.high - middle) * 3.2905 / t, middle + (wide.high - middle) * 3.2905 / t};
    };
    auto const range = [](std::vector<double> x) {
        return Interval{*std::ranges::min_element(x), *std::ranges::max_element(x)};
    };
    auto const wald = [](std::vector<double> const& x) {
        double const p = std::accumulate(x.begin(), x.end(), 0.0) / double(x.size()),
                     half = 3.2905 * std::sqrt(p * (1 - p) / double(x.size()));
        return Interval{p - half, p + half};
    };
    EXPECT_GT(missed(skewed, 20, skewed.truth, student), allowed());
    EXPECT_GT(missed(few, 11, 0, by_normal), allowed());
    EXPECT_GT(missed(few, 8, 0, range), allowed()) << "as median";
    EXPECT_GT(missed(rare, 100, rare.truth, wald), allowed());
}

/// A claim whose number lies a hair outside its band must not hold, one whose number lies a hair inside must not fail.
/// How many verdicts are wrong, and how many their risks add up to, over one group and five of 20 lognormal x and
/// normal y.
std::pair<int, double> wrong_verdicts(std::vector<std::pair<Statistic, double>> const& numbers) {
    Seed seed{17};
    double expected = 0, infinity = std::numeric_limits<double>::infinity();
    int wrong = 0;
    for (int i = 0; i < draws() / 4; ++i)
        for (int const groups : {1, 5}) {
            Table t({"group", "replicate", "x", "y"});
            for (int g = 0; g < groups; ++g)
                for (int k = 0; k < 20; ++k) t.add({double(g), double(k), std::exp(normal(seed)), normal(seed)});
            for (auto const& [number, truth] : numbers) {
                Judgement const outside = within(t, {"group"}, number, -infinity, std::nextafter(truth, -1.0)),
                                inside = within(t, {"group"}, number, truth, infinity);
                wrong += (outside.verdict == Verdict::holds) + (inside.verdict == Verdict::fails);
                expected += std::max(outside.risk, inside.risk);  // which of the two is asked, nobody knows beforehand
            }
        }
    return {wrong, 1.5 * expected + 3 * std::sqrt(1.5 * expected)};
}
Statistic const median_of_x([](Table const& t) { return t.number("x"); });

TEST(Coverage, AsManyVerdictsAreWrongAsTheirRisksAddUpTo) {
    auto const [wrong, most] = wrong_verdicts(
        {{median_of_x, 1}, {Statistic([](Table const& t) { return t.number("y"); }, Estimate::mean), 0}});
    EXPECT_LE(wrong, most);
}
TEST(Coverage, MoreAreWrongWhereAMeanIsTakenOfSkewedNumbers) {
    auto const [wrong, most] =
        wrong_verdicts({{Statistic([](Table const& t) { return t.number("x"); }, Estimate::mean), std::exp(0.5)}});
    EXPECT_GT(wrong, most);
}

}  // namespace
}  // namespace rlslab
