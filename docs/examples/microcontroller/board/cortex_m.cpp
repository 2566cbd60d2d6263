// The board, where there is none: start-up of a Cortex-M and a terminal by way of the debugger (semihosting), for Arm's
// MPS2 boards as QEMU has them. A real board has its vendor's start-up code instead, and a serial port for a terminal.
#include <board.h>

#include <cstdint>
#include <cstring>

int main();

extern "C" {
extern std::uint32_t stack_top, data_in_flash, data_begin, data_end, bss_begin, bss_end;
using Function = void (*)();
extern Function const constructors_begin, constructors_end;
}

namespace {

/// A call of the debugger: what, and a pointer to what it needs.
std::uintptr_t debugger(std::uintptr_t what, void const* with) {
    register std::uintptr_t r0 asm("r0") = what;
    register void const* r1 asm("r1") = with;
    asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

std::uint32_t volatile& at(std::uintptr_t address) { return *reinterpret_cast<std::uint32_t volatile*>(address); }

/// The system's timer: 24 bits that count down, and how often it went through zero.
std::uint32_t volatile rounds = 0;
void count_round() { rounds = rounds + 1; }

void start() {
#ifdef __ARM_FP
    at(0xe000ed88) |= 0xfu << 20;  // CPACR: the floating-point unit is off after a reset
    asm volatile("dsb\n isb");
#endif
    std::memcpy(&data_begin, &data_in_flash, std::size_t(&data_end - &data_begin) * 4);
    std::memset(&bss_begin, 0, std::size_t(&bss_end - &bss_begin) * 4);
    for (Function const* construct = &constructors_begin; construct != &constructors_end; ++construct) (*construct)();
    at(0xe000e014) = 0xffffff;  // SYST_RVR: from the top
    at(0xe000e018) = 0;         // SYST_CVR
    at(0xe000e010) = 7;         // SYST_CSR: on, at the processor's clock, with an interrupt at zero
    stop(main());
}

/// A fault: undefined instruction, bus, division by zero, __builtin_trap().
void fault() {
    print("fault\n");
    stop(99);
}

struct Vectors {
    std::uint32_t* stack;
    Function handlers[15];
};
}  // namespace

extern "C" {
extern Vectors const vectors;
[[gnu::section(".vectors"), gnu::used]] constinit Vectors const vectors = {
    &stack_top,
    {start, fault, fault, fault, fault, fault, nullptr, nullptr, nullptr, nullptr, fault, fault, nullptr, fault,
     count_round}};
}

void print(char const* text) { debugger(0x04, text); }  // SYS_WRITE0
void stop(int code) {
    std::uint32_t const reason[] = {0x20026, std::uint32_t(code)};  // ADP_Stopped_ApplicationExit
    debugger(0x20, reason);                                         // SYS_EXIT_EXTENDED
    for (;;) {}
}
unsigned long ticks() {
    for (;;) {
        std::uint32_t const before = rounds, left = at(0xe000e018);
        if (before == rounds) return (before + 1) * 0x1000000ul - left;
    }
}

/// What a program of C++ refers to and never calls where it does not end.
extern "C" {
void* __dso_handle = nullptr;
int __aeabi_atexit(void*, void (*)(void*), void*) { return 0; }
[[noreturn]] void abort() {
    print("abort\n");
    stop(98);
}
/// A Problem can hold a P0 of any size, which would be freed: where there is no heap it holds none. There is no malloc
/// here, so that a program that asks for memory does not link.
void free(void* nothing) {
    if (nothing) abort();
}
}
