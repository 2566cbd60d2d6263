// A study made at run time: the variants on a record, over values of forgetting, prior, arithmetic and model order.
#pragma once

#include <rlslab/studies/factors.hpp>

#include <rlslab/core/records.hpp>

namespace rlslab::program {

/// What --vary names, in the order of the table.
inline constexpr std::string_view sweep_factors[] = {"order", "forgetting", "prior", "arithmetic", "variant"};

struct Sweep {
    std::vector<studies::FactorValues> vary;
    int order = 0;                              ///< of the model that is given; 0: it has none
    int row_orders = 1;                         ///< the record's, and so many more, less one
    std::function<Records(int order)> records;  ///< of the model of this order; 0: of the one that is given
};

/// One trial for each combination of order, forgetting, prior, arithmetic and row order; in it every variant, against
/// the certified solution of the problem as that arithmetic stores it, at compare's checkpoints. Other orders of rows
/// only where forgetting = 1: elsewhere the order is part of the problem. Reads the records of all orders at once.
/// The caller names the data in Study::source. Throws InputError for a factor that does not exist or a value that it
/// cannot have.
studies::Study study_of(Sweep const& sweep, std::uint64_t seed);

}  // namespace rlslab::program
