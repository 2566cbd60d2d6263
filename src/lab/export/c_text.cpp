// The header of C.
#include "src/lab/export/export.hpp"
#include "src/lab/export/recording.hpp"
#include "src/lab/export/roll.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace rlslab::exporting {
namespace {

/// What a routine is written with.
struct Writer {
    Recording const& recording;
    bool in_double;
    std::map<int, std::string> names{};  ///< of arrays, and of variables
    std::string counters{};              ///< those that were used

    std::string number() const { return in_double ? "double" : "float"; }
    std::string type(Kind kind, std::string const& health) const {
        return kind == Kind::number ? number() : kind == Kind::truth ? "bool" : health;
    }

    std::string constant(Expression const& e, std::string const& prefix) const {
        static char const* const healths[] = {"SOUND", "UNDETERMINED", "INDEFINITE", "NONFINITE"};
        if (e.kind == Kind::truth) return e.constant != 0 ? "true" : "false";
        if (e.kind == Kind::health) return prefix + "_" + healths[int(e.constant)];
        double const x = e.constant;
        std::string const suffix = in_double ? "" : "f", cast = in_double ? "(double)" : "";
        if (std::isnan(x)) return cast + "NAN";
        if (std::isinf(x)) return (x < 0 ? "(-" : "(") + cast + "INFINITY)";
        // The fewest digits that are this number again.
        std::string const digits = in_double ? fmt::format("{}", x) : fmt::format("{}", float(x));
        return digits + (digits.find_first_of(".e") == digits.npos ? ".0" : "") + suffix;
    }
    std::string index(Affine const& affine, int depth) const {
        std::string out;
        for (int n = int(affine.strides.size()) - 1; n >= 0; --n) {
            int const stride = affine.strides[std::size_t(n)];
            if (stride == 0) continue;
            std::string const counter(1, char('i' + depth - 1 - n));
            std::string const term =
                std::abs(stride) == 1 ? counter : fmt::format("({} * {})", std::abs(stride), counter);
            out += out.empty() ? (stride < 0 ? "-" : "") + term : (stride < 0 ? " - " : " + ") + term;
        }
        if (out.empty()) return std::to_string(affine.base);
        if (out.front() == '-') return fmt::format("{} {}", affine.base, "- " + out.substr(1));
        if (affine.base != 0) out += fmt::format(" {} {}", affine.base < 0 ? '-' : '+', std::abs(affine.base));
        return out;
    }
    std::string ref(Ref const& r, int depth) const {
        std::string const& name = names.at(r.array);
        return name.back() == '[' ? name + index(r.index, depth) + "]" : name;
    }
    std::string text(Expression const& e, int depth, std::string const& prefix, bool inner = true) const {
        auto const arg = [&](int i) { return text(e.arguments[std::size_t(i)], depth, prefix); };
        auto const two = [&](char const* sign) {
            std::string const out = arg(0) + " " + sign + " " + arg(1);
            return inner ? "(" + out + ")" : out;
        };
        switch (e.op) {
            case Op::constant: return constant(e, prefix);
            case Op::load: return ref(e.ref, depth);
            case Op::add: return two("+");
            case Op::subtract: return two("-");
            case Op::multiply: return two("*");
            case Op::divide: return two("/");
            case Op::less: return two("<");
            case Op::less_equal: return two("<=");
            case Op::equal: return two("==");
            case Op::both: return two("&&");
            case Op::either: return two("||");
            case Op::negate: return "(-" + arg(0) + ")";
            case Op::opposite: return "(!" + arg(0) + ")";
            case Op::root:
                return fmt::format("{}({})", in_double ? "sqrt" : "sqrtf",
                                   text(e.arguments.front(), depth, prefix, false));
            case Op::choose: return fmt::format("({} ? {} : {})", arg(0), arg(1), arg(2));
            case Op::store: break;
        }
        throw std::logic_error("an expression that stores");
    }
    /// Lines of at most 120 letters, broken behind an operator.
    static std::string broken(std::string line, int indent) {
        std::string out;
        std::size_t const room = 110;
        while (line.size() > room) {
            std::size_t at = line.rfind(' ', room);
            if (at == line.npos || at <= std::size_t(indent) + 8) break;
            out += line.substr(0, at) + '\n';
            line = std::string(std::size_t(indent) + 8, ' ') + line.substr(at + 1);
        }
        return out + line + '\n';
    }
    std::string lines(std::vector<Item> const& items, int depth, int indent, std::string const& prefix) {
        std::string out;
        for (Item const& item : items) {
            std::string const margin(std::size_t(indent), ' ');
            if (!item.loops) {
                out += broken(margin + ref(item.target, depth) + " = " + text(item.value, depth, prefix, false) + ";",
                              indent);
                continue;
            }
            char const counter = char('i' + depth);
            if (counters.find(counter) == counters.npos) counters += counter;
            std::string const bound = index(item.count, depth);
            out += fmt::format("{0}for ({1} = 0; {1} < {2}; ++{1}) {{\n", margin, counter,
                               bound.find(' ') == bound.npos ? bound : "(" + bound + ")");
            out += lines(item.body, depth + 1, indent + 4, prefix) + margin + "}\n";
        }
        return out;
    }
};

void arrays_of(Expression const& e, std::map<int, bool>& read) {
    if (e.op == Op::load) read[e.ref.array] = true;
    for (Expression const& x : e.arguments) arrays_of(x, read);
}
void arrays_of(std::vector<Item> const& items, std::map<int, bool>& read, std::map<int, bool>& written) {
    for (Item const& item : items) {
        if (item.loops) {
            arrays_of(item.body, read, written);
        } else {
            arrays_of(item.value, read);
            written[item.target.array] = true;
        }
    }
}
bool uses(std::vector<Item> const& items, auto const& wanted) {
    auto const inside = [&](auto const& self, Expression const& e) -> bool {
        return wanted(e) || std::ranges::any_of(e.arguments, [&](Expression const& x) { return self(self, x); });
    };
    return std::ranges::any_of(items,
                               [&](Item const& i) { return i.loops ? uses(i.body, wanted) : inside(inside, i.value); });
}

std::string upper(std::string text) {
    for (char& c : text)
        if ('a' <= c && c <= 'z') c = char(c - 'a' + 'A');
    return text;
}

/// A routine's declarations and statements.
struct Body {
    std::string text;
    bool of_math;
};
Body body(Recording const& r, Exported const& what, int begin, int end, std::vector<int> const& kept, bool whole,
          std::map<int, std::string> names, std::string const& prefix, int indent) {
    Routine routine = lowered(r.tape, begin, end, kept, whole);
    if (what.loops) routine = fused(rolled(std::move(routine)), kept);
    Writer writer{.recording = r, .in_double = what.in_double, .names = std::move(names)};
    std::map<int, bool> read, written;
    arrays_of(routine.items, read, written);
    std::string declared;
    std::string const margin(std::size_t(indent), ' ');
    int own = 0;
    for (auto const& [array, is_written] : written)
        if (!writer.names.contains(array) && array < routine.variables) {
            std::string const name = fmt::format("w{}", own++);
            int const length = r.tape.lengths[std::size_t(array)];
            writer.names[array] = length == 1 ? name : name + "[";
            declared += length == 1 ? fmt::format("{}{} {};\n", margin, writer.number(), name)
                                    : fmt::format("{}{} {}[{}];\n", margin, writer.number(), name, length);
        }
    for (auto const& [array, is_read] : read)
        if (!writer.names.contains(array) && array < routine.variables)
            throw std::logic_error("a number is read that nobody wrote");
    std::map<Kind, std::vector<std::string>> variables;
    for (std::size_t v = 0; v < routine.kinds.size(); ++v) {
        Kind const kind = routine.kinds[v];
        char const letter = kind == Kind::number ? 'x' : kind == Kind::truth ? 't' : 'h';
        variables[kind].push_back(fmt::format("{}{}", letter, variables[kind].size()));
        writer.names[routine.variables + int(v)] = variables[kind].back();
    }
    std::string const lines = writer.lines(routine.items, 0, indent, prefix);
    for (auto const& [kind, list] : variables)
        for (std::string const& name : list)
            declared += fmt::format("{}{} {};\n", margin, writer.type(kind, what.name + "_health"), name);
    for (char const c : writer.counters) declared += fmt::format("{}int {};\n", margin, c);
    bool const of_math = uses(routine.items, [](Expression const& e) {
        return e.op == Op::root || (e.op == Op::constant && e.kind == Kind::number && !std::isfinite(e.constant));
    });
    return {declared + lines, of_math};
}

std::string bytes_text(std::vector<std::byte> const& bytes) {
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i % 16 == 0) out += i == 0 ? "    " : "\n    ";
        out += fmt::format("0x{:02x}u,{}", std::to_integer<int>(bytes[i]), i % 16 == 15 ? "" : " ");
    }
    while (out.ends_with(' ') || out.ends_with(',')) out.pop_back();
    return out;
}

}  // namespace

