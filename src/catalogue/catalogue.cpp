// A catalogue: the instances of some arithmetics, in the order of the two lists. RLSLAB_LINKED names them by their
// places in the list of arithmetics.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/instances.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/model/order_recursive.hpp>

#include <algorithm>
#include <utility>

namespace rlslab {
namespace {

struct Lists {
    std::vector<Arithmetic> arithmetics;
    std::vector<CatalogueEntry> entries;
};

template <int... I>
Lists& gathered(std::integer_sequence<int, I...>) {
    static Lists lists;  // entries point into it
    std::vector<Instances> all{instances<I>()...};
#ifdef RLSLAB_LINKS_SPARSE
    std::vector<CatalogueEntry>& in_double =
        std::ranges::find(all, ArithmeticTraits<double>::name, [](Instances const& one) {
            return one.arithmetic.name;
        })->entries;
    for (CatalogueEntry const& entry : sparse_entries()) in_double.push_back(entry);
#endif
    for (Instances const& one : all) lists.arithmetics.push_back(one.arithmetic);
    for (size_t a = 0; a < all.size(); ++a)
        for (CatalogueEntry entry : all[a].entries) {
            entry.arithmetic = &lists.arithmetics[a];
            lists.entries.push_back(entry);
        }
    return lists;
}

Lists& lists() {
    static Lists& all = gathered(std::integer_sequence<int, RLSLAB_LINKED>{});
    return all;
}

}  // namespace

std::vector<Arithmetic> const& arithmetics() { return lists().arithmetics; }
std::vector<CatalogueEntry> const& catalogue() { return lists().entries; }
void add_to_catalogue(CatalogueEntry const& entry) {
    expects(!find_entry(entry.variant, entry.arithmetic->name), "a name that no variant of that arithmetic has");
    auto& entries = lists().entries;
    auto at = entries.end();
    while (at != entries.begin() && (at - 1)->arithmetic != entry.arithmetic) --at;  // behind the arithmetic's own
    entries.insert(at, entry);
}

CatalogueEntry const* find_entry(std::vector<CatalogueEntry> const& entries, std::string_view variant,
                                 std::string_view arithmetic) {
    auto const found = std::ranges::find_if(entries, [&](CatalogueEntry const& entry) {
        return entry.variant == variant && entry.arithmetic->name == arithmetic;
    });
    return found == entries.end() ? nullptr : &*found;
}
CatalogueEntry const* find_entry(std::string_view variant, std::string_view arithmetic) {
    return find_entry(catalogue(), variant, arithmetic);
}

Arithmetic const& arithmetic_named(std::string_view name, std::string_view where) {
    if (std::vector<CatalogueEntry> const* const own = entries_at_run_time(name, where))
        return *own->front().arithmetic;
    std::vector<std::string_view> names;
    for (Arithmetic const& a : arithmetics()) names.push_back(a.name);
    expect_one_of(names, name, where, "arithmetic");
    return *std::ranges::find(arithmetics(), name, &Arithmetic::name);
}

std::vector<CatalogueEntry const*> entries_in(Arithmetic const& arithmetic) {
    std::vector<CatalogueEntry> const* const own = entries_at_run_time(arithmetic.name, "");
    std::vector<CatalogueEntry const*> out;
    for (CatalogueEntry const& entry : own ? *own : catalogue())
        if (entry.arithmetic == &arithmetic) out.push_back(&entry);
    return out;
}

std::vector<CatalogueEntry const*> one_entry_each() {
    std::vector<CatalogueEntry const*> out;
    for (CatalogueEntry const& entry : catalogue())
        if (std::ranges::find(out, entry.variant, &CatalogueEntry::variant) == out.end()) out.push_back(&entry);
    return out;
}

std::optional<Family> family_of_variant(std::string_view name) {
    for (CatalogueEntry const* const entry : one_entry_each())
        if (entry->variant == name) return entry->family;
    return name == OrderRecursive<double>::name ? std::optional(OrderRecursive<double>::family) : std::nullopt;
}

std::vector<VariantForm> const& variant_forms() {
    static std::vector<VariantForm> const all = [] {
        constexpr Index size = 3, rows = 10;
        Records records{.psi = Matrix<double>(size, rows), .y = Vector<double>(rows), .names = {}};
        Seed seed{1};
        for (double& x : records.psi.reshaped()) x = seed.bell();
        for (double& y : records.y) y = seed.bell();
        std::vector<VariantForm> out;
        for (CatalogueEntry const* const entry : one_entry_each()) {
            CatalogueEntry const* const in_double = find_entry(entry->variant);
            if (!in_double || !find_entry(entry->variant, "float")) continue;
            auto const filter = in_double->make({.size = size}, Seed{1});
            filter->update_block(records, 0, rows);
            Stored<double> const stored = filter->stored_in_double();
            bool const triangle = stored.F.isUpperTriangular(0) || stored.F.isLowerTriangular(0);
            out.push_back({entry->variant, stored.quantity, stored.form, triangle, entry->block == 1});
        }
        return out;
    }();
    return all;
}

}  // namespace rlslab
