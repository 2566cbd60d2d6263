// Every variant in one arithmetic, behind the erased boundary. Compiled once for each RLSLAB_ARITHMETIC (an index into
// the list of arithmetics); the only place where the catalogue's filters are instantiated.
#include <rlslab/catalogue/instances.hpp>

#include <rlslab/catalogue/erase.hpp>

#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {

template <>
Instances instances<RLSLAB_ARITHMETIC>() {
    using T = ArithmeticAt<RLSLAB_ARITHMETIC>;
    Instances out{arithmetic_of<T>(), {}};
    for_each(Variants<T>{}, [&]<class F>() { out.entries.push_back(entry_of<F>(nullptr)); });
    return out;
}

}  // namespace rlslab
