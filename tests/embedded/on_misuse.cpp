// What a program does on misuse where exceptions are compiled out.
#include <rlslab/core/misuse.hpp>

#include <board.h>

void rlslab::on_misuse(char const* expected) {
    print("expected ");
    print(expected);
    print("\n");
    stop(3);
}
