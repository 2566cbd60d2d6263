// Every variant in every arithmetic behind the type-erased interface, and the operations of a variant.
#pragma once

#include <rlslab/catalogue/any_filter.hpp>

#include <optional>

namespace rlslab {

/// The operations of one update, counted by the Counted scalar.
struct Operations {
    long additions = 0, multiplications = 0, divisions = 0, square_roots = 0;
    long total() const { return additions + multiplications + divisions + square_roots; }
};

/// The operations of one row: the update, and theta() after it for variants that solve for theta on request.
struct Cost {
    Operations update, theta;
    long total() const { return update.total() + theta.total(); }
};

/// Every pair of variant and arithmetic: arithmetics from the shortest to the longest, variants in the order of the
/// list.
std::vector<CatalogueEntry> const& catalogue();
/// A filter of somebody's own beside them: entry_of<F>(&arithmetic_named("float", "")) of
/// <rlslab/catalogue/erase.hpp>. Studies, figures and all that goes by name then know it. To be called from main,
/// before threads are: references into the catalogue end. Throws std::invalid_argument where that pair is there.
void add_to_catalogue(CatalogueEntry const& entry);
/// Every variant in VariablePrecision (<rlslab/arithmetic/variable_precision.hpp>), which rounds to the format set by
/// the `PrecisionScope` of the calling thread. It has no entry in the catalogue because its format is chosen at run
/// time. A filter keeps the format that was set when it was made.
std::vector<CatalogueEntry> const& variable_precision_catalogue();
/// The same in the format that the name gives: "p11", N bits with double's exponents; "p11:-14:15", with a range, as
/// Format has it; "p11:-14:15:stochastic" or ":toward_zero". Null for a name that does not begin with p and a number.
/// Throws InputError ("WHERE: ...") for one that does and is no format that double can emulate.
std::vector<CatalogueEntry> const* entries_at_run_time(std::string_view name, std::string_view where);
/// The entry of a variant in an arithmetic, of these or of the catalogue's; nullptr where there is none.
CatalogueEntry const* find_entry(std::vector<CatalogueEntry> const& entries, std::string_view variant,
                                 std::string_view arithmetic);
CatalogueEntry const* find_entry(std::string_view variant, std::string_view arithmetic = "double");
/// An entry of each variant of the catalogue, in the order of the list.
std::vector<CatalogueEntry const*> one_entry_each();
/// Of a variant of the catalogue, or of OrderRecursive; nullopt for another name.
std::optional<Family> family_of_variant(std::string_view name);
/// The arithmetics of the catalogue, in its order.
std::vector<Arithmetic> const& arithmetics();
/// One of these, or a format at run time. Throws InputError ("WHERE: ...") for another name.
Arithmetic const& arithmetic_named(std::string_view name, std::string_view where);
/// The entries of an arithmetic of either kind, in the order of the list of variants.
std::vector<CatalogueEntry const*> entries_in(Arithmetic const& arithmetic);
/// What a dense variant stores, as seen on a filter in double after some rows. Sparse ones, in double alone, are not
/// there.
struct VariantForm {
    std::string_view variant;
    Stored<double>::Quantity quantity;
    Stored<double>::Form form;
    bool triangle;     ///< F is one
    bool single_rows;  ///< takes rows one by one
};
/// In the order of the list.
std::vector<VariantForm> const& variant_forms();
/// The operations per row of a variant with `size` parameters in steady state (lambda = 0.99). A variant that takes
/// blocks solves for theta once for each block. nullopt for a variant whose arithmetic is in another library.
std::optional<Cost> cost(std::string_view variant, Index size);

}  // namespace rlslab
