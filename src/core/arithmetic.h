/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file arithmetic.h
 * What a run was computed with and on: the first decides its hash, the others must not.
 */
#ifndef MUSTER_CORE_ARITHMETIC_H
#define MUSTER_CORE_ARITHMETIC_H

#include <float.h>

/* The x87 computes with more digits than a double has, and rounds when it runs out of registers;
 * some compilers compute with floats as with doubles. */
#if FLT_EVAL_METHOD != 0
#error "more digits than elsewhere; i386: -msse2 -mfpmath=sse, s390x: -fexcess-precision=fast"
#endif

/** Whose elementary functions programs are linked with: the same name, the same hashes. */
#define MU_ARITHMETIC "musl 1.2.3"

/** What recordings and reports that name none were computed with. */
#define MU_ARITHMETIC_BEFORE "the C library's functions"

enum { MU_PROCESSOR_MAX = 64 };

/** @return the processor's name for its architecture, such as x86_64 */
const char *mu_architecture(void);

/** Writes the processor's name as it gives it, or "" where it gives none. */
void mu_processor(char name[MU_PROCESSOR_MAX]);

#endif
