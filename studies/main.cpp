// The rlslab program: list what there is, compare variants on data, identify systems, run studies.
#include "commands.hpp"
#include "study.hpp"

#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace rlslab {
namespace {

void run_list(bool json) {
    nlohmann::ordered_json out = {{"variants", nlohmann::ordered_json::array()},
                                  {"arithmetics", nlohmann::ordered_json::array()},
                                  {"studies", nlohmann::ordered_json::array()}};
    std::string text = "variants                  propagates    no prior  rows at once  in\n";
    std::vector<Entry const*> variants;
    for (Entry const& e : catalogue())
        if (std::none_of(variants.begin(), variants.end(), [&](Entry const* v) { return v->variant == e.variant; }))
            variants.push_back(&e);
    for (Entry const* v : variants) {
        std::vector<std::string_view> in;
        for (Entry const& e : catalogue())
            if (e.variant == v->variant) in.push_back(e.arithmetic->name);
        text += fmt::format("  {:<23} {:<13} {:<9} {:<13} {}\n", v->variant, v->propagates,
                            v->starts_without_prior ? "yes" : "no", v->block,
                            in.size() == arithmetics().size() ? "every arithmetic" : fmt::format("{}", fmt::join(in, ", ")));
        out["variants"].push_back({{"name", v->variant},
                                   {"propagates", v->propagates},
                                   {"starts_without_prior", v->starts_without_prior},
                                   {"rows_at_once", v->block},
                                   {"arithmetics", in}});
    }
    text += "\narithmetics               bits  digits  exponents                      rounding\n";
    for (Arithmetic const& s : arithmetics()) {
        char const* const rounding = s.stochastic ? "stochastic" : "nearest";
        text += fmt::format("  {:<23} {:>4}  {:>6.1f}  {:<29}  {}\n", s.name, s.digits, s.decimal_digits(),
                            fmt::format("{} ... {}", s.min_exp, s.max_exp), rounding);
        out["arithmetics"].push_back({{"name", s.name},
                                      {"digits", s.digits},
                                      {"min_exp", s.min_exp},
                                      {"max_exp", s.max_exp},
                                      {"rounding", rounding}});
    }
    text += "\nstudies\n";
    for (Study const* study : studies()) {
        text += fmt::format("  {:<23} {}\n", study->name, study->question);
        out["studies"].push_back({{"name", study->name}, {"question", study->question}});
    }
    print(json ? out.dump(2) + '\n' : text);
}

}  // namespace

Command list_command(CLI::App& app) {
    auto const json = std::make_shared<bool>(false);
    CLI::App* const listing = app.add_subcommand("list", "Variants, arithmetics, studies.");
    listing->add_flag("--json", *json, "JSON");
    return {listing, [json] {
                run_list(*json);
                return 0;
            }};
}

namespace {

int run(int argc, char** argv) {
    CLI::App app("Which variant of recursive least squares can you trust, on your data, in your arithmetic, at what price?",
                 "rlslab");
    app.set_version_flag("--version", "rlslab " RLSLAB_VERSION);
    std::vector<Command> const commands{compare_command(app), study_command(app), identify_command(app), simulate_command(app),
                                        excitation_command(app), list_command(app)};
    std::string names;
    for (size_t i = 0; i < commands.size(); ++i)
        names += (i == 0 ? "" : i + 1 < commands.size() ? ", " : " or ") + commands[i].app->get_name();
    try {
        app.parse(argc, argv);
    } catch (CLI::Success const& success) {
        std::ostringstream text;
        app.exit(success, text, text);
        print(text.str());
        return 0;
    } catch (CLI::ExtrasError const&) {
        bool const own = !app.remaining(false).empty();    // the program's, not its command's
        std::string const word = printable(own ? app.remaining(false).front() : app.remaining(true).front());
        auto const asked = own ? commands.end() : std::ranges::find_if(commands, [](Command const& c) { return c.app->parsed(); });
        if (own && !word.starts_with("-"))
            throw InputError(fmt::format("no command \"{}\": expected {} (rlslab --help tells more)", word, names));
        throw InputError((word.starts_with("-") ? fmt::format("no option \"{}\"", word) : fmt::format("\"{}\" is one word too many", word)) +
                         (asked == commands.end() ? " (rlslab --help)" : fmt::format(" (rlslab {} --help)", asked->app->get_name())));
    } catch (CLI::ParseError const& error) {
        std::string const text = error.what();
        if (size_t const at = text.find(": At Most 1 required"); at != text.npos) throw InputError(printable(text.substr(0, at), 200) + ": expected once, found again");
        throw InputError(printable(text, 200));
    }
    for (Command const& command : commands)
        if (command.app->parsed()) return command.run();
    throw InputError(fmt::format("expected a command: {} (rlslab --help tells more)", names));
}

}  // namespace
}  // namespace rlslab

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);    // a closed pipe is then an error like any other, not a silent death
    try {
        return rlslab::run(argc, argv);
    } catch (std::bad_alloc const&) {
        std::fputs("rlslab: out of memory\n", stderr);
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab: %s\n", error.what());
    }
    return 2;
}
