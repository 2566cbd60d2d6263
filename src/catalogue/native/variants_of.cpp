// The eighteen dense variants in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/filter_of.hpp>
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/variants/variants.hpp>

namespace rlslab::native {
namespace {

using T = RLSLAB_NATIVE;

template <class F>
std::unique_ptr<Filter> filter_of(Problem<T> const& problem) {
    return std::make_unique<FilterOf<F>>([=] { return F(problem); });
}

}  // namespace

template <>
std::vector<Maker<T>> const& makers<T>() {
    static std::vector<Maker<T>> const all = [] {
        std::vector<Maker<T>> out;
        for_each(Variants<T>{}, [&]<class F>() { out.push_back({F::name, &filter_of<F>}); });
        return out;
    }();
    return all;
}

}  // namespace rlslab::native
