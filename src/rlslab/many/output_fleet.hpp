// Many filters of several outputs each, of real or of complex numbers: the bins of a spectrum, as many in lockstep as a
// Pack has lanes.
#pragma once

#include <rlslab/core/complex.hpp>
#include <rlslab/many/fleet_steps.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/state/lanes.hpp>

#include <tuple>
#include <vector>

namespace rlslab {

/// A variant over packs, or over complex numbers of packs, whose lanes have nothing in common but options.
template <class F>
concept InLockstep =
    requires { RealOf<typename F::scalar>::lanes; } && NamesItsState<F> && !detail::counts_all_lanes_at_once<F>();

/// M filters of m outputs each, F a variant over packs, such as Ud<Pack<float, 8>> or Ud<Complex<Pack<float, 8>>>. With
/// psi' the conjugate transpose each output of each filter is F of the number, bit for bit:
///
///   (1) e_j = y_j - psi'theta_j        (2) F's row: P, and K        (3) theta_j += K e_j,  residual gamma e_j
///   (4) of weight w: the row (r psi, r y), r = sqrt(w), and e_j / r, residual / r; w = 0: psi = 0, y = 0, time passes
///
/// Output 1 is F's own theta; the others need d products for (1) and d for (3), and a form that reports P. A row with a
/// number that is not finite, or w < 0, is missing: its filter stays as it was, its time does not pass, and no other
/// filter notices. Who holds a filter through silence passes NaN. Of w = 0 psi and y may be anything; e and residual
/// are NaN. Several outputs of forms that solve for theta, complex priors but theta0 = 0 and c^2 I, and sizes that are
/// no filter throw std::invalid_argument. An update allocates when it first meets a missing row. Source: as of
/// MultiOutput, Weighted and Fleet.
template <InLockstep F>
class OutputFleet {
    using C = typename F::scalar;
    using pack = RealOf<C>;
    static constexpr bool is_complex = ComplexScalar<C>;

public:
    using scalar = C;
    using real = typename pack::lane_type;
    using number = std::conditional_t<is_complex, Complex<real>, real>;
    static constexpr int lanes = pack::lanes;
    static constexpr std::string_view name = F::name;

    OutputFleet(Index filters, Problem<number> const& problem, Index outputs = 1)
        : size_(checked(problem, filters, outputs).size), filters_(filters), outputs_(outputs),
          fresh_(in_packs(problem)), packs_(size_t((filters + lanes - 1) / lanes), fresh_),
          further_(size_t(outputs - 1) * packs_.size() * size_t(size_), C(0)),
          first_(problem.prior ? Health::sound : Health::undetermined), health_(packs_.size(), first_) {
        if (problem.prior && problem.prior->theta)
            for (Index i = 0; i < filters; i += lanes) start_further(i, true);
    }

    Index filters() const { return filters_; }  ///< M
    Index size() const { return size_; }        ///< d
    Index outputs() const { return outputs_; }  ///< m

    /// One row for each filter: psi is M x d and y M x m, those of a filter side by side; w: M weights, or null.
    /// Returns how many rows were missing. steps: of M filters of m outputs, or null; health is the worse of each
    /// output's own and F's. threads: over how many the filters are divided; no bit depends on it.
    Index update(number const* psi, number const* y, real const* w, FleetSteps<number>* steps, unsigned threads = 1) {
        expects(!steps || (steps->filters() == filters_ && steps->innovation.size() == filters_ * outputs_),
                "steps of as many filters and outputs as the fleet has");
        Index const groups = Index(packs_.size()), shares = std::clamp<Index>(Index(threads), 1, groups);
        std::vector<Index> missing(size_t(shares), 0);
        detail::among_threads(shares, [&](Index share) {
            std::vector<C> row(size_t(size_ + 2 * outputs_));
            for (Index g = groups * share / shares; g < groups * (share + 1) / shares; ++g)
                missing[size_t(share)] += update_group(g, psi, y, w, steps, row.data());
        });
        Index sum = 0;
        for (Index const n : missing) sum += n;
        return sum;
    }
    Index update(number const* psi, number const* y) { return update(psi, y, nullptr, nullptr); }

