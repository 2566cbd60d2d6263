// What a program here needs from its machine.
#pragma once

/// Writes the text to where the board's debugger, or the terminal, shows it.
void print(char const* text);

/// Ends the program with an exit code.
[[noreturn]] void stop(int code);

/// Ticks of the processor's clock so far, modulo 2^32; 0 where it is not asked for them.
unsigned long ticks();
