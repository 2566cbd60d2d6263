// The sparse variants behind the erased boundary: in binary64 alone, where the sparse libraries are.
#include <rlslab/catalogue/instances.hpp>

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/core/process.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {

std::vector<CatalogueEntry> sparse_entries() {
    std::vector<CatalogueEntry> out;
    for_each(Variants<double>{}, [&]<class F>() {
        if constexpr (std::is_void_v<AtSize<F, 2>>) out.push_back(entry_of<F>(nullptr));  // a class, and no template
    });
    return out;
}

}  // namespace rlslab
