// What the library is: its version, its lists of names, its defaults.
#include "bindings/c/border.hpp"

using namespace rlslab;
using namespace rlslab::c;

namespace {

/// The names of both are literals: they end in a zero.
char const* from(std::span<std::string_view const> names, std::size_t place) {
    return place < names.size() ? names[place].data() : nullptr;
}
char const* numbered(std::string_view (*name_of)(std::int32_t), std::size_t count, std::size_t place) {
    return place < count ? name_of(std::int32_t(place)).data() : nullptr;
}

}  // namespace

int rlslab_abi(void) { return RLSLAB_ABI; }
char const* rlslab_version(void) { return RLSLAB_VERSION; }
char const* rlslab_message(void) { return message(); }

char const* rlslab_name(int list, std::size_t place) {
    char const* name = nullptr;
    guarded([&] {
        switch (list) {
            case RLSLAB_VARIANTS: name = from(native::variants(), place); break;
            case RLSLAB_ARITHMETICS: name = from(native::arithmetics(), place); break;
            case RLSLAB_GUARDS: name = from(native::guards(), place); break;
            case RLSLAB_CONTROLS: name = from(native::controls(), place); break;
            case RLSLAB_HEALTHS: name = numbered(native::name_of_health, 4, place); break;
            case RLSLAB_SIGNALS: name = numbered(native::name_of_signal, 6, place); break;
        }
    });
    return name;
}

rlslab_status rlslab_defaults(rlslab_options* options, std::size_t bytes) {
    if (!options) return null_among({{"options", options}});
    if (rlslab_status const status = has_bytes(bytes)) return status;
    native::Options const o;
    *options = {};
    options->bytes = bytes;
    options->forgetting = o.forgetting;
    options->prior_variance = o.prior_variance;
    options->largest_variance = o.largest_variance;
    options->innovation = o.innovation;
    options->least_noise = o.least_noise;
    options->asymmetry = o.asymmetry;
    return RLSLAB_OK;
}
