// Files of bytes in a list: saved states, cases for the targets of random bytes.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>

namespace rlslab::files {

/// What a list keeps, by name: a line each of a name, a blank, and bytes, with \n, \\ and \xHH for what is not
/// printable.
inline std::map<std::string, std::string> kept(std::filesystem::path const& list) {
    std::map<std::string, std::string> out;
    std::ifstream lines(list);
    for (std::string line; std::getline(lines, line);) {
        std::string& bytes = out[line.substr(0, line.find(' '))];
        for (size_t i = line.find(' ') + 1; i < line.size(); ++i) {
            if (line[i] != '\\') bytes += line[i];
            else if (line.at(++i) != 'x') bytes += line[i] == 'n' ? '\n' : line[i];
            else bytes += char(std::stoi(line.substr(i + 1, 2), nullptr, 16)), i += 2;
        }
    }
    return out;
}

}  // namespace rlslab::files
