// rlslab compare in float and double: what ./lab demo shows, from what that needs.
#include "program/commands.hpp"

#include <cstdio>

int main(int argc, char** argv) {
    CLI::App app{"rlslab compare in float and double alone", "rlslab_demo"};
    app.require_subcommand(1);
    rlslab::Command const comparing = rlslab::compare_command(app);
    try {
        app.parse(argc, argv);
        return comparing.run();
    } catch (CLI::ParseError const& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (std::exception const& error) {
        std::fprintf(stderr, "rlslab_demo: %s\n", error.what());
        return 2;
    }
}
