// LaTeX as plain text: words for Greek letters, a/b for fractions, no backslash.
#include "src/lab/report/page.hpp"

#include <functional>
#include <map>
#include <sstream>

namespace rlslab::report {
namespace {

/// Commands by their names, as text.
std::map<std::string, std::string, std::less<>> const& words() {
    static auto const list = [] {
        std::map<std::string, std::string, std::less<>> out{
            {"quad", "  "}, {"qquad", "    "}, {"|", "‖"}, {"\\", ";  "}, {",", " "}, {";", " "},
            {":", " "},     {" ", " "},        {"!", ""},  {"{", "{"},    {"}", "}"}};
        std::istringstream left(
            "alpha α beta β gamma γ delta δ epsilon ε varepsilon ε zeta ζ eta η theta θ kappa κ lambda λ mu μ "
            "nu ν xi ξ pi π rho ρ sigma σ tau τ phi φ psi ψ omega ω Phi Φ Psi Ψ Sigma Σ Delta Δ Lambda Λ Theta Θ "
            "top ᵀ infty ∞ le ≤ leq ≤ ge ≥ geq ≥ ne ≠ neq ≠ ll ≪ gg ≫ approx ≈ sim ~ lesssim ≲ gtrsim ≳ propto ∝ "
            "pm ± cdot · times × to → rightarrow → Rightarrow ⇒ Longrightarrow ⟹ in ∈ sum Σ prod Π sqrt √ "
            "ldots … dots … cdots … lfloor ⌊ rfloor ⌋ ell ℓ partial ∂ ");
        for (std::string name, text; left >> name >> text;) out[name] = text;
        return out;
    }();
    return list;
}

/// Reads LaTeX from `at` on; writes text.
class Reader {
    std::string_view tex_;
    size_t at_ = 0;

    std::string command() {  // after the backslash
        size_t end = at_;
        while (end < tex_.size() && ((tex_[end] >= 'a' && tex_[end] <= 'z') || (tex_[end] >= 'A' && tex_[end] <= 'Z')))
            ++end;
        if (end == at_ && end < tex_.size()) ++end;
        std::string_view const name = tex_.substr(at_, end - at_);
        at_ = end;
        if (name == "frac" || name == "tfrac" || name == "dfrac") {
            std::string const over = argument(), under = argument();
            return grouped(over) + "/" + grouped(under);
        }
        if (name == "begin" || name == "end") return argument(), "";
        if (name == "sqrt") return "√" + grouped(argument());
        if (name == "hat") return argument() + "̂";
        if (name == "tilde") return argument() + "̃";
        if (name == "bar") return argument() + "̄";
        for (std::string_view const known :
             {"text", "mathrm", "mathbf", "operatorname", "underbrace", "overbrace", "mathit"})
            if (name == known) return argument();
        for (std::string_view const size : {"left", "right", "big", "Big", "bigl", "bigr", "Bigl", "Bigr", "Bigg", "rm",
                                            "bf", "limits", "displaystyle"})
            if (name == size) return "";
        if (name == "\n") return " ";
        auto const found = words().find(name);
        return found == words().end() ? std::string(name) : found->second;
    }
    /// A group without its braces, or one symbol.
    std::string argument() {
        while (at_ < tex_.size() && (tex_[at_] == ' ' || tex_[at_] == '\n')) ++at_;
        if (at_ >= tex_.size()) return "";
        if (tex_[at_] == '{') return ++at_, until_brace();
        if (tex_[at_] == '\\') return ++at_, command();
        size_t end = at_ + 1;
        while (end < tex_.size() && (static_cast<unsigned char>(tex_[end]) & 0xc0) == 0x80) ++end;
        std::string const out(tex_.substr(at_, end - at_));
        at_ = end;
        return out;
    }
    std::string until_brace() {
        std::string out;
        while (at_ < tex_.size() && tex_[at_] != '}') out += next();
        ++at_;
        return out;
    }
    std::string next() {
        char const c = tex_[at_++];
        if (c == '\\') return command();
        if (c == '{') return until_brace();
        if (c == '^' || c == '_') {
            std::string const of = argument();
            return of == "ᵀ" ? of : c + grouped(of);
        }
        if (c == '&' || c == '\n') return " ";
        if (c == '~') return " ";
        return std::string(1, c);
    }
    static std::string grouped(std::string const& text) {
        size_t symbols = 0;
        for (char const c : text) symbols += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
        bool const plain = text.find_first_of(" +-/=^,") == std::string::npos;
        return symbols <= 1 || plain ? text : "(" + text + ")";
    }

public:
    explicit Reader(std::string_view tex) : tex_(tex) {}
    std::string all() {
        std::string out;
        while (at_ < tex_.size())
            if (tex_[at_] == '}') ++at_;
            else out += next();
        return out;
    }
};

}  // namespace

std::string readable(std::string_view tex) {
    std::string out;
    for (char const c : Reader(tex).all())
        if (c != ' ' || (!out.empty() && !out.ends_with("  "))) out += c;
    while (out.ends_with(' ')) out.pop_back();
    return out;
}

}  // namespace rlslab::report
