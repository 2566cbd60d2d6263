// What happens to a fleet, and that each of its filters notices its own part of it alone.
#include "tests/many/together.hpp"

#include <gtest/gtest.h>

namespace rlslab::together {
namespace {

constexpr Index d = 3;

Index below(Seed& seed, Index n) { return std::min(n - 1, Index(seed.uniform() * double(n))); }
Problem<double> some_problem(Seed& seed, bool may_lack_a_prior) {
    Problem<double> p{.size = d, .forgetting = std::array{1.0, 0.96875, 0.9}[std::size_t(below(seed, 3))]};
    p.prior->variance = std::array{1.0, 100.0, 16384.0}[std::size_t(below(seed, 3))];
    if (below(seed, 3) == 0) p.prior->theta = Vector<double>::Constant(d, double(float(seed.bell())));
    if (below(seed, 4) == 0) {
        Matrix<double> P0 = Matrix<double>::Identity(d, d) * 2;
        P0(0, 1) = P0(1, 0) = double(float(seed.bell() / 8));
        p.prior->covariance = P0;
    }
    if (may_lack_a_prior && below(seed, 3) == 0) p.prior.reset();
    return p;
}

/// The filters that are alone, with a place for each number of the fleet.
struct Story {
    Pair const& pair;
    Seed seed;
    unsigned threads;
    std::vector<std::unique_ptr<Alone>> alone = {};
    std::vector<twins::Lively> rows = {};
    std::unique_ptr<Together> fleet = {};
    Problem<double> first = {};
    FleetCounts all = {};
    std::string wrong = {};

    void claim(bool holds, std::string_view what) {
        if (!holds && wrong.empty()) wrong = what;
    }
    void claim_one(Left const& a, Left const& b) {
        if (wrong.empty()) wrong = parted(a, b);
    }
    void begin(Index filters) {
        std::vector<Problem<double>> problems;
        for (Index i = 0; i < filters; ++i) {
            problems.push_back(some_problem(seed, pair.starts_without_prior));
            stand_at(i, pair.alone->made(problems.back()));
        }
        first = problems[0];
        fleet = pair.fleet(problems);
    }
    void stand_at(Index i, std::unique_ptr<Alone> one) {
        if (i == Index(alone.size())) {
            alone.emplace_back();
            rows.push_back({.seed = Seed{seed.next()}, .beyond = pair.goes_on_after_a_breakdown ? 1e30 : 0});
        }
        alone[std::size_t(i)] = std::move(one);
    }
    Index lowest_place() const {
        return Index(std::ranges::find(alone, nullptr, &std::unique_ptr<Alone>::get) - alone.begin());
    }
    void act() {
        Index const i = below(seed, Index(alone.size())), action = below(seed, 10);
        auto const p = some_problem(seed, pair.starts_without_prior);
        Alone const* const mine = alone[std::size_t(i)].get();
        if (action <= 1) {
            Index const place = lowest_place();
            claim(fleet->add(action == 0 ? nullptr : &p) == place, "add() gives the lowest number that is free");
            stand_at(place, pair.alone->made(action == 0 ? first : p));
        } else if (!mine) {
            return;
        } else if (action <= 3) {
            fleet->remove(i);
            alone[std::size_t(i)].reset();
        } else if (action <= 5) {
            fleet->reset(i, action == 4 ? nullptr : &p);
            alone[std::size_t(i)] = mine->made(action == 4 ? first : p);
        } else if (action == 6 && mine->health == Health::sound) {  // to another place, by way of its bytes
            auto one = pair.alone->made(Problem<double>{.size = d});
            claim(one->load(fleet->saved(i)), "a filter of numbers loads that of the fleet");
            Index const to = lowest_place();
            claim(fleet->add(nullptr) == to, "add()");
            fleet->put(to, *one);
            auto twin = mine->copy();
            twin->counts = {};
            stand_at(to, std::move(twin));
        } else if (action == 7) {
            claim(fleet->goes_through_a_file(p), "a fleet loads what it saved");
        }
    }
    void take_rows(int k) {
        std::vector<Row<double>> now;
        double const bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity()};
        for (Index i = 0; i < Index(alone.size()); ++i) {
            auto row = rows[std::size_t(i)].next();
            double const odd[] = {0, -1, bad[0]};
            bool const is_odd = pair.takes_weights && below(seed, 4) == 0;
            row.w = is_odd ? odd[below(seed, 3)] : std::ldexp(1 + seed.uniform(), int(4 * seed.bell()));
            Index const chance = k % 11 == 10 ? 0 : below(seed, 15);  // now and then all are missing
            if (chance == 0) row.y = bad[k % 3];
            else if (chance == 1) row.psi[d - 1] = bad[k % 3];
            if (k == 40 && i == 3) row.psi = Vector<double>{{1e30, -1e30, 1e30}};  // overflows in either arithmetic
            now.push_back(row);
        }
        bool const with_steps = k % 5 != 4;
        Index const told = fleet->update(now, with_steps, threads);
        Index missing = 0;
        for (Index i = 0; i < Index(alone.size()); ++i) {
            Alone* const mine = alone[std::size_t(i)].get();
            Row<double> const& row = now[std::size_t(i)];
            bool const whole = row.psi.allFinite() && std::isfinite(row.y);
            bool const taken = mine && row.w >= 0 && (whole || row.w == 0);
            if (with_steps) claim(fleet->took(i) == taken, "what was taken");
            claim(fleet->alive(i) == bool(mine), "what is there");
            if (!mine) claim(fleet->has_no_theta(i), "what was removed has no theta");
            if (!mine) continue;
            bool const broken = mine->health == Health::nonfinite;
            ++(taken ? mine->counts.taken : mine->counts.missing), ++(taken ? all.taken : all.missing);
            missing += !taken;
            if (taken) {
                Left const step = mine->take(row);
                if (with_steps && !broken && mine->health != Health::nonfinite) claim_one(fleet->step(i), step);
            }
            claim(fleet->health(i) == mine->health, "health");
            claim(fleet->counts(i).taken == mine->counts.taken && fleet->counts(i).missing == mine->counts.missing,
                  "the rows of one");
            bool const known = mine->health != Health::undetermined && mine->health != Health::nonfinite;
            if (known) claim_one(fleet->held(i), mine->held());
        }
        claim(told == missing, "what is missing");
        claim(fleet->counts().taken == all.taken && fleet->counts().missing == all.missing, "the rows of all");
    }
};

}  // namespace

std::string parted(Pair const& pair, std::uint64_t seed, Index filters, unsigned threads) {
    Story story{.pair = pair, .seed = Seed{seed}, .threads = threads};
    story.begin(filters);
    for (int k = 0; k < 120 && story.wrong.empty(); ++k) {
        story.act();
        story.take_rows(k);
        if (!story.wrong.empty()) story.wrong += " in row " + std::to_string(k);
    }
    story.claim(story.all.missing > 0, "no sample was missing");
    return story.wrong;
}
void expect_each_to_live_alone(Pair const& pair) {
    for (Index const filters : {1, 7, 8, 20})
        EXPECT_EQ(parted(pair, std::uint64_t(80 + filters), filters, 1 + unsigned(filters % 3)), "")
            << pair.what << ", " << filters << " filters";
}

}  // namespace rlslab::together
