// The only place where guarded filters in double are compiled for studies.
#include "studies/adapt/watched_in.hpp"

namespace rlslab::studies {

MakeWatched watched_in_double(std::string_view variant, std::string_view policy) {
    return detail::watched_in<double>(variant, policy);
}

}  // namespace rlslab::studies
