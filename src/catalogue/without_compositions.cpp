// A catalogue without compositions and without formats at run time, for the program that is compiled in a fraction of
// the time.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/composed.hpp>

#include <rlslab/core/input_error.hpp>

namespace rlslab {

std::unique_ptr<ComposedFilter> composed(Composition const&, std::string_view, std::string_view,
                                         Problem<double> const&) {
    throw InputError("--control, --window, --guard, --digits, --certify: not in this program: use rlslab");
}

std::vector<CatalogueEntry> const* entries_at_run_time(std::string_view, std::string_view) { return nullptr; }

}  // namespace rlslab
