// Records that the program has in it, each with its model.
#pragma once

#include "src/lab/program/record_options.hpp"

#include <span>
#include <string_view>

namespace rlslab::program {

struct Example {
    std::string_view name, what, source;
    RecordArguments model;  ///< output, and input and order or regressors
    std::string_view text;  ///< CSV
};
std::span<Example const> examples();
/// Throws InputError with the names there are.
Example const& example_named(std::string const& name, std::string const& where);

/// The arguments with the model of their example where they have none of their own. Throws InputError where there are
/// an example and a FILE.
RecordArguments with_example(RecordArguments arguments);

}  // namespace rlslab::program
