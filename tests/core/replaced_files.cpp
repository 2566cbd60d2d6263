// Files that are written completely or not at all, and what is no file.
#include "tests/common/files.hpp"

#include <rlslab/core/files.hpp>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rlslab {
namespace {

namespace fs = std::filesystem;

TEST(ReplaceFile, KeepsALinkAndReplacesWhatItNames) {
    files::Folder const folder;
    fs::path const link = folder.path / "link";
    fs::path const file = folder.file("old");
    fs::create_symlink(file.filename(), link);
    replace_file(link, "new");
    EXPECT_TRUE(fs::is_symlink(link));
    std::ifstream in(file);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "new");
}
TEST(ReplaceFile, KeepsALinkToNothing) {
    files::Folder const folder;
    fs::path const link = folder.path / "link";
    fs::create_symlink("new", link);
    replace_file(link, "text");
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_TRUE(fs::is_regular_file(folder.path / "new"));
}
TEST(ReplaceFile, TakesTheLongestName) {
    files::Folder const folder;
    fs::path const longest = folder.path / std::string(255, 'a');
    replace_file(longest, "text");
    EXPECT_EQ(fs::file_size(longest), 4U);
    EXPECT_THROW(replace_file(folder.path / std::string(256, 'a'), "text"), FileError);
    EXPECT_THROW(replace_file("", "text"), FileError);
}
/// As with a device: renamed over /dev/null by root, a file would take its place.
TEST(ReplaceFile, WritesIntoAPipe) {
    files::Folder const folder;
    fs::path const pipe = folder.path / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    int const reader = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);
    replace_file(pipe, "text");
    char text[8] = {};
    EXPECT_EQ(::read(reader, text, 8), 4);
    EXPECT_STREQ(text, "text");
    ::close(reader);
    EXPECT_TRUE(fs::is_fifo(pipe));
}

}  // namespace
}  // namespace rlslab
