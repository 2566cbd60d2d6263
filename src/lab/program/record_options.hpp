// The record that a command works on: a file or an example, its columns and a model; what is composed around variants.
#pragma once

#include "src/lab/compare/compare.hpp"
#include "src/lab/program/commands.hpp"

#include <optional>
#include <span>
#include <string_view>

namespace rlslab::program {

struct RecordArguments {
    CsvFormat format = {};
    std::string file = {}, example = {}, output = {}, time = {};
    std::vector<std::string> inputs = {}, regressors = {};
    int order = 0, na = -1, nb = -1, delay = 0;
    bool intercept = false, detrend = false;
};

/// The words of --regressors, with "[k]" behind those that are names of columns and end in a bracket: a name of the
/// file goes before the syntax of lags.
std::vector<std::string> names_before_lags(std::vector<std::string> words, DataFile& file);
std::vector<std::string> names_before_lags(std::vector<std::string> words, std::vector<std::string> const& columns);

/// FILE or --example, and the options that name columns and a model. `arguments` outlives the command's run.
void define_record(CLI::App& command, RecordArguments& arguments);

/// The catalogue's name of an arithmetic that people call otherwise: half, single, fp32, f32, binary32, fp64, f64,
/// binary64, float16, fp16, f16, bf16. Any other name as it is.
std::string usual_arithmetic(std::string name);
/// --arithmetic, a list of such names.
void define_arithmetics(CLI::App& command, std::vector<std::string>& into, char const* help);

/// Records, and what their parameters multiply.
struct Question {
    Records records;
    compare::ModelText model;
    compare::InFile in_file;
    std::string sha256;  ///< of the file
    long rows = 0;       ///< of the file
};
/// The records the options describe; reads the file once the options make sense. `kept`: the file's columns, which are
/// read if it is empty and taken from it otherwise, for several models of the same columns; standard input can be read
/// but once. Throws InputError.
Question question_of(RecordArguments arguments, std::optional<Columns>* kept = nullptr);

/// Records that the program has in it, each with its model.
struct Example {
    std::string_view name, what, source;
    RecordArguments model;  ///< output, and input and order or regressors
    std::string_view text;  ///< CSV
};
std::span<Example const> examples();
/// Throws InputError with the names there are.
Example const& example_named(std::string const& name, std::string const& where);

/// The arguments with their example's model where they have none of their own. InputError for an example and a FILE.
RecordArguments with_example(RecordArguments arguments);

// --- what is composed around each variant ---------------------------------------------------------------------------

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
