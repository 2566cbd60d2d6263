// rlslab_mpi: `mpirun rlslab_mpi study ...` deals the trials to the ranks; the first one then writes the tables.
#include "src/lab/program/run.hpp"

#include <cstdio>
#include <mpi.h>
#include <string>
#include <vector>

namespace {

using Words = std::vector<std::string>;

bool is_option(std::string const& word, std::string const& option) {
    return word == option || word.starts_with(option + "=");
}

/// Words that ranks refuse, as a message; "": none. The ranks are the parts, and start nothing anew while others run.
std::string refused(Words const& words) {
    if (words.empty() || words.front() != "study") return "expected rlslab_mpi study ...: other commands need no ranks";
    for (std::string const& word : words)
        for (char const* const option : {"--part", "--fresh"})
            if (is_option(word, option))
                return std::string(option) + ": does not go with ranks, which are the parts of a run";
    return "";
}
/// The words for one rank. Verdicts are recorded and compared at the end, by the first.
Words part_of(Words const& words, int rank, int ranks) {
    Words out;
    for (size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--record" || words[i] == "--against") ++i;
        else if (!is_option(words[i], "--record") && !is_option(words[i], "--against")) out.push_back(words[i]);
    }
    out.insert(out.end(), {"--part", std::to_string(rank + 1) + "/" + std::to_string(ranks), "--quiet"});
    return out;
}
bool asks_for_help(Words const& words) {
    for (std::string const& word : words)
        if (word == "-h" || word == "--help") return true;
    return false;
}

}  // namespace

int main(int argc, char** argv) {
    rlslab::program::prepare_process();
    MPI_Init(&argc, &argv);
    int rank = 0, ranks = 1, code = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    Words const words{argv + (argc > 0), argv + argc};
    if (std::string const why = refused(words); !why.empty() && !asks_for_help(words)) {
        if (rank == 0) std::fprintf(stderr, "rlslab: %s\n", why.c_str());
        code = 2;
    } else if (ranks > 1 && !asks_for_help(words)) {
        int const own = rlslab::program::run(part_of(words, rank, ranks), rank);
        MPI_Allreduce(&own, &code, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);  // behind it the journals are complete
    }
    if (code == 0 && rank == 0) code = rlslab::program::run(words);
    MPI_Finalize();
    return code;
}
