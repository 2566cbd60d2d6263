// A filter from its state alone: what is composed around it, and with which options, stands in the entries.
#include <rlslab/catalogue/native/composition.hpp>
#include <rlslab/catalogue/native/makers.hpp>

#include <rlslab/adapt/rules.hpp>
#include <rlslab/core/input_error.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace rlslab::native {
namespace {

using Name = std::string_view;

/// A number of rows; room for them is in the state, so that damage does not ask for memory.
Index rows_in(double value, std::size_t bytes) {
    if (!(0 <= value && value <= double(bytes)) || value != std::floor(value)) refuse("the state is damaged");
    return Index(value);
}
Index probes_in(double value) {
    if (!(1 <= value && value <= double(most_probes)) || value != std::floor(value)) refuse("the state is damaged");
    return Index(value);
}
bool same_in(Name arithmetic, double a, double b) {
    return arithmetic == ArithmeticTraits<float>::name ? float(a) == float(b) : a == b;
}

/// Fills the options entry by entry, from outside in.
class Reader {
    Saved& out_;
    std::size_t bytes_;
    std::string layer_ = {};
    Control const* control_ = nullptr;  // whose layer it is
    bool guarded_ = false;
    std::array<double, 4> actions_{};  // of the guard
    static constexpr std::array<Name, 4> actions{"on_outlier", "on_change", "on_windup", "on_breakdown"};

    /// NaN in place of a default.
    double unless(double usual, double value) const {
        return same_in(out_.arithmetic, usual, value) ? Options::unset : value;
    }
    void begin(Name name) {
        layer_ = name;
        guarded_ = guarded_ || name == "guard";
        control_ = nullptr;
        for_each(Rules<double>{}, [&]<class Rule>() {
            if (detail::rule_name<Rule>() == name) control_ = &control_named(Rule::name);
        });
        if (control_) {
            out_.options.control = control_->name;
            out_.control_numbers.assign(control_->parameters.size(), Options::unset);
        } else if (name == "fleet") {
            refuse("the state is of a fleet: one of as many filters of that size takes it (restore, load)");
        } else if (name != "guard" && name != "window" && name != "certified" && name != "outputs" &&
                   std::ranges::find(variants(), name) == variants().end()) {
            refuse("the state is one of \"" + printable(name) + "\" around " + std::string(out_.variant) +
                   ", which no filter by name has");
        }
    }
    void guard_option(Name name, double value) {
        GuardOptions<double> const usual;
        if (auto const at = std::ranges::find(actions, name); at != actions.end())
            actions_[std::size_t(at - actions.begin())] = value;
        if (name == "innovation") out_.options.innovation = unless(usual.innovation, value);
        if (name == "least_noise") out_.options.least_noise = unless(usual.least_noise, value);
        if (name == "asymmetry") out_.options.asymmetry = unless(usual.asymmetry, value);
        if (name == "noise_memory" && value != double(usual.noise_memory)) {
            if (!(1 <= value && value < 0x1p53)) refuse("the state is damaged");
            out_.options.noise_memory = Index(value);
        }
    }
    void control_option(Name name, double value) {
        for (std::size_t i = 0; i < control_->parameters.size(); ++i)
            if (control_->parameters[i].member == name)
                out_.control_numbers[i] = unless(control_->parameters[i].start, value);
    }

public:
    Reader(Saved& out, std::size_t bytes) : out_(out), bytes_(bytes) {}

    void take(StateEntry const& entry) {
        Name const name = StateHeader::text(entry.name);
        if (entry.kind == 'f') begin(name);
        if (entry.kind != 'o') return;
        if (control_) control_option(name, entry.value);
        else if (layer_ == "guard") guard_option(name, entry.value);
        else if (layer_ == "certified" && name == "probes") out_.options.certify = probes_in(entry.value);
        else if (layer_ == "outputs" && name == "outputs") out_.outputs = rows_in(entry.value, bytes_);
        else if (layer_ == "window" && name == "rows") out_.options.window = rows_in(entry.value, bytes_);
    }
    /// The policy with these actions.
    void find_guard() {
        if (!guarded_) return;
        for (NamedPolicy const& named : guard_policies) {
            GuardPolicy const& p = named.policy;
            if (actions_ == std::array{double(p.outlier), double(p.change), double(p.windup), double(p.breakdown)})
                out_.options.guard = named.name;
        }
        if (out_.options.guard.empty()) refuse("the state is of a guard whose policy has no name");
    }
};

std::unique_ptr<Filter> made(Saved const& saved) {
    if (saved.outputs > 0) refuse("the state is of several outputs: as many of that variant and size take it (load)");
    Options options = saved.options;
    options.control_numbers = saved.control_numbers;
    return make(saved.variant, saved.arithmetic, options);
}

/// That of a list of names, which stays; empty where there is none.
Name listed(std::span<Name const> names, Name name) {
    auto const at = std::ranges::find(names, name);
    return at == names.end() ? Name{} : *at;
}

}  // namespace

Saved saved(std::span<std::byte const> state) {
    StateHeader header;
    if (StateFault const fault = StateHeader::read(state, header); fault != StateFault::none)
        refuse(refusal_of(fault, state));
    Saved out{.variant = listed(variants(), StateHeader::text(header.variant)),
              .arithmetic = listed(arithmetics(), StateHeader::text(header.arithmetic))};
    if (out.variant.empty() || out.arithmetic.empty())
        refuse("the state is of " + printable(StateHeader::text(header.variant)) + " in " +
               printable(StateHeader::text(header.arithmetic)) + ", which no filter by name is");
    // Every variant keeps a matrix or more, so that damage to the size does not ask for its memory.
    std::size_t const number = out.arithmetic == ArithmeticTraits<float>::name ? sizeof(float) : sizeof(double);
    if (header.parameters == 0 || header.parameters * header.parameters > state.size() / number)
        refuse("the state is damaged");
    out.options.size = Index(header.parameters);

    auto const entries = entries_in(state);
    Reader reader(out, state.size());
    for (std::size_t at = 4; at < entries.size(); at += StateEntry::size)
        reader.take(StateEntry::read(entries.data() + at));
    reader.find_guard();
    while (!out.control_numbers.empty() && std::isnan(out.control_numbers.back())) out.control_numbers.pop_back();

    // Only the state's length says how many rows a guard keeps to rebuild from.
    if (NamedPolicy const* const named = find_policy(out.options.guard); named && named->policy.rebuilds()) {
        Index const d = out.options.size;
        out.options.rebuild_rows = 1;
        std::size_t const least = made(out)->state_size(), row = std::size_t(d + 1) * number;
        if (state.size() > least) out.options.rebuild_rows += Index((state.size() - least) / row);
        if (out.options.rebuild_rows == 10 * d) out.options.rebuild_rows = 0;
    }
    return out;
}

std::unique_ptr<Filter> from_state(std::span<std::byte const> state) {
    auto out = made(saved(state));
    out->load(state);
    return out;
}

}  // namespace rlslab::native
