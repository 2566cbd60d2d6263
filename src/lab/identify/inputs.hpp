// Which order the inputs can identify.
#pragma once

#include "src/lab/identify/record.hpp"

namespace rlslab::identify {

struct InputCheck {
    Index supported;  ///< largest order that all inputs support, at most that of the widest structure
    std::vector<Excitation> excitation;  ///< of each input over the fitted part
    std::vector<Remark> remarks;
};
/// An input of m coefficients must be exciting of order m. Throws InputError if the structure is given and not
/// supported, or if order 1 is not.
InputCheck check_inputs(Record const& record, IdentifyOptions const& options, report::Progress const& progress);

}  // namespace rlslab::identify
