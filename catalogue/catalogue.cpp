// The catalogue: the instances of every arithmetic, in the order of the two lists; and the operation counts.
#include "catalogue/catalogue.hpp"
#include "catalogue/instances.hpp"

#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/variants/variants.hpp>

#include <utility>

namespace rlslab {
namespace {

static_assert(std::tuple_size_v<Arithmetics> == RLSLAB_ARITHMETICS, "catalogue/CMakeLists.txt counts the arithmetics");

struct Lists {
    std::vector<Arithmetic> arithmetics;
    std::vector<Entry> entries, in_bits;
    Arithmetic bits;
};

template <int... I>
Lists const& gathered(std::integer_sequence<int, I...>) {
    static Lists lists;    // entries point into it
    std::vector<Instances> all{instances<I>()...};
    for (Instances const& one : all) lists.arithmetics.push_back(one.arithmetic);
    for (size_t a = 0; a < all.size(); ++a)
        for (Entry entry : all[a].entries) {
            entry.arithmetic = &lists.arithmetics[a];
            lists.entries.push_back(entry);
        }
    Instances const any_length = instances<bits_index>();
    lists.bits = any_length.arithmetic;
    for (Entry entry : any_length.entries) {
        entry.arithmetic = &lists.bits;
        lists.in_bits.push_back(entry);
    }
    return lists;
}

Lists const& lists() {
    static Lists const& all = gathered(std::make_integer_sequence<int, RLSLAB_ARITHMETICS>{});
    return all;
}

/// One update, or a block, after 2d + 1 rows of noise: past the zeros of the start; then theta().
template <class F>
Cost counted_cost(Index d) {
    using T = typename F::scalar;
    F filter(Problem<T>{.size = d, .forgetting = T(0.99)});
    Seed seed{1};
    auto const noise = [&seed](Index n) { return Vector<T>(Vector<T>::NullaryExpr(n, [&seed] { return T(seed.bell()); })); };
    for (Index k = 0; k < 2 * d + 1; ++k) filter.update(noise(d), T(seed.bell()));
    auto const per_row = [](Tally const& t, long rows) {
        return Operations{t.additions / rows, t.multiplications / rows, t.divisions / rows, t.square_roots / rows};
    };
    Cost cost;
    long rows = 1;
    if constexpr (TakesBlocks<F>) {
        rows = F::block;
        Rows<T> psi(d, F::block);
        for (Index k = 0; k < F::block; ++k) psi.col(k) = noise(d);
        Vector<T> const y = noise(F::block);
        cost.update = per_row(counted([&] { filter.absorb(psi, y); }), rows);
    } else {
        Vector<T> const psi = noise(d);
        T const y(seed.bell());
        cost.update = per_row(counted([&] { filter.update(psi, y); }), rows);
    }
    cost.theta = per_row(counted([&] { Vector<T> const theta = filter.theta(); }), rows);
    return cost;
}

}  // namespace

std::vector<Arithmetic> const& arithmetics() { return lists().arithmetics; }
std::vector<Entry> const& catalogue() { return lists().entries; }
std::vector<Entry> const& in_bits() { return lists().in_bits; }

std::optional<Cost> cost(std::string_view variant, Index size) {
    std::optional<Cost> out;
    for_each(Variants<Counted<double>>{}, [&]<class F>() {
        if (F::name == variant) out = counted_cost<F>(size);
    });
    return out;
}

}  // namespace rlslab
