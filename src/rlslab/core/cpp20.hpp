// A compiler older than C++20 gets one message. Included first by the headers that others are reached through.
#pragma once

#if __cplusplus < 202002L && (!defined(_MSVC_LANG) || _MSVC_LANG < 202002L)
#error "rlslab needs C++20: compile with -std=c++20"
#include <a compiler of C++20>  // is not there: the compiler stops here, before a thousand errors that follow
#endif
