// Any words as a command line: understood, or refused in one printable line; nothing is run.
#include "tests/fuzz/fuzz.hpp"

#include "src/lab/program/commands.hpp"

namespace rlslab::fuzz {
using namespace program;
using namespace report;

void take(std::string_view bytes) {
    std::vector<std::string> words;
    for (std::size_t from = 0; from < bytes.size() && words.size() < 64;) {  // a word a line
        std::size_t const to = std::min(bytes.find('\n', from), bytes.size());
        std::string word(bytes.substr(from, to - from));
        word.resize(std::min(word.size(), word.find('\0')));  // as a program is given them
        words.push_back(std::move(word));
        from = to + 1;
    }
    auto const outcome = [&] {
        try {
            return parse(words) ? std::string() : std::string("nothing to run");
        } catch (InputError const& error) {
            return one_line(error);
        }
    };
    expect(outcome() == outcome(), "the same twice");
}

}  // namespace rlslab::fuzz
