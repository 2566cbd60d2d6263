// The fifteen dense variants in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/catalogue/native/filter_of.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {

template <>
std::vector<Maker<RLSLAB_NATIVE>> const& makers<RLSLAB_NATIVE>() {
    static std::vector<Maker<RLSLAB_NATIVE>> const all = [] {
        std::vector<Maker<RLSLAB_NATIVE>> out;
        for_each(Variants<RLSLAB_NATIVE>{}, [&]<class F>() {
            out.push_back({F::name, [](Problem<RLSLAB_NATIVE> const& problem) -> std::unique_ptr<Filter> {
                               return std::make_unique<FilterOf<F>>(F(problem));
                           }});
        });
        return out;
    }();
    return all;
}

}  // namespace rlslab::native
