// The board, where there is an operating system.
#include <board.h>

#include <cstdio>
#include <cstdlib>

void print(char const* text) { std::fputs(text, stdout); }
void stop(int code) { std::exit(code); }
unsigned long ticks() { return 0; }
