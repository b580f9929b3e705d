/* Functions compiled for processors with AVX2 too, and chosen when the program is loaded. Neither form fuses products
 * with sums, so both give the same bits. */
#ifndef HEWN_SRC_BASE_CLONES_H
#define HEWN_SRC_BASE_CLONES_H

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) &&                        \
    !defined(__SANITIZE_ADDRESS__)
#define HEWN_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define HEWN_CLONES
#endif

#endif