    /// Of filter i, d x m. These throw std::invalid_argument where there is none.
    Matrix<number> theta(Index i) const {
        check(i);
        Matrix<number> out(size_, outputs_);
        auto const& first = group(i).theta();
        for (Index j = 0; j < outputs_; ++j)
            for (Index k = 0; k < size_; ++k)
                out(k, j) = in_lane(j == 0 ? C(first[k]) : theta_of(size_t(i / lanes), j)[k], i);
        return out;
    }
    /// Undetermined until its rows determine theta, then the worst of its steps.
    Health health(Index i) const {
        check(i);
        return health_[size_t(i / lanes)][int(i % lanes)];
    }
    /// Filter i, with its first output, as a filter of its own; only the gain of the last row is lost.
    auto filter(Index i) const {
        check(i);
        detail::LaneRead numbers(int(i % lanes));
        detail::walk(numbers, group(i));
        detail::OneLaneOf<F> out(Problem<number>{.size = size_});
        detail::LaneWritten written(0, true, numbers.values);
        detail::walk(written, out);
        return out;
    }
    /// Filter i begins anew, and with the last one the lanes behind it.
    void reset(Index i) {
        check(i);
        detail::NumbersOfLanes<pack> numbers;
        detail::walk(numbers, fresh_);
        detail::LanesPutBack<pack> back(numbers, start_further(i, false));
        detail::walk(back, packs_[size_t(i / lanes)]);
    }

    static constexpr std::string_view layer = is_complex ? "complex fleet" : "output fleet";
    static std::array<StateOption, 2> options(auto const& f) {
        return {{{"filters", double(f.filters_)}, {"outputs", double(f.outputs_)}}};
    }
    static auto state(auto& f) { return std::tie(f.fresh_, f.packs_, f.further_, f.health_); }

private:
    Index size_, filters_, outputs_;
    F fresh_;  // so that a state begins with d
    std::vector<F> packs_;
    std::vector<C> further_;  // theta of output j > 0 of group g: d numbers from ((m - 1) g + j - 1) d on
    Health first_;
    std::vector<Lanes<Health, lanes>> health_;

    static Problem<number> const& checked(Problem<number> const& problem, Index filters, Index outputs) {
        expects(1 <= filters && filters <= std::numeric_limits<Index>::max() / (2 * lanes) && outputs >= 1,
                "a number of filters and of outputs, at least one");
        expects(outputs == 1 || ReportsCovariance<F>, "one output of a form that solves for theta");
        expects(!is_complex || !problem.prior || (!problem.prior->theta && !problem.prior->covariance),
                "theta0 = 0 and P0 = c^2 I");
        return problem;
    }
    static Problem<C> in_packs(Problem<number> const& problem) {
        if constexpr (is_complex) {
            Problem<C> out{.size = problem.size, .forgetting = pack(problem.forgetting)};
            if (problem.prior) out.prior->variance = pack(problem.prior->variance);
            else out.prior.reset();
            return out;
        } else {
            return problem.template mapped<pack>([](real x) { return pack(x); });
        }
    }
    static number in_lane(C const& x, Index i) {
        int const lane = int(i % lanes);
        if constexpr (is_complex) return {x.re[lane], x.im[lane]};
        else return x[lane];
    }
    void check(Index i) const { expects(0 <= i && i < filters_, "the number of a filter that is there"); }
    F const& group(Index i) const { return packs_[size_t(i / lanes)]; }
    C* theta_of(size_t g, Index j) { return further_.data() + (Index(g) * (outputs_ - 1) + j - 1) * size_; }
    C const* theta_of(size_t g, Index j) const { return const_cast<OutputFleet*>(this)->theta_of(g, j); }
    /// theta0 and the first health in filter i's lane, of the last filter in those behind it, or in all of its group.
    Truth<C> start_further(Index i, bool all) {
        size_t const g = size_t(i / lanes);
        Lanes<bool, lanes> which(all);
        for (int lane = int(i % lanes); lane < (i + 1 == filters_ ? lanes : int(i % lanes) + 1); ++lane)
            which.value[size_t(lane)] = true, health_[g].value[size_t(lane)] = first_;
        Truth<C> const mask(which);
        for (Index j = 1; j < outputs_; ++j)
            for (Index k = 0; k < size_; ++k) theta_of(g, j)[k] = select(mask, C(fresh_.theta()[k]), theta_of(g, j)[k]);
        return mask;
    }

