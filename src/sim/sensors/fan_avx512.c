/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels for AVX-512.  The Makefile sets the compiler's flags. */
#include "sim/sensors/fan.h"

#if defined(__x86_64__)
#define FAN_WIDTH  8
#define FAN_NAME   "avx512"
#define FAN_KERNEL fan_avx512
#define FAN_SWEEP  fan_avx512_sweep
#define FAN_NEAR   fan_avx512_near
#define FAN_CAST   fan_avx512_cast
#include "sim/sensors/fan_kernel.h"
#endif
