// The file of literature, cut into its entries at blank lines.
#include "src/lab/program/bibliography.hpp"

#include "src/lab/report/provenance.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab::program {

extern char const* const literature;  // docs/literature.bib; written by CMake

namespace {

std::vector<std::string> split(std::string_view text, std::string_view between) {
    std::vector<std::string> out;
    for (size_t end = 0; end != text.npos; text.remove_prefix(std::min(end + between.size(), text.size())))
        out.emplace_back(text.substr(0, end = text.find(between)));
    return out;
}

Source source_from(std::string const& block) {
    size_t const entry = block.find('@');
    Source out{.for_ = {}, .bibtex = block.substr(entry)};
    if (entry > 3) out.for_ = split(std::string_view(block).substr(2, entry - 3), ", ");
    if (!out.bibtex.ends_with('\n')) out.bibtex += '\n';
    return out;
}

}  // namespace

std::vector<Source> const& sources() {
    static std::vector<Source> const list = [] {
        std::vector<Source> out;
        for (std::string const& block : split(literature, "\n\n")) out.push_back(source_from(block));
        return out;
    }();
    return list;
}

std::vector<Source const*> sources_of(std::string_view name) {
    std::vector<Source const*> out;
    for (Source const& source : sources())
        if (std::ranges::find(source.for_, name) != source.for_.end()) out.push_back(&source);
    return out;
}

std::string bibtex_of_program() {
    return fmt::format(
        "@software{{rlslab,\n"
        "  author    = {{{{The authors of rlslab}}}},\n"
        "  title     = {{rlslab: which variant of recursive least squares can be trusted}},\n"
        "  version   = {{{}}},\n"
        "  year      = {{" RLSLAB_YEAR
        "}},\n"
        "  note      = {{revision {}}}\n"
        "}}\n",
        report::version, report::revision);
}

}  // namespace rlslab::program
