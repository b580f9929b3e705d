/* Noise in floats, written on its own after src/field/noise.c's description: sums and products in the order of the
 * shader, so that bits must agree. */
#ifndef HEWN_TESTS_ORACLE_NOISE_H
#define HEWN_TESTS_ORACLE_NOISE_H

#include <stdint.h>

enum { ORACLE_NOISE_VALUE, ORACLE_NOISE_GRADIENT, ORACLE_NOISE_SIMPLEX, ORACLE_NOISE_CELLULAR };

float oracle_noise(int kind, float x, float y, float z, uint32_t seed);

#endif
