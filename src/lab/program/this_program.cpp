// rlslab's command line: what it is for, and its commands.
#include "src/lab/program/commands.hpp"

namespace rlslab::program {

ThisProgram const this_program{
    .question =
        "Which variant of recursive least squares can you trust, on your data, in your arithmetic, at what price?",
    .more = "rlslab help COMMAND has more about one of them, man rlslab all of it.",
    .answer_is_no =
        "a verdict changed or a verification failed (study), no arithmetic that was shown keeps enough digits "
        "(compare), the variant broke down (identify), the input identifies no model (excitation)",
    .commands =
        [](CLI::App& app) {
            return std::vector<Command>{compare_command(app),    sweep_command(app),     study_command(app),
                                        merge_command(app),      identify_command(app),  simulate_command(app),
                                        excitation_command(app), state_command(app),     list_command(app),
                                        example_command(app),    cite_command(app),      help_command(app),
                                        man_command(app),        completion_command(app)};
        },
};

}  // namespace rlslab::program
