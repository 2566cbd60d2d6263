// What a program here needs from its machine: in C or in C++.
#ifndef BOARD_H
#define BOARD_H

#ifdef __cplusplus
extern "C" {
#endif

// Writes the text to where the board's debugger, or the terminal, shows it.
void print(char const *text);

// Ends the program with an exit code.
#ifdef __cplusplus
[[noreturn]]
#endif
void stop(int code);

// Ticks of the processor's clock so far, modulo 2^32; 0 where it is not asked for them.
unsigned long ticks(void);

#ifdef __cplusplus
}
#endif

#endif