    /// Number i of each filter's `count`, in lanes: behind the last filter as in its lane.
    template <class X>
    auto gathered(X const* from, Index first, Index count, Index i) const {
        real parts[2][lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            X const& x = from[std::min(first + lane, filters_ - 1) * count + i];
            parts[0][lane] = real_part(x);
            if constexpr (ComplexScalar<X>) parts[1][lane] = x.im;
        }
        if constexpr (ComplexScalar<X>) return C(pack::loaded(parts[0]), pack::loaded(parts[1]));
        else return pack::loaded(parts[0]);
    }
    Index update_group(Index g, number const* psi, number const* y, real const* w, FleetSteps<number>* steps, C* row) {
        Index const first = g * lanes, here = std::min<Index>(lanes, filters_ - first);
        F& filter = packs_[size_t(g)];
        C *const y_of = row + size_, *const e_of = y_of + outputs_;
        pack const root = w ? square_root(gathered(w, first, 1, 0)) : pack(1);  // NaN where w < 0
        Truth<C> const empty = root == pack(0);
        Truth<C> present = is_finite(root);
        auto const weighed = [&](number const* from, Index count, Index i) {  // (4)
            C x = gathered(from, first, count, i);
            if (w) x = select(empty, C(0), C(root * x));
            present = present && is_finite(x);
            return x;
        };
        for (Index i = 0; i < size_; ++i) row[i] = weighed(psi, size_, i);
        for (Index j = 0; j < outputs_; ++j) y_of[j] = weighed(y, outputs_, j);
        if (!all(present))
            for (Index i = 0; i < size_ + outputs_; ++i) row[i] = select(present, row[i], C(0));
        Regressor<C> const regressor(row, size_);
        for (Index j = 1; j < outputs_; ++j) e_of[j] = y_of[j] - dot(row, theta_of(size_t(g), j), size_);  // (1)
        Step<C> step{undefined<C>(), undefined<C>(), undefined<pack>(), Health::nonfinite};
        if (any(present))
            step = detail::on_lanes<pack>(filter, present, [&] { return filter.update(regressor, y_of[0]); });  // (2)
        PerLane<C, Health> worst = step.health;
        e_of[0] = step.innovation;
        auto const told = [&](Index j, C const& residual, PerLane<C, Health> const& health) {
            if (!steps) return;
            auto const unweighed = [&](C const& x) {
                return select(present && !empty, w ? C(x / root) : x, undefined<C>());
            };
            C const e = unweighed(e_of[j]), rest = unweighed(residual);
            for (int lane = 0; lane < here; ++lane) {
                Index const at = (first + lane) * outputs_ + j;
                steps->innovation[at] = in_lane(e, lane);
                steps->residual[at] = in_lane(rest, lane);
                steps->health[size_t(at)] = present[lane] ? health[lane] : Health::nonfinite;
                steps->gamma[first + lane] = present[lane] ? step.gamma[lane] : undefined<real>();
                steps->taken[size_t(first + lane)] = present[lane];
            }
        };
        told(0, step.residual, step.health);
        for (Index j = 1; j < outputs_; ++j) {
            Step<C> own = step_of(e_of[j], step.gamma);
            if constexpr (ReportsCovariance<F>)
                if (any(present)) {
                    auto const& K = filter.gain();
                    C* const theta = theta_of(size_t(g), j);
                    Truth<C> finite(true);
                    for (Index k = 0; k < size_; ++k) {  // (3)
                        C const more = e_of[j] * K[k];
                        theta[k] = select(present, theta[k] + more, theta[k]);
                        finite = finite && is_finite(theta[k]);
                    }
                    own = if_finite<C>(finite, own);
                }
            own.health = worse(own.health, step.health);
            worst = worse(worst, own.health);
            told(j, own.residual, own.health);
        }
        Index missing = 0;
        for (int lane = 0; lane < here; ++lane) {
            Health& mine = health_[size_t(g)].value[size_t(lane)];
            if (present[lane]) mine = mine == Health::undetermined ? worst[lane] : worse(mine, worst[lane]);
            missing += !present[lane];
        }
        return missing;
    }
};

}  // namespace rlslab
