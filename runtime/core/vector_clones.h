// Before a function whose loops compilers make vectors of: it is compiled for AVX2 as well, and which one runs is decided
// when the program is loaded. Both give the same results, since nothing is contracted or reordered.
#pragma once

// Not under sanitizers: the choice would be made before they have started.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define COPPICE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define COPPICE_SANITIZED
#endif
#endif

#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && !defined(__AVX2__) && \
    !defined(COPPICE_SANITIZED)
#define COPPICE_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define COPPICE_VECTOR_CLONES
#endif
