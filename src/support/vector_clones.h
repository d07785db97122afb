#pragma once
/// \file Macros for vectorised functions: run-time choice of the instruction set, independent
/// loops.
///
/// CLOTH_SIM_VECTOR_CLONES before a function compiles it for the baseline and for AVX2; the loader
/// picks at start. FMA is left out on purpose: contraction would make the result depend on the
/// machine. Sanitizers run before the loader's choice is safe, so they get the baseline.

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CLOTH_SIM_VECTOR_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define CLOTH_SIM_VECTOR_CLONES
#endif

/// Before a loop: no iteration reads what another one writes.
#if defined(__clang__)
#define CLOTH_SIM_NO_ALIAS_LOOP _Pragma("clang loop vectorize(assume_safety)")
#else
#define CLOTH_SIM_NO_ALIAS_LOOP _Pragma("GCC ivdep")
#endif
