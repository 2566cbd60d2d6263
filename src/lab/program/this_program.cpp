// rlslab's command line: what it is for, its commands, and those of them that are a few lines.
#include "src/lab/export/export.hpp"
#include "src/lab/program/bibliography.hpp"
#include "src/lab/program/definitions.hpp"
#include "src/lab/program/record_options.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/input/suggestion.hpp>
#include <rlslab/input/text.hpp>
#include <rlslab/state/state_file.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::program {
using namespace report;

namespace {

int run_cite(std::vector<std::string> const& variants) {
    std::vector<std::string_view> known;
    for (CatalogueEntry const* const v : one_entry_each()) known.push_back(v->variant);
    std::string out = bibtex_of_program();
    std::vector<Source const*> said;  // a source of two variants stands once
    for (std::string const& variant : variants) {
        expect_one_of(known, variant, "cite", "variant");
        for (Source const* source : sources_of(variant))
            if (std::ranges::find(said, source) == said.end()) said.push_back(source);
    }
    for (Source const* source : said) out += '\n' + source->bibtex;
    print(out);
    return 0;
}

}  // namespace

Command cite_command(CLI::App& app) {
    auto const variants = std::make_shared<std::vector<std::string>>();
    CLI::App* const c = app.add_subcommand("cite", "BibTeX of this program, and of the sources of variants.");
    c->footer(
        "Example:  rlslab cite ud joseph >> paper.bib\n\n"
        "The program is cited with its version and revision. A DOI stands only where one was found beside the title in "
        "a second place.\n\n"
        "Exit code: 0; 2 a name that is no variant.");
    OptionRow("VARIANT", *variants, "", "names of variants, as rlslab list shows them").define(*c);
    return {c, [variants] { return run_cite(*variants); }};
}

Command example_command(CLI::App& app) {
    auto const name = std::make_shared<std::string>();
    CLI::App* const c = app.add_subcommand("example", "Records to try this on, as CSV; without a name their list.");
    c->footer(
        "As a file:      rlslab example sales > sales.csv\n"
        "Without one:    rlslab compare --example longley\n\n"
        "compare and sweep take --example NAME in place of FILE, --output and a model.\n\n"
        "Exit code: 0; 2 a name that is no example.");
    c->add_option("NAME", *name, "the example to print")->type_name("");
    return {c, [name] {
                std::string text;
                if (!name->empty()) text = example_named(*name, "example").text;
                else
                    for (Example const& e : examples())
                        text += fmt::format("{:<12} {}\n", e.name,
                                            wrapped(fmt::format("{} ({})", e.what, e.source), 13, 13, help_width));
                print(text);
                return 0;
            }};
}

Command state_command(CLI::App& app) {
    auto const file = std::make_shared<std::string>();
    CLI::App* const c = app.add_subcommand("state", "What is in the file of a saved filter.");
    c->footer(
        "Example:  rlslab state controller.state\n\n"
        "Prints the variant, its arithmetic and number of parameters, what is around it (a guard, a window, a rule of "
        "forgetting), and their editions, options and counts of rows. C++ reads and writes such files with "
        "<rlslab/state/state_file.hpp>.\n\n"
        "Exit code: 0 a state; 2 a file that cannot be read, is no state, or is damaged.");
    OptionRow("FILE", *file, "", named("the name of a file"), "a state that was saved").required().define(*c);
    return {c, [file] {
                std::vector<std::byte> const bytes = detail::bytes_of(*file);
                try {
                    print(described_state(bytes));
                } catch (InputError const& error) {
                    detail::refuse_state(*file, error.what());
                }
                return 0;
            }};
}

