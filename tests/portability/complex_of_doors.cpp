// What doors are compared with besides: fleets of complex numbers, by C++'s types.
#include "tests/portability/digest.hpp"

#include <rlslab/arithmetic/pack.hpp>

namespace rlslab::digests {

[[maybe_unused]] static bool const added =
    (verbs.insert({{"complex", output_fleets<Complex<Pack<float, 8>>, Complex<Pack<double, 8>>>}}), true);

}  // namespace rlslab::digests
