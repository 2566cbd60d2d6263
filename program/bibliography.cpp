// From a page of literature to BibTeX. A source's words stand in one order: authors, title, venue and year, DOI, what
// was read of it, and in brackets where it is used.
#include "program/bibliography.hpp"

#include "report/revision.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <regex>

namespace rlslab::program {

extern char const* const literature;  // docs/literature.md from section 6 on; written by CMake

namespace {

std::vector<std::string> entries() {
    std::vector<std::string> out;
    std::string_view rest = literature;
    while (!rest.empty()) {
        size_t const end = std::min(rest.find('\n'), rest.size());
        std::string_view const line = rest.substr(0, end);
        if (line.starts_with("- ")) out.emplace_back(line.substr(2));
        else if (line.starts_with("  ") && !out.empty()) out.back() += " " + std::string(line.substr(2));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return out;
}

/// Takes the match off the end, or the beginning, of the text and returns its first group; "" where there is none.
std::string taken(std::string& text, std::string const& pattern) {
    std::smatch m;
    if (!std::regex_search(text, m, std::regex(pattern))) return "";
    std::string const out = m[1];
    text = m.prefix().str() + m.suffix().str();
    return out;
}

Source source_from(std::string const& entry) {
    Source out{.text = entry, .for_ = {}};
    std::string rest = entry;
    std::string names = taken(rest, " *\\((`[^)]*`)\\)\\.?$");
    for (std::string one; !(one = taken(names, "`([^`]*)`")).empty();) out.for_.push_back(one);
    out.doi = taken(rest, " ?doi:([^ ]*[^ .])\\.?");
    taken(rest, "( ?No DOI known\\.)");
    out.note = taken(
        rest, " ((?:Cited, not read|Abstract|Abstracts|Documented|Listing|Program|Pages|Data|Script|A port)\\b.*)$");
    // Authors end with an initial, or an organisation with the first sentence.
    out.author = taken(
        rest, "^((?:(?:, (?:& )?)?[^,.]+, (?:(?:[A-Z]|Å)\\.[ -]?)+(?:(?=,)|(?= ?[A-Z0-9\"])))+(?:, et al\\.)?) ?");
    if (out.author.empty()) out.author = taken(rest, "^([^.]*)\\. ");
    while (out.author.ends_with(' ')) out.author.pop_back();
    out.title = taken(rest, "^((?:[^.]|\\.[^ ])*)\\. ");
    if (taken(out.title, " \\((title from memory)\\)$") != "") out.note = "Title from memory. " + out.note;
    while (rest.ends_with(' ') || rest.ends_with('.')) rest.pop_back();
    out.venue = rest;
    std::smatch year;
    if (std::regex_search(rest, year, std::regex(".*\\b((?:18|19|20)[0-9]{2})\\b"))) out.year = year[1];
    return out;
}

std::string in_latex(std::string_view text) {
    std::string out;
    for (char const c : text) {
        if (c == '&' || c == '%' || c == '#' || c == '_') out += '\\';
        out += c;
    }
    return out;
}

std::string joined_by_and(std::string author) {
    author = std::regex_replace(author, std::regex(", et al\\."), " and others");
    author = std::regex_replace(author, std::regex(",? & "), " and ");
    return std::regex_replace(author, std::regex("\\., (?=[^.,]+, )"), ". and ");
}

std::string field(std::string_view name, std::string const& value, bool verbatim = false) {
    return value.empty() ? "" : fmt::format(",\n  {:<9} = {{{}}}", name, verbatim ? value : in_latex(value));
}

}  // namespace

std::string Source::key() const {
    std::string out;
    for (char const c : author.substr(0, author.find(',')))
        if (std::isalnum(static_cast<unsigned char>(c))) out += char(std::tolower(static_cast<unsigned char>(c)));
    return (out.empty() ? "source" : out) + year;
}

std::string Source::bibtex() const {
    std::smatch m;
    std::string out = field("author", joined_by_and(author)) + field("title", title);
    char const* kind = "misc";
    // "IEEE Trans. Signal Processing 41(1):20–30, 1993"
    if (std::regex_match(venue, m, std::regex("(.+) ([0-9]+)(?:\\(([^)]*)\\))?:([^,]+), [0-9]{4}"))) {
        kind = "article";
        out += field("journal", m[1]) + field("volume", m[2]) + field("number", m[3]) +
               field("pages", std::regex_replace(m[4].str(), std::regex("–"), "--"));
    } else {
        out += field("howpublished", std::regex_replace(venue, std::regex(", " + year + "$"), ""));
    }
    out += field("year", year) + field("doi", doi, true);
    return fmt::format("@{}{{{}{}\n}}\n", kind, key(), out);
}

std::vector<Source> const& sources() {
    static std::vector<Source> const list = [] {
        std::vector<Source> out;
        for (std::string const& entry : entries()) out.push_back(source_from(entry));
        return out;
    }();
    return list;
}

std::vector<Source const*> sources_of(std::string_view variant) {
    std::vector<Source const*> out;
    for (Source const& source : sources())
        if (std::ranges::find(source.for_, variant) != source.for_.end()) out.push_back(&source);
    return out;
}

std::string bibtex_of_program() {
    return fmt::format(
        "@software{{rlslab,\n"
        "  author    = {{{{The authors of rlslab}}}},\n"
        "  title     = {{rlslab: which variant of recursive least squares can be trusted}},\n"
        "  version   = {{{}}},\n"
        "  note      = {{revision {}}}\n"
        "}}\n",
        report::version, in_latex(report::revision));
}

}  // namespace rlslab::program
