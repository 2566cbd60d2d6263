// What is composed around each variant: options, and the composition that they describe.
#pragma once

#include <rlslab/catalogue/composition.hpp>
#include "src/lab/program/commands.hpp"

namespace rlslab::program {

struct CompositionArguments {
    std::string control, guard;
    int window = 0;
};

/// --control, --window and --guard. `arguments` outlives the command's run.
void define_composition(CLI::App& command, CompositionArguments& arguments);

/// The controls and what their numbers are, a line each, for the end of a help page.
std::string control_notes();

/// The composition they describe; a number that follows from the data is NaN. Throws InputError for names and numbers
/// that make no sense, and for what does not go together. `forgetting` is that of --forgetting.
Composition composition_of(CompositionArguments const& arguments, double forgetting);

}  // namespace rlslab::program
