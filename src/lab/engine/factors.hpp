// The factors of a study as a run has them: its own, or with other values; and what a study is, in words.
#pragma once

#include <rlslab/studies/run.hpp>

namespace rlslab::studies {

/// "kappa=1e2,1e4" from a command line, behind this option. Throws InputError for a text of another form.
FactorValues factor_values_from(std::string const& text, std::string_view option = "--set");

/// The study's factors at the budget, with the values of options.set and options.seeds. Throws InputError that lists
/// them for a name that is no factor of the study, and one that says what was expected for a value that a factor
/// cannot have:
///   a word     one of the study's own; where those are all variants of the catalogue, any variant; where they are
///              all arithmetics, any arithmetic
///   a number   finite; where all of the study's own are whole, positive, at least 0, below 1 or at most 1, it is so
///              too, and a whole number is at least the least of them
std::vector<Factor> factors_of(Study const& study, RunOptions const& options);

/// "variant = ud, qr; replicate = 1 ... 40": what a run changes; "" for none.
std::string changes_of(RunOptions const& options);
/// The words of a command line that ask for these changes: "--set variant=ud,qr --seeds 40"; "" for none.
std::string words_of_changes(RunOptions const& options);

/// The study's folder: "gain", "definiteness", "accuracy", "forgetting", "published", "adapt", "fast", "maps".
std::string_view subject_of(Study const& study);
/// Question, source, factors with their values at each budget, measures, claims with the kind and source of their
/// bands. Lines of at most `width` letters.
std::string described(Study const& study, size_t width);

/// How long a run takes here, from trials that a child process runs for about `seconds`.
struct TimeEstimate {
    size_t trials = 0, tried = 0;
    double of_one = 0;  ///< seconds, the mean of those tried; where none was finished, how long was waited for it
};
TimeEstimate estimated_time(Study const& study, RunOptions const& options, double seconds);

}  // namespace rlslab::studies
