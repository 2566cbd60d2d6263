// The checks of citations.cpp: each function takes (tree, path, text) and returns the citations in the text that do not
// resolve.
#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace rlslab::citations {

using Faults = std::vector<std::string>;

inline std::string replaced(std::string const& text, char const* pattern, char const* by) {
    return std::regex_replace(text, std::regex(pattern), by);
}
/// Calls f(match) for every place where the pattern is found.
template <class F>
void each(std::string const& text, char const* pattern, F&& f) {
    std::regex const compiled(pattern);
    for (std::sregex_iterator i(text.begin(), text.end(), compiled), end; i != end; ++i) f(*i);
}
/// Line breaks within a paragraph, a comment or a string of literals become what a reader takes them for. A blank line
/// stays one.
inline std::string flattened(std::string const& text) {
    std::string const whole_strings = replaced(text, "\"[ \t]*\n[ \t]*\"", "");
    std::string const paragraphs = replaced(whole_strings, "\n([ \t]*(//[/!<]*|#+)?[ \t]*\n)+", "\n\n");
    return replaced(paragraphs, "([^\n])\n[ \t]*((//[/!<]*|#+|>)[ \t]*)?(?!\n)", "$1 ");
}
/// Without blocks between lines of ```.
inline std::string without_fences(std::string const& text) {
    std::string out;
    bool inside = false;
    for (size_t at = 0; at < text.size();) {
        size_t const end = std::min(text.find('\n', at), text.size() - 1) + 1;
        bool const fence = text.compare(at, 3, "```") == 0;
        if (!fence && !inside) out += text.substr(at, end - at);
        if (fence) inside = !inside;
        at = end;
    }
    return out;
}

/// A Markdown page: what can be cited in it.
struct Page {
    std::set<std::string> anchors;                        ///< <a id="..."> and GitHub's names of the headings
    std::map<std::string, std::set<std::string>> labels;  ///< by section: first cells of its tables (F1, law i)
    std::vector<std::string> sources;                     ///< the entries of docs/literature.md 6
};
inline std::string slug(std::string const& heading) {
    std::string out;
    for (char const c : replaced(heading, "<[^>]*>|\\]\\([^)]*\\)", ""))
        if (std::isalnum(static_cast<unsigned char>(c))) out += char(std::tolower(static_cast<unsigned char>(c)));
        else if (c == '-' || c == '_' || static_cast<unsigned char>(c) > 127) out += c;
        else if (c == ' ') out += '-';
    return out;
}
inline Page page(std::string const& text) {
    Page out;
    std::string section;
    static std::regex const id("<a id=\"([^\"]+)\">"), heading("^#+ +(.*)$"), cell("^\\| *(F?[0-9]+|[ivx]+) *\\|");
    std::istringstream lines(without_fences(text));
    for (std::string line; std::getline(lines, line);) {
        std::smatch m;
        if (std::regex_search(line, m, heading)) section.clear(), out.anchors.insert(slug(m[1]));
        if (std::regex_search(line, m, id)) out.anchors.insert(section = m[1]);
        if (std::regex_search(line, m, cell)) out.labels[section].insert(m[1]);
        if (section == "6" && line.starts_with("- ")) out.sources.push_back(line);
        else if (section == "6" && line.starts_with("  ") && !out.sources.empty()) out.sources.back() += line;
    }
    return out;
}

