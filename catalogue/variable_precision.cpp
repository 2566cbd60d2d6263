// Every variant in significands of any length.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/instances.hpp>

#include <rlslab/arithmetic/arithmetics.hpp>

namespace rlslab {
namespace {

static_assert(std::tuple_size_v<Arithmetics> == RLSLAB_ARITHMETICS, "catalogue/CMakeLists.txt counts the arithmetics");

Instances any_length() {
    static Arithmetic arithmetic;  // entries point to it
    Instances out = instances<bits_index>();
    arithmetic = out.arithmetic;
    for (CatalogueEntry& entry : out.entries) entry.arithmetic = &arithmetic;
    return out;
}

}  // namespace

std::vector<CatalogueEntry> const& variable_precision_catalogue() {
    static Instances const all = any_length();
    return all.entries;
}

}  // namespace rlslab
