// A line for each finished trial, with a checksum; an incomplete last line is removed.
#include <rlslab/studies/journal.hpp>

#include "src/lab/report/messages.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

namespace rlslab::studies {
using report::refuse;
namespace {

[[noreturn]] void cannot_write(std::filesystem::path const& path, int why = errno) {
    refuse("{}: cannot write: {}", printable(path.string(), 200), std::strerror(why));
}

constexpr char between = '"';  // the lines of a trial: they are CSV in which no cell needs quotes

/// CHECKSUM NUMBER"line"line...
std::string line_of(size_t trial, std::vector<std::string> const& lines) {
    std::string body = std::to_string(trial);
    for (std::string const& line : lines) body += between + line;
    return fmt::format("{:016x} {}\n", hash(body), body);
}

bool read(std::string const& line, Trials& into) {
    if (line.size() < 18 || line.substr(0, 16) != fmt::format("{:016x}", hash(line.substr(17)))) return false;
    std::string_view rest = std::string_view(line).substr(17);
    size_t trial = 0;
    auto const [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), trial);
    rest.remove_prefix(size_t(end - rest.data()));
    if (error != std::errc() || (!rest.empty() && rest.front() != between)) return false;
    std::vector<std::string>& lines = into[trial];
    lines.clear();
    while (!rest.empty()) {
        rest.remove_prefix(1);
        lines.emplace_back(rest.substr(0, rest.find(between)));
        rest.remove_prefix(lines.back().size());
    }
    return true;
}

/// The head of the file, and its trials into `finished`; "" for a file that is no journal.
std::string read_file(std::filesystem::path const& path, Trials& finished) {
    std::ifstream in(path, std::ios::binary);
    std::string head, line;
    if (!std::getline(in, head) || in.eof()) return "";
    while (std::getline(in, line) && !in.eof() && read(line, finished)) {}
    return head;
}
std::string text_of(std::string const& head, Trials const& finished) {
    std::string out = head + '\n';
    for (auto const& [trial, lines] : finished) out += line_of(trial, lines);
    return out;
}

std::string head_of(std::string const& key) { return fmt::format("{:016x}", hash(key)); }

/// The study of a journal's file: NAME of NAME and of NAME.2-of-8; "" of any other file.
std::string study_of(std::filesystem::path const& path) {
    std::string const file = path.filename().string();
    size_t const point = file.find('.');
    return point == file.npos || file.find("-of-", point) != file.npos ? file.substr(0, point) : "";
}
/// The journals in a folder, the studies and parts in the order of their names.
std::vector<std::filesystem::path> journals(std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> out;
    std::error_code error;
    for (auto const& file : std::filesystem::directory_iterator(folder, error))
        if (file.is_regular_file(error) && !study_of(file.path()).empty() && file.path().extension() != ".new")
            out.push_back(file.path());
    std::ranges::sort(out);
    return out;
}

/// Waits for nobody. -1: another process holds it.
int locked(std::filesystem::path const& path, int how) {
    int const file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) cannot_write(path);
    if (::flock(file, how | LOCK_NB) == 0 || errno != EWOULDBLOCK) return file;
    ::close(file);
    return -1;
}

}  // namespace

std::string name_of(Part part) { return fmt::format("{}-of-{}", part.number, part.of); }

FolderLock::FolderLock(std::filesystem::path const& folder, Part part)
    : file_(locked(folder / ".lock", part.whole() ? LOCK_EX : LOCK_SH)) {
    if (file_ >= 0 && !part.whole()) {
        own_ = locked(folder / (".lock." + name_of(part)), LOCK_EX);
        if (own_ < 0) ::close(std::exchange(file_, -1));
    }
    if (file_ < 0) refuse("{}: another run is writing there", printable(folder.string(), 200));
}
FolderLock::~FolderLock() {
    ::close(file_);
    if (own_ >= 0) ::close(own_);
}

Journal::Journal(std::filesystem::path const& folder, std::string const& name, std::string const& key, Part part)
    : path_(folder / (part.whole() ? name : fmt::format("{}.{}", name, name_of(part)))) {
    std::string const head = head_of(key);
    std::vector<std::filesystem::path> parts;
    Trials own;
    for (auto const& path : journals(folder)) {
        if (study_of(path) != name) continue;
        Trials finished;
        if (read_file(path, finished) != head) continue;
        if (path != path_) parts.push_back(path);
        if (path == path_) own = finished;
        finished_.merge(std::move(finished));
    }
    replace_file(path_, text_of(head, part.whole() ? finished_ : own));  // without the line that was being written
    std::error_code error;
    if (part.whole())
        for (auto const& path : parts) std::filesystem::remove(path, error);
    file_.open(path_, std::ios::binary | std::ios::app);
}

void Journal::add(size_t trial, std::vector<std::string> const& lines) {
    if (file_ && !(file_ << line_of(trial, lines) << std::flush)) why_ = errno;
    if (!file_) cannot_write(path_, why_);
}

void forget_trials(std::filesystem::path const& folder, std::string const& name) {
    std::error_code error;
    for (auto const& path : journals(folder))
        if (study_of(path) == name) std::filesystem::remove(path, error);
}

Trials finished_trials(std::vector<std::filesystem::path> const& folders, std::string const& name,
                       std::string const& key) {
    Trials out;
    for (auto const& folder : folders)
        for (auto const& path : journals(folder)) {
            if (study_of(path) != name) continue;
            Trials finished;
            if (read_file(path, finished) != head_of(key))
                refuse("{}: expected trials of this program, of the budget and the seed that the parts have",
                       printable(path.string(), 200));
            out.merge(std::move(finished));
        }
    return out;
}

void write_journal(std::filesystem::path const& folder, std::string const& name, std::string const& key,
                   Trials const& finished) {
    replace_file(folder / name, text_of(head_of(key), finished));
}

}  // namespace rlslab::studies