/// The files of a tree: all paths, and the text of those for readers.
struct Tree {
    std::set<std::string> paths;
    std::map<std::string, std::string> texts;
    std::map<std::string, Page> pages;               ///< of texts that are Markdown
    std::set<std::string> tests, studies, variants;  ///< GoogleTest's names; studies by name; variants by name
    size_t named(std::string const& ending) const {  ///< how many paths are this one, or end with it
        return size_t(std::ranges::count_if(
            paths, [&](auto const& path) { return path == ending || path.ends_with("/" + ending); }));
    }
};
inline void add(Tree& tree, std::string const& path, std::string const& text) {
    tree.paths.insert(path);
    tree.texts[path] = text;
    if (path.ends_with(".md")) tree.pages[path] = page(text);
    char const* const test = "(?:TEST|TEST_F|TEST_P|TYPED_TEST|TYPED_TEST_P|RC_GTEST_PROP)\\((\\w+), ?(\\w+)";
    if (path.starts_with("tests/"))
        each(text, test, [&](auto const& m) { tree.tests.insert(m[1].str() + "." + m[2].str()); });
    if (path.starts_with("studies/"))
        each(text, "\n    \\.name = \"(\\w+)\"", [&](auto const& m) { tree.studies.insert(m[1]); });
    each(text, "std::string_view name = \"(\\w+)\"", [&](auto const& m) { tree.variants.insert(m[1]); });
}
/// Every file but what a build, a run or git has put there.
inline Tree tree_of(std::filesystem::path const& root) {
    Tree tree;
    std::set<std::string> const read{".cpp", ".hpp", ".md", ".txt",  ".cmake", ".in",
                                     ".lua", ".css", ".js", ".json", ".py",    ".sh"};
    std::filesystem::recursive_directory_iterator entry(root), end;
    for (; entry != end; ++entry) {
        std::filesystem::path const& path = entry->path();
        std::string const name = path.filename(), relative = path.lexically_relative(root);
        if (entry->is_directory()) {
            bool const of_this_tree =
                name != ".git" && relative != "build" && relative != "out" && !exists(path / "CMakeCache.txt");
            if (!of_this_tree) entry.disable_recursion_pending();
            continue;
        }
        tree.paths.insert(relative);
        if (!read.contains(path.extension()) && relative != "lab" && relative != ".ci/run") continue;
        std::ifstream file(path);
        add(tree, relative, {std::istreambuf_iterator<char>(file), {}});
    }
    return tree;
}

/// Every number of "12 to 23, 26" as it stands at the text's beginning; `at` moves behind them. 3.9 to 3.11 are 3.9,
/// 3.10, 3.11.
inline std::vector<std::string> list(std::string_view text, size_t& at, char const* one) {
    std::regex const item(one), between("^(, | and | to )");
    std::vector<std::string> out;
    std::match_results<std::string_view::const_iterator> m;
    std::string separator;
    for (size_t from = at; std::regex_search(text.begin() + long(from), text.end(), m, item);) {
        std::string const next = m[1];
        if (separator == " to ") {
            size_t const digits = out.back().find_last_not_of("0123456789") + 1;
            if (digits < out.back().size() && next.substr(0, digits) == out.back().substr(0, digits))
                for (int i = std::stoi(out.back().substr(digits)) + 1, last = std::stoi(next.substr(digits)); i < last;
                     ++i)
                    out.push_back(next.substr(0, digits) + std::to_string(i));
        }
        out.push_back(next);
        at = from + size_t(m.length());
        if (!std::regex_search(text.begin() + long(at), text.end(), m, between)) break;
        separator = m[1];
        from = at + size_t(m.length());
    }
    return out;
}

/// A page of docs/ is there; a number behind it is an item or section of it; F1, law i, question 2 are rows of a table
/// there.
inline Faults places(Tree const& tree, std::string const&, std::string const& text) {
    Faults out;
    std::string const flat = flattened(text);
    each(flat, "docs/(\\w+\\.md)", [&](std::smatch const& m) {
        auto const cited = tree.pages.find("docs/" + m[1].str());
        if (cited == tree.pages.end()) return out.push_back("no page " + m[0].str());
        size_t at = size_t(m.position() + m.length());
        if (flat.compare(at, 1, " ") != 0) return;
        std::vector<std::string> const numbers = list(flat, ++at, "^([0-9]+(?:\\.[0-9]+)*)(?![\\w])");
        for (std::string const& number : numbers)
            if (!cited->second.anchors.contains(number)) out.push_back("no " + number + " in " + m[0].str());
        if (numbers.empty()) return;
        std::smatch word;
        std::string const behind = flat.substr(at, 20);
        bool const named = std::regex_search(behind, word, std::regex("^, (?:laws?|questions?) "));
        if (!named && !std::regex_search(behind, word, std::regex("^, (?=F[0-9])"))) return;
        at += size_t(word.length());
        auto const rows = cited->second.labels.find(numbers.back());
        for (std::string const& label : list(flat, at, named ? "^([ivx]+|[0-9]+)(?!\\w)" : "^(F[0-9]+)(?!\\w)"))
            if (rows == cited->second.labels.end() || !rows->second.contains(label))
                out.push_back("no row " + label + " in " + m[0].str() + " " + numbers.back());
    });
    return out;
}

