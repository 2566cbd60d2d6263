// The only place where variants are compiled in significands that round at random.
#include "studies/definiteness/random_filters.hpp"

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::studies {

using T = RandomlyRounded;

CatalogueEntry const& randomly_rounded(std::string_view variant) {
    static Arithmetic const arithmetic = arithmetic_of<T>();
    static std::vector<CatalogueEntry> const entries{untimed_entry_of<Symmetric<T>>(&arithmetic),
                                                     untimed_entry_of<Joseph<T>>(&arithmetic),
                                                     untimed_entry_of<JosephRankTwo<T>>(&arithmetic),
                                                     untimed_entry_of<Ud<T>>(&arithmetic),
                                                     untimed_entry_of<Carlson<T>>(&arithmetic),
                                                     untimed_entry_of<InverseQr<T>>(&arithmetic),
                                                     untimed_entry_of<Qr<T>>(&arithmetic)};
    for (CatalogueEntry const& entry : entries)
        if (entry.variant == variant) return entry;
    throw std::logic_error("no such variant rounds at random");
}

}  // namespace rlslab::studies
