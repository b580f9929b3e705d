/* Functions compiled for processors with AVX2 too, of which one is chosen when the program is loaded. Neither form
 * fuses products with sums, so both give the same bits. */
#ifndef HEWN_SRC_BASE_CLONES_H
#define HEWN_SRC_BASE_CLONES_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) &&                        \
    !defined(__SANITIZE_ADDRESS__)
#define HEWN_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define HEWN_CLONES
#endif

/* What such functions call is compiled for one processor only, unless it becomes part of them. */
#if defined(__GNUC__)
#define HEWN_INTO_CLONES inline __attribute__((always_inline))
#else
#define HEWN_INTO_CLONES inline
#endif

#endif
