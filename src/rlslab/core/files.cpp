// A temporary file in the same folder is written, closed and renamed. Its name is stored where a signal handler can
// read it.
#include <rlslab/core/files.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace rlslab {
namespace {

[[noreturn]] void refuse(std::filesystem::path const& path, char const* what, int error) {
    throw FileError(printable(path.string(), 200) + ": cannot " + what + ": " + std::strerror(error), error);
}

char unfinished_name[PATH_MAX];
std::atomic<bool> unfinished = false;

/// false: errno says why.
bool write_all(int file, std::string_view text) {
    if (file < 0) return false;
    while (!text.empty()) {
        ssize_t const written = ::write(file, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return false;
        text.remove_prefix(size_t(written));
    }
    return true;
}
/// A device or a pipe takes the text itself: renamed over it, a file would take its place.
void write_into(std::filesystem::path const& path, std::string_view text) {
    int const file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    bool const written = write_all(file, text);
    int const why = errno;
    if ((file >= 0 && ::close(file) != 0) || !written) refuse(path, "write", written ? errno : why);
}

/// The temporary file, until it is renamed.
class Unfinished {
    std::string const name_;
    int file_;

public:
    explicit Unfinished(std::string name) : name_(std::move(name)) {
        // The name is stored first: a signal may come as soon as the file exists. A name too long for the handler is
        // too long for open.
        std::strncpy(unfinished_name, name_.c_str(), PATH_MAX - 1);
        unfinished = true;
        file_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    }
    ~Unfinished() {
        if (file_ >= 0) ::close(file_);
        if (unfinished) ::unlink(name_.c_str());
        unfinished = false;
    }
    Unfinished(Unfinished const&) = delete;
    Unfinished& operator=(Unfinished const&) = delete;

    /// false: errno says why.
    bool write(std::string_view text, bool on_disk) {
        if (!write_all(file_, text)) return false;
        if (on_disk && ::fsync(file_) != 0) return false;
        return ::close(std::exchange(file_, -1)) == 0;  // a quota or a network may report an error only here
    }
    bool begun() const { return file_ >= 0; }  ///< false: errno says why
    bool rename_to(std::filesystem::path const& path) {
        if (::rename(name_.c_str(), path.c_str()) != 0) return false;
        unfinished = false;
        return true;
    }
};

/// What the path names, also where nothing is there.
std::filesystem::path behind_links(std::filesystem::path target) {
    std::error_code error;
    for (int links = 0; links < 40 && is_symlink(std::filesystem::symlink_status(target, error)); ++links)
        target = target.parent_path() / std::filesystem::read_symlink(target, error);
    return target;
}
/// Two runs in one folder do not write into each other's.
std::string beside(std::filesystem::path const& target) {
    std::string const name = target.filename().string().substr(0, 200) + "." + std::to_string(::getpid()) + ".new";
    return target.parent_path() / name;
}
bool takes_text_itself(std::filesystem::path const& path) {
    std::error_code error;
    std::filesystem::file_status const there = std::filesystem::status(path, error);
    return exists(there) && !is_regular_file(there) && !is_directory(there);
}
std::mutex one_at_a_time;

}  // namespace

void create_folder(std::filesystem::path const& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) refuse(folder, "create", error.value());
}

void replace_file(std::filesystem::path const& path, std::string_view text, bool on_disk) {
    if (takes_text_itself(path)) return write_into(path, text);
    std::lock_guard const lock(one_at_a_time);
    std::filesystem::path const target = behind_links(path);
    Unfinished unfinished_file(beside(target));
    if (!unfinished_file.write(text, on_disk) || !unfinished_file.rename_to(target)) refuse(path, "write", errno);
    if (!on_disk) return;
    std::filesystem::path const folder = target.has_parent_path() ? target.parent_path() : ".";
    int const names = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (names < 0) return;  // the new name is there, and will be on the disk soon
    ::fsync(names);
    ::close(names);
}

void expect_replaceable(std::filesystem::path const& path) {
    if (takes_text_itself(path)) return;
    std::lock_guard const lock(one_at_a_time);
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) refuse(path, "write", EISDIR);
    if (!Unfinished(beside(behind_links(path))).begun()) refuse(path, "write", errno);
}

void remove_leftovers(std::filesystem::path const& folder) {
    std::error_code error;
    std::vector<std::filesystem::path> left;
    for (auto const& file : std::filesystem::directory_iterator(folder, error)) {
        std::string const name = file.path().filename().string();
        size_t const end = name.size() - std::min(name.size(), size_t(4)), point = name.rfind('.', end - (end > 0));
        if (name.substr(end) != ".new" || point == name.npos) continue;
        pid_t process = 0;
        auto const [rest, wrong] = std::from_chars(name.data() + point + 1, name.data() + end, process);
        if (wrong == std::errc() && rest == name.data() + end && process > 0 && ::kill(process, 0) != 0 &&
            errno == ESRCH)
            left.push_back(file.path());
    }
    for (auto const& path : left) std::filesystem::remove(path, error);
}

void remove_unfinished_file() noexcept {
    if (unfinished) ::unlink(unfinished_name);
}

}  // namespace rlslab
