// Feeds each case of a corpus to a target: an ordinary test, with any compiler. A corpus is a folder of files, or a
// file of lines: a case's name, a blank, and its bytes with \n, \\ and \xHH for what is not printable. `corpus_csv
// FILE FOLDER` writes them into a folder, where libFuzzer begins.
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(unsigned char const* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

std::string unescaped(std::string const& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\') out += text[i];
        else if (text.at(++i) != 'x') out += text[i] == 'n' ? '\n' : text[i];
        else out += char(std::stoi(text.substr(i + 1, 2), nullptr, 16)), i += 2;
    }
    return out;
}
std::map<std::string, std::string> cases(fs::path const& corpus) {
    std::map<std::string, std::string> out;
    if (!fs::is_directory(corpus)) {
        std::ifstream lines(corpus);
        for (std::string line; std::getline(lines, line);)
            out[line.substr(0, line.find(' '))] = unescaped(line.substr(line.find(' ') + 1));
    } else {
        for (auto const& file : fs::directory_iterator(corpus)) {
            std::ifstream stream(file.path(), std::ios::binary);
            out[file.path().filename()] = {std::istreambuf_iterator<char>(stream), {}};
        }
    }
    return out;
}

}  // namespace

int main(int count, char** arguments) {
    auto const all = cases(arguments[1]);
    for (auto const& [name, bytes] : all) {
        std::fprintf(stderr, "%s\n", name.c_str());  // the last named is the one that fails
        if (count > 2) std::ofstream(fs::path(arguments[2]) / name, std::ios::binary) << bytes;
        else LLVMFuzzerTestOneInput(reinterpret_cast<unsigned char const*>(bytes.data()), bytes.size());
    }
    std::printf("%zu cases\n", all.size());
    return all.empty() ? 1 : 0;
}