std::string c_header(Exported const& what) {
    std::string const misra = std::string("10.4 (health by ?:), ") +
                              (what.variant == "gentleman" ? "12.1 (?: in ?:), " : "") + "21.15 (memcpy)";
    Recording const r = recorded(what.variant, what.size, what.in_double);
    std::string const p = what.name, P = upper(p), number = what.in_double ? "double" : "float";
    std::map<int, std::string> names;
    std::string fields;
    std::vector<int> state;
    std::size_t state_bytes = r.head.size() + 4, memory = 0;
    for (Member const& m : r.state) {
        names[m.array] = "f->" + m.name + (m.listed ? "[" : "");
        fields += fmt::format("    {} {}{};\n", m.kind == Kind::number ? number : "bool", m.name,
                              m.listed ? fmt::format("[{}]", m.length) : "");
        state.push_back(m.array);
        std::size_t const each = m.kind == Kind::number ? (what.in_double ? 8u : 4u) : 1u;
        state_bytes += each * std::size_t(m.length);
        memory += each * std::size_t(m.length);
    }
    auto given = names;
    given[r.forgetting] = "lambda";
    given[r.variance] = "variance";
    given[r.valid] = "valid";
    Body const valid = body(r, what, r.begun, r.made, {r.valid}, false, given, P, 4);
    Body const start = body(r, what, r.begun, r.made, state, true, given, P, 8);
    auto row = names;
    row[r.psi] = "psi[";
    row[r.y] = "y";
    row[r.innovation] = "step.innovation";
    row[r.residual] = "step.residual";
    row[r.gamma] = "step.gamma";
    row[r.health] = "step.health";
    std::vector<int> after = state;
    for (int const out : {r.innovation, r.residual, r.gamma, r.health}) after.push_back(out);
    Body const update = body(r, what, r.made, r.updated, after, false, row, P, 4);
    Body theta{};
    if (r.theta >= 0) {
        auto solved = names;
        solved[r.theta] = "theta[";
        theta = body(r, what, r.updated, r.solved, {r.theta}, false, solved, P, 4);
    }
    bool const of_math = valid.of_math || start.of_math || update.of_math || theta.of_math;
    std::string put, get;
    for (Member const& m : r.state) {
        std::string const each = m.kind == Kind::number ? "number" : "truth",
                          size = m.kind == Kind::number ? (what.in_double ? "8" : "4") : "1";
        for (auto* const out : {&put, &get}) {
            bool const puts = out == &put;
            std::string const place = "f->" + m.name + (m.listed ? "[i]" : "");
            std::string const call = puts ? fmt::format("{}_put_{}(&bytes[at], {});", p, each, place)
                                          : fmt::format("{} = {}_{}_at(&bytes[at]);", place, p, each);
            std::string const margin = puts ? "    " : "        ";
            *out += m.listed ? fmt::format("{0}for (i = 0u; i < {1}u; ++i) {{\n{0}    {2}\n{0}    at += {3}u;\n{0}}}\n",
                                           margin, m.length, call, size)
                             : fmt::format("{0}{1}\n{0}at += {2}u;\n", margin, call, size);
        }
    }
    bool const truths = std::ranges::any_of(r.state, [](Member const& m) { return m.kind == Kind::truth; });
    std::string const word = what.in_double ? "uint64_t" : "uint32_t";
    int const each = what.in_double ? 8 : 4;
    std::string out = fmt::format(
        R"c(// Recursive least squares: {variant}, {d} parameters, in {number}. Written by
//
//   {made_by}
//
// from the variant's page, by running it with a scalar that records its operations. Write it again instead of changing
// it. C99 or C++; no heap, no recursion, no goto{math}. A filter takes {memory} bytes.
//
//   static {p} filter;
//   {p}_init(&filter, 0.99{f}, 1000.0{f})    begins: lambda, and c^2 of P0 = c^2 I
//   {p}_update(&filter, psi, y)    takes a row of {d} numbers and its output, and returns a {p}_step
//
// Where a step's health is not {P}_SOUND, theta, K and P may not be used.
//
// The bits are those of the C++ filter while each operation is rounded once, to nearest, and subnormal numbers are
// kept. gcc reads no STDC pragma against fusing: -std=c99 does not fuse, with -std=gnu99 and in C++ functions are
// compiled with fp-contract=off and are then not inlined. -std=c99 -ffp-contract=fast leaves other bits.
//
// Rules of MISRA C:2012 that cppcheck's addon finds broken: {misra}.
#ifndef {P}_H
#define {P}_H

#include <float.h>
{include_math}#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math hides infinities and NaN, and changes the order of operations"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD != 0)
#error "operations are kept longer than their type: other bits (x87: -mfpmath=sse)"
#endif
#if {mantissa}
#error "a {number} is no IEEE {number}"
#endif
#if defined(__clang__) || !defined(__GNUC__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__cplusplus) || !defined(__STRICT_ANSI__)
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#endif

typedef enum {{ {P}_SOUND, {P}_UNDETERMINED, {P}_INDEFINITE, {P}_NONFINITE }} {p}_health;

// Squares are stored by columns.
typedef struct {{
{fields}}} {p};

typedef struct {{
    {number} innovation; // y - psi'theta before the row
    {number} residual;   // and after it
    {number} gamma;      // lambda / (lambda + psi'P psi)
    {p}_health health;
}} {p}_step;

// False: not 0 < lambda <= 1, or not 0 < variance; f is as it was.
static inline bool {p}_init({p} *f, {number} lambda, {number} variance) {{
    bool valid;
{valid}    if (valid) {{
{start}    }}
    return valid;
}}

// psi is no part of f.
static inline {p}_step {p}_update({p} *f, const {number} psi[{d}], {number} y) {{
    {p}_step step;
{update}    return step;
}}
)c",
        fmt::arg("p", p), fmt::arg("P", P), fmt::arg("variant", what.variant), fmt::arg("d", what.size),
        fmt::arg("number", number), fmt::arg("made_by", what.made_by), fmt::arg("f", what.in_double ? "" : "f"),
        fmt::arg("math", of_math ? (what.in_double ? ", no libm but sqrt" : ", no libm but sqrtf") : ", no libm"),
        fmt::arg("include_math", of_math ? "#include <math.h>\n" : ""), fmt::arg("memory", memory),
        fmt::arg("fields", fields), fmt::arg("valid", valid.text), fmt::arg("start", start.text),
        fmt::arg("update", update.text), fmt::arg("misra", misra),
        fmt::arg("mantissa", what.in_double ? "defined(DBL_MANT_DIG) && (DBL_MANT_DIG != 53)"
                                            : "defined(FLT_MANT_DIG) && (FLT_MANT_DIG != 24)"));
    if (r.theta >= 0)
        out += fmt::format(R"c(
// Solves for theta.
static inline void {p}_theta(const {p} *f, {number} theta[{d}]) {{
{theta}}}
)c",
                           fmt::arg("p", p), fmt::arg("number", number), fmt::arg("d", what.size),
                           fmt::arg("theta", theta.text));
    out += fmt::format(
        R"c(
// The state in the bytes of rlslab's format (docs/state.md): C++ goes on from them, and this from C++'s.
#define {P}_STATE_BYTES {size}u

static const uint8_t {p}_head[{head_size}] = {{
{head}
}};

static inline uint32_t {p}_checksum(const uint8_t *bytes, uint32_t count) {{
    uint32_t rest = 0xffffffffu;
    uint32_t i;
    uint32_t bit;
    for (i = 0u; i < count; ++i) {{
        rest ^= bytes[i];
        for (bit = 0u; bit < 8u; ++bit) {{
            rest = ((rest & 1u) != 0u) ? ((rest >> 1) ^ 0xedb88320u) : (rest >> 1);
        }}
    }}
    return ~rest;
}}
static inline void {p}_put_number(uint8_t *to, {number} x) {{
    {word} bits;
    {word} i;
    (void)memcpy(&bits, &x, sizeof bits);
    for (i = 0u; i < {each}u; ++i) {{
        to[i] = (uint8_t)((bits >> (8u * i)) & 0xffu);
    }}
}}
static inline {number} {p}_number_at(const uint8_t *from) {{
    {word} bits = 0u;
    {number} x;
    {word} i;
    for (i = 0u; i < {each}u; ++i) {{
        bits |= (({word})from[i]) << (8u * i);
    }}
    (void)memcpy(&x, &bits, sizeof x);
    return x;
}}
{truths}
static inline void {p}_save(const {p} *f, uint8_t bytes[{P}_STATE_BYTES]) {{
    uint32_t sum;
    uint32_t at = {head_size}u;
    uint32_t i;
    (void)memcpy(bytes, {p}_head, {head_size}u);
{put}    sum = {p}_checksum(bytes, at);
    for (i = 0u; i < 4u; ++i) {{
        bytes[at + i] = (uint8_t)((sum >> (8u * i)) & 0xffu);
    }}
}}
// False: no state of this variant, arithmetic and size, or a damaged one; f is as it was.
static inline bool {p}_load({p} *f, const uint8_t bytes[{P}_STATE_BYTES]) {{
    const uint32_t sum = {p}_checksum(bytes, {P}_STATE_BYTES - 4u);
    bool valid = memcmp(bytes, {p}_head, {head_size}u) == 0;
    uint32_t at = {head_size}u;
    uint32_t i;
    for (i = 0u; i < 4u; ++i) {{
        valid = valid && (bytes[({P}_STATE_BYTES - 4u) + i] == (uint8_t)((sum >> (8u * i)) & 0xffu));
    }}
    if (valid) {{
{get}    }}
    return valid;
}}

#if defined(__GNUC__) && !defined(__clang__) && (defined(__cplusplus) || !defined(__STRICT_ANSI__))
#pragma GCC pop_options
#endif
#endif
)c",
        fmt::arg("p", p), fmt::arg("P", P), fmt::arg("size", state_bytes), fmt::arg("head_size", r.head.size()),
        fmt::arg("head", bytes_text(r.head)), fmt::arg("number", number), fmt::arg("word", word),
        fmt::arg("each", each), fmt::arg("put", put), fmt::arg("get", get),
        fmt::arg("truths", !truths ? ""
                                   : fmt::format(R"c(static inline void {0}_put_truth(uint8_t *to, bool x) {{
    *to = x ? 1u : 0u;
}}
static inline bool {0}_truth_at(const uint8_t *from) {{
    return *from != 0u;
}}
)c",
                                                 p)));
    return out;
}

}  // namespace rlslab::exporting
