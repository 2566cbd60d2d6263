// What is refused, and with which line: tests/data/messages.txt. No other test fixes the English of messages.
#include "tests/common/program.hpp"

#include <map>

namespace {

TEST_F(Program, RefusesInTheseWords) {
    for (auto const& [name, text] :
         std::map<std::string, std::string>{{"text", "u,y\n1,2\n3,abc\n"},
                                            {"ragged", "u,y\n1,2\n3\n"},
                                            {"doubt", "u;y\n1,234;2\n2;3\n"},
                                            {"constant", "u,y\n" + rows(40, [](int) { return std::string("1"); })},
                                            {"empty", ""},
                                            {"short", "u,y\n1,2\n"},
                                            {"huge", "u,y\n1,2\n1e308,2\n"},
                                            {"gap", "u,y\n1,2\n,3\n4,5\n"},
                                            {"two", "u,v,y\n1,2,3\n2,1,4\n5,0,1\n7,3,3\n"},
                                            {"word", "t,u,y\n1,1,2\n2,3,1\nsoon,3,4\n4,2,2\n"},
                                            {"untimed", "t,u,y\n1,1,2\n2,3,1\n,3,4\n4,2,2\n"},
                                            {"twice", "t,u,y\n1,1,2\n2,3,1\n2,3,4\n4,2,2\n"}})
        write(name + ".csv", text);
    std::ifstream file(root + "/tests/data/messages.txt");
    std::map<std::string, std::string> short_for;  // at the beginning of a line
    int messages = 0;
    for (std::string line, expected; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        if (line[0] == '%' && line.substr(2, 3) == " = ") {
            short_for[line.substr(0, 2)] = line.substr(5);
        } else if (line.starts_with("$ ")) {
            std::getline(file, expected);
            Outcome const run = shell(line.substr(2));
            EXPECT_EQ(run.err, expected + "\n") << line;
            EXPECT_EQ(run.code, 2) << line;
            EXPECT_EQ(run.out, "") << line;
            ++messages;
        } else {
            if (auto const it = short_for.find(line.substr(0, 2)); it != short_for.end())
                line.replace(0, 2, it->second);
            size_t const bar = line.find("| ");
            ASSERT_NE(bar, line.npos) << line;
            refused(line.substr(0, bar), line.substr(bar + 2));
            ++messages;
        }
    }
    EXPECT_GE(messages, 150);
    for (auto const& made : fs::directory_iterator(folder))  // but by a study that is refused when it has begun
        EXPECT_TRUE(made.path().extension() == ".csv" || made.path().extension() == ".txt" ||
                    made.path().filename() == "begun")
            << made.path();
}

}  // namespace
