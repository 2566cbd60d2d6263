// The English of messages, which no other test fixes: tests/data/messages.txt.
#include "tests/common/program.hpp"

namespace {

TEST_F(Program, RefusesInTheseWords) {
    write("text.csv", "u,y\n1,2\n3,abc\n");
    write("ragged.csv", "u,y\n1,2\n3\n");
    write("doubt.csv", "u;y\n1,234;2\n2;3\n");
    write("constant.csv", "u,y\n" + rows(40, [](int) { return std::string("1"); }));
    std::ifstream file(root + "/tests/data/messages.txt");
    int messages = 0;
    for (std::string line, expected; std::getline(file, line);) {
        if (!line.starts_with("$ ")) continue;
        std::getline(file, expected);
        EXPECT_EQ(shell(line.substr(2)).err, expected + "\n") << line;
        ++messages;
    }
    EXPECT_GE(messages, 20);
}

}  // namespace