/// Citations in a form that names no page of the tree, or a page that is not in it.
inline Faults old_forms(Tree const&, std::string const&, std::string const& text) {
    Faults out;
    std::string const flat = flattened(text);
    each(flat,
         "(^|[^\\w/])([Tt]heory|[Ll]iterature)(,|'s)? ((open )?(questions?|items?|lines?|sections?|laws?) )?F?[0-9]",
         [&](auto const& m) {
             bool const in_a_journals_name = m.prefix().str().ends_with("Inf.") && m[2] == "Theory";
             if (!in_a_journals_name) out.push_back("without its page: " + m[0].str());
         });
    each(flat, "\\b(science|style|DESIGN)\\.md\\b",
         [&](auto const& m) { out.push_back("not in the tree: " + m[0].str()); });
    each(flat,
         "\\brecal"
         "led\\b",
         [&](auto const& m) { out.push_back("no word of docs/literature.md's beginning: " + m[0].str()); });
    return out;
}

/// "Golub 1965", "Sayed & Kailath 1994", "Demmel et al. 2012": an entry of docs/literature.md 6 has the name before the
/// year, and the year.
inline Faults papers(Tree const& tree, std::string const& path, std::string const& text) {
    Faults out;
    std::vector<std::string> const& sources = tree.pages.at("docs/literature.md").sources;
    std::string flat = flattened(text);
    if (path == "docs/literature.md") flat.resize(std::min(flat.size(), flat.find("<a id=\"6\">")));
    std::set<std::string> const no_name{"January", "February", "March",     "April",   "May",      "June",
                                        "July",    "August",   "September", "October", "November", "December"};
    char const* const cited =
        "([A-Z\\x80-\\xff][a-zA-Z\\x80-\\xff]{2,})(?: et al\\.)? ((?:19|20)[0-9][0-9])(?!\\w|[.-]\\w)";
    each(flat, cited, [&](std::smatch const& m) {
        bool const in_capitals =
            std::ranges::none_of(m[1].str(), [](char c) { return c >= 'a' && c <= 'z'; });  // RFC 1952
        if (in_capitals || no_name.contains(m[1])) return;
        if (std::ranges::none_of(sources,
                                 [&](auto const& s) { return s.find(m[1]) != s.npos && s.find(m[2]) != s.npos; }))
            out.push_back("not in docs/literature.md 6: " + m[0].str());
    });
    return out;
}

/// [text](file#anchor) of a Markdown page: the file is in the tree, the anchor in the file; a number as text is the
/// anchor's.
inline Faults links(Tree const& tree, std::string const& path, std::string const& text) {
    Faults out;
    if (!path.ends_with(".md")) return out;
    std::string const flat = flattened(replaced(without_fences(text), "`[^`]*`", "code"));
    each(flat, "\\[([^\\]\\[]*)\\]\\(([^)\\s]*)\\)", [&](std::smatch const& m) {
        std::string const target = m[2];
        if (target.find("://") != target.npos || target.starts_with("mailto:")) return;
        size_t const hash = std::min(target.find('#'), target.size());
        std::string const folder = std::filesystem::path(path).parent_path();
        std::string const beside = (std::filesystem::path(folder) / target.substr(0, hash)).lexically_normal();
        std::string const file = hash == 0 ? path : beside;
        bool const is_folder =
            std::ranges::any_of(tree.paths, [&](auto const& p) { return p.starts_with(file + "/"); });
        if (!tree.paths.contains(file) && !is_folder) return out.push_back("no file for " + m[0].str());
        if (hash == target.size()) return;
        std::string const anchor = target.substr(hash + 1);
        auto const cited = tree.pages.find(file);
        if (cited == tree.pages.end() || !cited->second.anchors.contains(anchor))
            return out.push_back("no anchor for " + m[0].str());
        std::smatch number;
        std::string const words = m[1];
        if (std::regex_search(words, number, std::regex("^(?:docs/\\w+\\.md )?([0-9]+(?:\\.[0-9]+)*)$")) &&
            number[1] != anchor)
            out.push_back("says one number and goes to another: " + m[0].str());
    });
    return out;
}

