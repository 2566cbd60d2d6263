// A fleet and a filter of numbers of any type, for the tests that take them through what can happen to a fleet.
#pragma once

#include "tests/common/states.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/many/fleet.hpp>

#include <functional>
#include <memory>

namespace rlslab::together {

using twins::in;
using twins::Left;
using twins::Row;
using states::Bytes;

/// A filter of numbers, and what a fleet must say of it.
struct Alone {
    Health health = Health::sound;
    FleetCounts counts = {};
    virtual ~Alone() = default;
    virtual std::unique_ptr<Alone> made(Problem<double> const& problem) const = 0;  ///< another of the type
    virtual std::unique_ptr<Alone> copy() const = 0;
    virtual Left take(Row<double> const& row) = 0;
    virtual Left held() const = 0;
    virtual bool load(Bytes const& bytes) = 0;
};
struct Together {
    virtual ~Together() = default;
    virtual FleetCounts counts() const = 0;
    virtual Index add(Problem<double> const* problem) = 0;  ///< nullptr: the fleet's own, here and below
    virtual void remove(Index i) = 0;
    virtual void reset(Index i, Problem<double> const* problem) = 0;
    virtual Bytes saved(Index i) const = 0;
    virtual void put(Index i, Alone const& one) = 0;
    /// Is saved, and loaded into a fleet of another problem.
    virtual bool goes_through_a_file(Problem<double> const& other) = 0;
    virtual Index update(std::vector<Row<double>> const& rows, bool with_steps, unsigned threads) = 0;
    virtual bool took(Index i) const = 0;
    virtual Left step(Index i) const = 0;
    virtual bool alive(Index i) const = 0;
    virtual Health health(Index i) const = 0;
    virtual FleetCounts counts(Index i) const = 0;
    virtual Left held(Index i) const = 0;
    virtual bool has_no_theta(Index i) const = 0;
};
struct Pair {
    std::string what;
    std::unique_ptr<Alone> alone;
    std::function<std::unique_ptr<Together>(std::vector<Problem<double>> const&)> fleet;
    bool starts_without_prior, goes_on_after_a_breakdown, takes_weights;
};
/// Whatever comes, goes, begins anew, is exchanged, saved and loaded, misses its sample or breaks down in a fleet: each
/// filter has the bits of one that is alone with its own rows. "", or what was otherwise.
std::string parted(Pair const& pair, std::uint64_t seed, Index filters, unsigned threads);
void expect_each_to_live_alone(Pair const& pair);

template <class F, class Make>
class AloneAs final : public Alone {
    Make make_;
    F filter_;
    using T = typename F::scalar;

public:
    AloneAs(Make make, Problem<double> const& problem) : make_(make), filter_(make(in<T>(problem))) {
        health = problem.prior ? Health::sound : Health::undetermined;
    }
    F const& filter() const { return filter_; }
    std::unique_ptr<Alone> made(Problem<double> const& p) const override { return std::make_unique<AloneAs>(make_, p); }
    std::unique_ptr<Alone> copy() const override { return std::make_unique<AloneAs>(*this); }
    Left take(Row<double> const& row) override {
        auto const r = twins::row_in<T>(row);
        Step<T> step;
        if constexpr (detail::TakesWeights<F>) step = filter_.update(r.psi, r.y, r.w);
        else step = filter_.update(r.psi, r.y);
        if constexpr (detail::IsGuarded<F>) {
            if (filter_.signal() != GuardSignal::unusable) health = step.health;
        } else {
            health = health == Health::undetermined ? step.health : worse(health, step.health);
        }
        Left out;
        out.add("innovation", step.innovation).add("residual", step.residual);
        return out.add("gamma", step.gamma).add("health", step.health);
    }
    Left held() const override {
        Left out;
        out.add("theta", filter_.theta());
        if constexpr (detail::IsGuarded<F>) out.add("counts", twins::numbers_of(filter_.counts()));
        return out;
    }
    bool load(Bytes const& bytes) override { return rlslab::load(filter_, bytes) == StateFault::none; }
};

template <class P, class F, class Make>
class TogetherAs final : public Together {
    using T = typename P::scalar::lane_type;
    Make make_;
    Fleet<P> fleet_;
    FleetSteps<T> steps_;
    static std::vector<Problem<T>> in_numbers(std::vector<Problem<double>> const& problems) {
        std::vector<Problem<T>> out;
        for (auto const& p : problems) out.push_back(in<T>(p));
        return out;
    }

public:
    TogetherAs(Make make, std::vector<Problem<double>> const& problems)
        : make_(make), fleet_(in_numbers(problems), make), steps_(fleet_.filters()) {}
    FleetCounts counts() const override { return fleet_.counts(); }
    Index add(Problem<double> const* p) override { return p ? fleet_.add(in<T>(*p)) : fleet_.add(); }
    void remove(Index i) override { fleet_.remove(i); }
    void reset(Index i, Problem<double> const* p) override { p ? fleet_.reset(i, in<T>(*p)) : fleet_.reset(i); }
    Bytes saved(Index i) const override { return states::bytes_of(fleet_.filter(i)); }
    void put(Index i, Alone const& one) override { fleet_.put(i, static_cast<AloneAs<F, Make> const&>(one).filter()); }
    bool goes_through_a_file(Problem<double> const& other) override {
        auto const bytes = state_of(fleet_);
        Fleet<P> loaded(fleet_.filters(), in<T>(other), make_);
        bool const same = load(loaded, bytes) == StateFault::none && state_of(loaded) == bytes;
        fleet_ = loaded;
        return same;
    }
    Index update(std::vector<Row<double>> const& rows, bool with_steps, unsigned threads) override {
        Index const M = fleet_.filters(), d = fleet_.parameters();
        Matrix<T> psi(M, d);
        Vector<T> y(M), w(M);
        for (Index i = 0; i < M; ++i) {
            auto const row = twins::row_in<T>(rows[std::size_t(i)]);
            psi.row(i) = row.psi, y[i] = row.y, w[i] = row.w;
        }
        steps_.resize(M);
        if constexpr (detail::TakesWeights<F>) return fleet_.update_weighted(psi, y, w, steps_, threads);
        else return with_steps ? fleet_.update(psi, y, steps_, threads) : fleet_.update(psi, y, threads);
    }
    bool took(Index i) const override { return steps_.taken[std::size_t(i)]; }
    Left step(Index i) const override {
        Left out;
        out.add("innovation", steps_.innovation[i]).add("residual", steps_.residual[i]);
        return out.add("gamma", steps_.gamma[i]).add("health", steps_.health[std::size_t(i)]);
    }
    bool alive(Index i) const override { return fleet_.alive(i); }
    Health health(Index i) const override { return fleet_.health(i); }
    FleetCounts counts(Index i) const override { return fleet_.counts(i); }
    Left held(Index i) const override {
        Left out;
        out.add("theta", fleet_.theta(i));
        if constexpr (detail::IsGuarded<F>) out.add("counts", twins::numbers_of(fleet_.guard_counts(i)));
        return out;
    }
    bool has_no_theta(Index i) const override { return fleet_.thetas().row(i).array().isNaN().all(); }
};

/// make(problem) makes what is to be in a fleet of a problem of packs, and alone of one of numbers.
template <class T, int L, class Make>
Pair pair_of(Make make) {
    using F = decltype(make(Problem<T>{}));
    using P = decltype(make(Problem<Pack<T, L>>{}));
    return {std::string(F::name),
            std::make_unique<AloneAs<F, Make>>(make, Problem<double>{.size = 3}),
            [make](auto const& problems) { return std::make_unique<TogetherAs<P, F, Make>>(make, problems); },
            StartsWithoutPrior<F>,
            detail::IsGuarded<F>,
            detail::TakesWeights<F>};
}
template <class T, int L, class Make>
void expect_fleets_of(Make make) {
    expect_each_to_live_alone(pair_of<T, L>(make));
}
/// A variant V.
template <template <class, int> class V, class T = double, int L = 8, int N = 3>
void expect_fleets_of() {
    expect_fleets_of<T, L>([]<class X>(Problem<X> const& p) { return V<X, N>(p); });
}

template <template <class, int> class... V>
void expect_fleets_of_each() {
    (expect_fleets_of<V>(), ...);
}

}  // namespace rlslab::together
