// headers VARIANT SIZE float|double NAME: what `rlslab export c` prints, without the rest of the program.
#include "src/lab/export/export.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

int main(int count, char** words) {
    if (count != 5) return 2;
    bool const in_double = std::string(words[3]) == "double";
    std::string const header = rlslab::exporting::c_header({.variant = words[1],
                                                            .size = std::atoi(words[2]),
                                                            .in_double = in_double,
                                                            .name = words[4],
                                                            .made_by = "rlslab export c"});
    return std::fputs(header.c_str(), stdout) < 0;
}
