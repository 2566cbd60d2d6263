// The only place where guarded filters in float are compiled for studies.
#include "studies/adapt/watched_in.hpp"

namespace rlslab::studies {

MakeWatched watched_in_float(std::string_view variant, std::string_view policy) {
    return detail::watched_in<float>(variant, policy);
}

}  // namespace rlslab::studies
