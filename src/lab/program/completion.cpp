// Completions for bash and zsh. What may stand behind an option follows from its name and the name of its value.
#include <rlslab/catalogue/catalogue.hpp>
#include "src/lab/export/export.hpp"
#include "src/lab/program/definitions.hpp"
#include "src/lab/program/record_options.hpp"

#include <rlslab/studies/study.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <sstream>

namespace rlslab::program {
using namespace studies;
using report::in_quotes;
namespace {

struct Values {
    enum class Kind { none, words, files, folders, columns } kind = Kind::none;
    std::vector<std::string> words = {};
    bool list = false;  ///< several, with commas between
};

std::vector<std::string> split(std::string const& text, char at) {
    std::vector<std::string> out;
    std::istringstream in(text);
    for (std::string word; std::getline(in, word, at);) out.push_back(word);
    return out;
}

/// The name of each, once.
std::vector<std::string> names_of(auto const& all, auto const& name) {
    std::vector<std::string> out;
    for (auto const& one : all)
        if (std::string const its(std::invoke(name, one)); std::ranges::find(out, its) == out.end()) out.push_back(its);
    return out;
}

Values values_of(CLI::App const& command, CommandOption const& one) {
    using enum Values::Kind;
    bool const list = one.value.find(',') != std::string::npos;
    auto const variants = [] { return names_of(one_entry_each(), &CatalogueEntry::variant); };
    if (one.value.find('|') != std::string::npos) return {words, split(one.value, '|')};
    if (one.name == "--variant" && command.get_name() == "export")
        return {words, names_of(exporting::exported_variants(), std::identity())};
    if (one.name == "--variant" || one.name == "--variants") return {words, variants(), list};
    if (one.name == "--arithmetic" || one.name == "--arithmetics")
        return {words, names_of(arithmetics(), &Arithmetic::name), list};
    if (one.name == "--vary")
        return {words, names_of(sweep_factors, [](auto factor) { return fmt::format("{}=", factor); }), true};
    if (one.value == "NAME" && command.get_name() == "study")
        return {words, names_of(studies::studies(), &Study::name)};
    if (one.value.starts_with("VARIANT")) return {words, variants()};
    if (one.value == "EXAMPLE" || (one.value == "NAME" && command.get_name() == "example"))
        return {words, names_of(examples(), &Example::name)};
    if (one.value == "PART") return {words, {"variants", "arithmetics", "rounding", "studies"}};
    if (one.value == "COMMAND")
        return {words, names_of(shown_commands(*command.get_parent()), [](auto const* c) { return c->get_name(); })};
    if (one.value == "DIR") return {folders};
    if (one.value == "FILE") return {files};
    if (one.name == "--output" || one.name == "--regressors" || (one.name == "--input" && one.value != "SIGNAL"))
        return {columns, {}, list};
    return {};
}

std::string join(std::vector<std::string> const& words, char const* between) {
    return fmt::format("{}", fmt::join(words, between));
}

constexpr char const* bash_begin = R"bash(# bash completion for rlslab, written by `rlslab completion bash`.

# The names in the header of the first file on the line.
_rlslab_columns() {
    local word
    for word in "${COMP_WORDS[@]:2}"; do
        [[ -f $word && -r $word ]] || continue
        zcat -f -- "$word" 2>/dev/null | grep -am 1 '^[^#]' | tr -d '\000"\r' | tr ',;\t' '\n'
        return
    done
}

# Those of the words behind it that begin like what stands on the line, or in a list like what stands behind its last
# comma.
_rlslab_words() {
    local before="" word
    [[ $list && $current == *,* ]] && before=${current%,*},
    for word; do
        [[ $word && $word == "${current#"$before"}"* ]] && COMPREPLY+=("$before$(printf %q "$word")")
    done
    [[ $list ]] && compopt -o nospace 2>/dev/null
}

_rlslab() {
    local current=${COMP_WORDS[COMP_CWORD]} last=${COMP_WORDS[COMP_CWORD-1]} command="" word option="" list="" columns
    COMPREPLY=()
    # --option=value is three words of bash's.
    if [[ $current == = ]]; then option=$last current=""
    elif [[ $last == = ]]; then option=${COMP_WORDS[COMP_CWORD-2]}
    elif [[ $last == --* ]]; then option=$last
    fi
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        case $word in
            @commands@) command=$word; break ;;
        esac
    done
)bash";

constexpr char const* bash_end = R"bash(}
complete -F _rlslab rlslab
)bash";

/// The commands that words of a line may name: the program itself as "".
std::vector<CLI::App const*> all_of(CLI::App const& app) {
    std::vector<CLI::App const*> out = shown_commands(app);
    out.push_back(&app);
    return out;
}

std::string bash_case(Values const& values) {
    using enum Values::Kind;
    std::string const list = values.list ? "list=1; " : "";
    switch (values.kind) {
        case words: return list + "_rlslab_words " + join(values.words, " ");
        case columns: return list + "mapfile -t columns < <(_rlslab_columns); _rlslab_words \"${columns[@]}\"";
        case files: return "compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- \"$current\")";
        case folders: return "compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$current\")";
        case none: break;
    }
    return "";  // a number: no names
}

}  // namespace

