// What the compilers' vectors lack, as the processor's instructions: square roots of all numbers, loads of some, and
// whether a condition holds in all. By built-in functions, because <immintrin.h> takes half a second in each file.
// Included once for each instruction set, each time in a namespace of its own: no #pragma once.

/// The square root of each number of x, a vector of float or double.
template <class V>
[[gnu::always_inline]] inline V root_of_each(V x) {
#if defined(__clang__) && __has_builtin(__builtin_elementwise_sqrt)
    return __builtin_elementwise_sqrt(x);
#else
    constexpr bool is_double = sizeof(x[0]) == 8;
#ifdef __x86_64__
    if constexpr (sizeof(V) == 16 && is_double) return V(_mm_sqrt_pd(__m128d(x)));
    else if constexpr (sizeof(V) == 16) return V(_mm_sqrt_ps(__m128(x)));
    else if constexpr (sizeof(V) == 32 && is_double) return V(__builtin_ia32_sqrtpd256(x));
    else if constexpr (sizeof(V) == 32) return V(__builtin_ia32_sqrtps256(x));
#ifdef __clang__  // 4: rounded as the program asks
    else if constexpr (sizeof(V) == 64 && is_double) return V(__builtin_ia32_sqrtpd512(x, 4));
    else if constexpr (sizeof(V) == 64) return V(__builtin_ia32_sqrtps512(x, 4));
#else
    else if constexpr (sizeof(V) == 64 && is_double) return V(__builtin_ia32_sqrtpd512_mask(x, V{}, -1, 4));
    else if constexpr (sizeof(V) == 64) return V(__builtin_ia32_sqrtps512_mask(x, V{}, -1, 4));
#endif
#endif
    for (size_t i = 0; i < sizeof(V) / sizeof(x[0]); ++i) x[i] = std::sqrt(x[i]);
    return x;
#endif
}

/// Whether all bits of each number of the mask m are set. m: what a comparison of vectors of T gives.
template <class T, class M>
[[gnu::always_inline]] inline bool holds_in_all(M const& m) {
    bool out = true;
#ifdef __x86_64__
    typedef T Numbers __attribute__((vector_size(sizeof(M))));
    constexpr bool is_double = sizeof(T) == 8;
    if constexpr (sizeof(M) == 16 && is_double) return _mm_movemask_pd(__m128d(m)) == 3;
    else if constexpr (sizeof(M) == 16) return _mm_movemask_ps(__m128(m)) == 15;
    else if constexpr (sizeof(M) == 32 && is_double) return __builtin_ia32_movmskpd256(Numbers(m)) == 15;
    else if constexpr (sizeof(M) == 32) return __builtin_ia32_movmskps256(Numbers(m)) == 255;
    else if constexpr (sizeof(M) == 64 && is_double)
        return holds_in_all<T>(__builtin_shufflevector(m, m, 0, 1, 2, 3) & __builtin_shufflevector(m, m, 4, 5, 6, 7));
    else if constexpr (sizeof(M) == 64)
        return holds_in_all<T>(__builtin_shufflevector(m, m, 0, 1, 2, 3, 4, 5, 6, 7) &
                               __builtin_shufflevector(m, m, 8, 9, 10, 11, 12, 13, 14, 15));
#endif
    for (size_t i = 0; i < sizeof(M) / sizeof(T); ++i) out = out && m[i] != 0;
    return out;
}