/// `paths/in/backticks.cpp` of the pages that speak of the tree are in it; `name.hpp` is there once; `Suite.Test` is a
/// test; studies exist.
inline Faults names(Tree const& tree, std::string const& path, std::string const& text) {
    Faults out;
    if (!path.ends_with(".md") || path == "CHANGELOG.md") return out;  // which describes the past
    std::string const flat = flattened(without_fences(text));
    each(flat, "(One file, )?`<?([^`\\s<>]+)>?`", [&](std::smatch const& m) {
        std::string const name = m[2];
        std::smatch part;
        bool const to_be_written = m[1].matched, of_a_run = name.starts_with("out/");
        if (std::regex_match(name, std::regex("[\\w./-]+/[\\w.-]+\\.(cpp|hpp|md|csv|txt|cmake|svg|json|lua|css|js)"))) {
            std::string const behind = name.starts_with("rlslab/") ? name.substr(7) : "";
            bool const of_studies = behind.starts_with("studies/");  // <rlslab/studies/...> is that folder's engine
            bool const as_included = tree.named(of_studies ? "studies/engine/" + behind.substr(8) : behind) > 0;
            if (!to_be_written && !of_a_run && !as_included && !tree.paths.contains(name))
                out.push_back("no file " + name);
        } else if (std::regex_match(name, std::regex("[\\w-]+\\.(cpp|hpp)")) && tree.named(name) != 1) {
            out.push_back(name + " occurs " + std::to_string(tree.named(name)) + " times in the tree");
        } else if (std::regex_match(name, part, std::regex("([A-Z][a-z]\\w*\\.)([A-Z]\\w*|\\*)"))) {
            auto const of_suite = [&](auto const& test) { return test.starts_with(part[1].str()); };
            bool const found = part[2] == "*" ? std::ranges::any_of(tree.tests, of_suite) : tree.tests.contains(name);
            if (!found) out.push_back("no test " + name);
        }
    });
    each(flat, "Studies: ([^\n]*)", [&](std::smatch const& m) {
        each(m[1], "`([a-z][a-z_]*)`", [&](std::smatch const& name) {
            if (!tree.studies.contains(name[1]) && !tree.variants.contains(name[1]))
                out.push_back("no study " + name[1].str());
        });
    });
    return out;
}
/// "study gain_error" and "test Suite.Name" in what a study says of itself.
inline Faults names_in_code(Tree const& tree, std::string const& path, std::string const& text) {
    Faults out;
    if (!path.starts_with("studies/")) return out;
    std::string const flat = flattened(text);
    each(flat, "\\bstudy ([a-z]+(?:_[a-z]+)+)\\b", [&](std::smatch const& m) {
        if (!tree.studies.contains(m[1])) out.push_back("no " + m[0].str());
    });
    each(flat, "\\btests? ([A-Z]\\w+\\.[A-Z]\\w+)", [&](std::smatch const& m) {
        if (!tree.tests.contains(m[1])) out.push_back("no " + m[0].str());
    });
    return out;
}

/// A line wrapper that takes a raw string for code puts quote marks and a line break into it. So a formula has no quote
/// mark, and its source line ends only where the formula has a new row or wide space of its own.
inline Faults formulas(Tree const&, std::string const&, std::string const& text) {
    Faults out;
    std::string const begin =
                          "R\"tex"
                          "(",
                      end =
                          ")tex"
                          "\"";
    for (size_t at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) {
        size_t const last = text.find(end, at);
        if (last == text.npos) return out.push_back("a formula without an end"), out;
        std::string const tex = text.substr(at + begin.size(), last - at - begin.size());
        if (tex.find('"') != tex.npos) out.push_back("a quote mark in the formula " + tex);
        each(tex, "([^\n]*)\n", [&](std::smatch const& line) {
            bool const at_a_break = std::regex_search(line[1].str(), std::regex("(\\\\\\\\|\\\\q?quad|\\\\;)\\s*$"));
            if (!at_a_break) out.push_back("a line break in the formula behind " + line[1].str());
        });
    }
    return out;
}

inline Faults faults(Tree const& tree, std::string const& path, std::string const& text) {
    Faults out;
    for (auto const check : {places, old_forms, papers, links, names, names_in_code, formulas})
        std::ranges::copy(check(tree, path, text), std::back_inserter(out));
    return out;
}

}  // namespace rlslab::citations
