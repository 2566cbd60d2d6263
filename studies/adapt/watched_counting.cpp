// The only place where guarded filters that count their operations are compiled.
#include "studies/adapt/watched_in.hpp"

#include <rlslab/arithmetic/counted.hpp>

namespace rlslab::studies {

MakeWatched watched_counting(std::string_view variant, std::string_view policy) {
    return detail::watched_in<Counted<double>>(variant, policy);
}

}  // namespace rlslab::studies
