// A catalogue: the instances of some arithmetics, in the order of the two lists. RLSLAB_LINKED names them by their places in the
// list of arithmetics.
#include "catalogue/catalogue.hpp"
#include "catalogue/instances.hpp"

#include <utility>

namespace rlslab {
namespace {

struct Lists {
    std::vector<Arithmetic> arithmetics;
    std::vector<Entry> entries;
};

template <int... I>
Lists const& gathered(std::integer_sequence<int, I...>) {
    static Lists lists;  // entries point into it
    std::vector<Instances> all{instances<I>()...};
    for (Instances const& one : all) lists.arithmetics.push_back(one.arithmetic);
    for (size_t a = 0; a < all.size(); ++a)
        for (Entry entry : all[a].entries) {
            entry.arithmetic = &lists.arithmetics[a];
            lists.entries.push_back(entry);
        }
    return lists;
}

Lists const& lists() {
    static Lists const& all = gathered(std::integer_sequence<int, RLSLAB_LINKED>{});
    return all;
}

}  // namespace

std::vector<Arithmetic> const& arithmetics() { return lists().arithmetics; }
std::vector<Entry> const& catalogue() { return lists().entries; }

}  // namespace rlslab