std::string bash_completion(CLI::App const& app) {
    std::vector<std::string> names;
    for (CLI::App const* command : shown_commands(app)) names.push_back(command->get_name());
    std::string out = bash_begin;
    std::string const mark = "@commands@";
    out.replace(out.find(mark), mark.size(), join(names, "|"));
    // First what stands behind an option, then the options, then what stands alone.
    std::vector<std::string> behind, numbers, options, bare;
    for (CLI::App const* command : all_of(app)) {
        std::string const name = command == &app ? "" : command->get_name();
        std::vector<std::string> known;
        std::string alone = command == &app ? "_rlslab_words " + join(names, " ") : "";
        for (CommandOption const& one : options_of(*command)) {
            std::string const action = bash_case(values_of(*command, one));
            if (one.name.empty()) {
                alone = action;
                continue;
            }
            known.push_back(one.name);
            if (one.value.empty()) continue;
            std::string const pattern = in_quotes(name + ' ' + one.name);
            if (action.empty()) numbers.push_back(pattern);
            else behind.push_back(fmt::format("        {}) {}; return ;;\n", pattern, action));
        }
        options.push_back(fmt::format("        {}-*) _rlslab_words {} ;;\n", in_quotes(name + ' '), join(known, " ")));
        if (!alone.empty()) bare.push_back(fmt::format("        {}*) {} ;;\n", in_quotes(name + ' '), alone));
    }
    return out + "    case \"$command $option\" in\n" + join(behind, "") + "        " + join(numbers, " | ") +
           ") return ;;    # no names\n    esac\n" + "    case \"$command $current\" in\n" + join(options, "") +
           join(bare, "") + "    esac\n" + bash_end;
}

namespace {

/// Text inside a word of _arguments: brackets and colons end it.
std::string plain(std::string const& text) {
    std::string out;
    for (char const c : text) out += (c == '[' || c == ']' || c == ':' || c == '\\' ? "\\" : "") + std::string(1, c);
    return out;
}

std::string zsh_action(Values const& values) {
    using enum Values::Kind;
    switch (values.kind) {
        case words:
            return values.list ? "_sequence compadd - " + join(values.words, " ") : "(" + join(values.words, " ") + ")";
        case columns: return values.list ? "_sequence _rlslab_columns" : "_rlslab_columns";
        case files: return "_files";
        case folders: return "_files -/";
        case none: break;
    }
    return " ";
}

/// The words behind _arguments for one command, a line each.
std::string zsh_arguments(CLI::App const& command, std::string const& indent) {
    std::string out;
    for (CommandOption const& one : options_of(command)) {
        std::string const action = zsh_action(values_of(command, one));
        std::string spec;
        if (one.name.empty())
            spec = fmt::format("{}:{}:{}", one.many ? "*" : one.required ? "1" : "1:", plain(one.value), action);
        else if (one.value.empty()) spec = fmt::format("{}[{}]", one.name, plain(one.text));
        else spec = fmt::format("{}=[{}]:{}:{}", one.name, plain(one.text), plain(one.value), action);
        out += " \\\n" + indent + in_quotes(spec);
    }
    return out + '\n';
}

}  // namespace

std::string zsh_completion(CLI::App const& app) {
    std::string out = R"zsh(#compdef rlslab
# zsh completion for rlslab, written by `rlslab completion zsh`.

# The names in the header of the first file on the line.
_rlslab_columns() {
  local word
  local -a names
  for word in $words; do
    [[ -f $word && -r $word ]] || continue
    names=(${(f)"$(zcat -f -- $word 2>/dev/null | grep -am 1 '^[^#]' | tr -d '\000"\r' | tr ',;\t' '\n')"})
    compadd "$@" -a names
    return
  done
}

_rlslab() {
  local curcontext=$curcontext state line
  local -a commands
  typeset -A opt_args
)zsh";
    out += "  commands=(\n";
    for (CLI::App const* command : shown_commands(app))
        out += "    " + in_quotes(command->get_name() + ':' + plain(command->get_description())) + '\n';
    out += "  )\n  _arguments -C '1:command:->command' '*::argument:->argument'" + zsh_arguments(app, "    ");
    out +=
        "  case $state in\n    command) _describe command commands ;;\n    argument)\n      "
        "curcontext=${curcontext%:*:*}:rlslab-$words[1]:\n      case $words[1] in\n";
    for (CLI::App const* command : shown_commands(app))
        out += fmt::format("        {}) _arguments{}          ;;\n", command->get_name(),
                           zsh_arguments(*command, "          "));
    return out + "      esac ;;\n  esac\n}\n\n_rlslab \"$@\"\n";
}

Command completion_command(CLI::App& app) {
    auto const shell = std::make_shared<std::string>();
    CLI::App* const c =
        app.add_subcommand("completion", "What bash or zsh load to complete the words of rlslab.")->group("");
    c->add_option("SHELL", *shell, "bash or zsh")->required()->type_name("")->check([](std::string const& name) {
        return name == "bash" || name == "zsh" ? "" : "expected bash or zsh, found \"" + printable(name) + '"';
    });
    return {c, [shell, &app] {
                print(*shell == "bash" ? bash_completion(app) : zsh_completion(app));
                return 0;
            }};
}

}  // namespace rlslab::program