namespace {

/// A name of C and C++: a letter first, then letters, digits and _; no keyword, and nothing that the header includes.
bool is_name_of_c(std::string_view name) {
    static std::string_view const taken =
        " alignas alignof and asm auto bitand bitor bool break case catch char class compl const constexpr continue "
        "decltype default delete do double double_t else enum EOF explicit export extern false float float_t for "
        "friend goto if inline int int8_t int16_t int32_t int64_t linux long main memcmp memcpy memset mutable "
        "namespace new noexcept not NULL nullptr operator or private protected public register restrict return short "
        "signed size_t sizeof sqrt sqrtf static struct switch template this thread_local throw true try typedef typeid "
        "typename typeof uint8_t uint16_t uint32_t uint64_t union unix unsigned using virtual void volatile while xor ";
    if (taken.find(fmt::format(" {} ", name)) != taken.npos) return false;
    auto const letter = [](char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z'); };
    return !name.empty() && name.size() <= 31 && letter(name.front()) &&
           std::ranges::all_of(name, [&](char c) { return letter(c) || c == '_' || ('0' <= c && c <= '9'); });
}

struct ExportOptions {
    std::string language, variant, arithmetic, name;
    long size = 0;
    bool unrolled = false;
};
int run_export(ExportOptions const& o) {
    expect_one_of({"c"}, o.language, "export", "language");
    expect_one_of(exporting::exported_variants(), o.variant, "--variant", "variant that is exported");
    expect_one_of({"float", "double"}, o.arithmetic, "--arithmetic", "arithmetic");
    if (!exporting::is_exported(o.variant, o.arithmetic == "double"))
        refuse("{} in {}: expected double, it sums in double there", o.variant, o.arithmetic);
    std::string const own = fmt::format("{}_{}_{}", o.variant, o.size, o.arithmetic),
                      name = o.name.empty() ? own : o.name;
    if (!is_name_of_c(name))
        refuse("--name: expected a letter, then letters, digits and _, 31 at most, no keyword, found \"{}\"",
               printable(name));
    std::string made_by =
        fmt::format("rlslab export c --variant {} --size {} --arithmetic {}", o.variant, o.size, o.arithmetic);
    if (name != own) made_by += " --name " + name;
    if (o.unrolled) made_by += " --unrolled";
    print(exporting::c_header({.variant = o.variant,
                               .size = int(o.size),
                               .in_double = o.arithmetic == "double",
                               .name = name,
                               .made_by = made_by,
                               .loops = !o.unrolled}));
    return 0;
}

}  // namespace

Command export_command(CLI::App& app) {
    auto const o = std::make_shared<ExportOptions>();
    CLI::App* const c = app.add_subcommand("export", "A filter as one header of C99, for firmware.");
    c->footer(
        "Example:  rlslab export c --variant ud --size 4 --arithmetic float --name motor > motor.h\n\n"
        "The header has a type, and functions that begin one, take a row, save and load: no heap, no libm but a square "
        "root. Forgetting and the prior's variance are arguments of motor_init. The bits and the saved bytes are those "
        "of the C++ filter. There is no guard in it.\n\n"
        "Exit code: 0; 2 what cannot be exported.");
    define(*c, {OptionRow("LANGUAGE", o->language, "", "c").required(),
                OptionRow("--variant", o->variant, "NAME",
                          fmt::format("{}; gentleman in double alone", fmt::join(exporting::exported_variants(), ", ")))
                    .required(),
                OptionRow("--size", o->size, "N", whole(1, exporting::largest_exported),
                          fmt::format("number of parameters, 1 to {}", exporting::largest_exported))
                    .required(),
                OptionRow("--arithmetic", o->arithmetic, "float|double", "its numbers").required(),
                OptionRow("--name", o->name, "NAME", "of the type, and before each function; default ud_4_float"),
                OptionRow("--unrolled", o->unrolled, "no loops: fewer instructions, more bytes")});
    return {c, [o] { return run_export(*o); }};
}

ThisProgram const this_program{
    .question =
        "Which variant of recursive least squares can you trust, on your data, in your arithmetic, at what price?",
    .more = "rlslab help COMMAND has more about one of them, man rlslab all of it.",
    .answer_is_no =
        "a verdict changed or a verification failed (study), no arithmetic that was shown keeps enough digits "
        "(compare), the variant broke down (identify), the input identifies no model (excitation)",
    .commands =
        [](CLI::App& app) {
            return std::vector<Command>{compare_command(app),    sweep_command(app),    study_command(app),
                                        merge_command(app),      identify_command(app), simulate_command(app),
                                        excitation_command(app), state_command(app),    export_command(app),
                                        list_command(app),       example_command(app),  cite_command(app),
                                        help_command(app),       man_command(app),      completion_command(app)};
        },
};

}  // namespace rlslab::program
