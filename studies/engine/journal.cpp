// A line for each finished trial, with a checksum; an incomplete last line is removed.
#include "studies/engine/journal.hpp"

#include <rlslab/core/input_error.hpp>

#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sstream>
#include <sys/file.h>
#include <unistd.h>

namespace rlslab {
namespace {

[[noreturn]] void cannot_write(std::filesystem::path const& path) {
    throw InputError(fmt::format("{}: cannot write: {}", printable(path.string(), 200), std::strerror(errno)));
}

/// "CHECKSUM NUMBER|line|line...": tables hold no bar.
std::string line_of(size_t trial, std::vector<std::string> const& lines) {
    std::string body = std::to_string(trial);
    for (std::string const& line : lines) body += '|' + line;
    return fmt::format("{:016x} {}\n", hash(body), body);
}

bool read(std::string const& line, std::map<size_t, std::vector<std::string>>& into) {
    if (line.size() < 18 || line.substr(0, 16) != fmt::format("{:016x}", hash(line.substr(17)))) return false;
    std::istringstream parts(line.substr(17));
    std::string part;
    std::getline(parts, part, '|');
    std::vector<std::string>& lines = into[std::stoul(part)];
    lines.clear();
    while (std::getline(parts, part, '|')) lines.push_back(part);
    return true;
}

}  // namespace

FolderLock::FolderLock(std::filesystem::path const& folder)
    : file_(::open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (file_ < 0) cannot_write(folder / ".lock");
    if (::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(file_);
    throw InputError(fmt::format("{}: another run is writing there", printable(folder.string(), 200)));
}
FolderLock::~FolderLock() { ::close(file_); }

Journal::Journal(std::filesystem::path path, std::string const& key) : path_(std::move(path)) {
    std::string const head = fmt::format("{:016x}", hash(key));
    std::string kept = head + '\n', line;
    std::ifstream in(path_, std::ios::binary);
    if (std::getline(in, line) && line == head)
        while (std::getline(in, line) && !in.eof() && read(line, finished_)) kept += line + '\n';
    replace_file(path_, kept);  // without the line that was being written
    file_.open(path_, std::ios::binary | std::ios::app);
}

void Journal::add(size_t trial, std::vector<std::string> const& lines) {
    file_ << line_of(trial, lines) << std::flush;
    if (!file_) cannot_write(path_);
}

}  // namespace rlslab
