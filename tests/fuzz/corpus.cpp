// Feeds each case of a corpus, a list of tests/common/kept.hpp, to a target: an ordinary test, with any compiler.
// `corpus_csv FILE FOLDER` writes them into a folder, where libFuzzer begins.
#include "tests/common/kept.hpp"

#include <cstddef>
#include <cstdio>

extern "C" int LLVMFuzzerTestOneInput(unsigned char const* data, std::size_t size);

int main(int count, char** arguments) {
    auto const all = rlslab::files::kept(arguments[1]);
    for (auto const& [name, bytes] : all) {
        std::fprintf(stderr, "%s\n", name.c_str());  // the last named is the one that fails
        if (count > 2) std::ofstream(std::filesystem::path(arguments[2]) / name, std::ios::binary) << bytes;
        else LLVMFuzzerTestOneInput(reinterpret_cast<unsigned char const*>(bytes.data()), bytes.size());
    }
    std::printf("%zu cases\n", all.size());
    return all.empty() ? 1 : 0;
}
