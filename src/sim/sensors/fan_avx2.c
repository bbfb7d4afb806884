/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels for AVX2.  The Makefile sets the compiler's flags. */
#include "sim/sensors/fan.h"

#if defined(__x86_64__)
#define FAN_WIDTH  4
#define FAN_NAME   "avx2"
#define FAN_KERNEL fan_avx2
#define FAN_SWEEP  fan_avx2_sweep
#define FAN_NEAR   fan_avx2_near
#define FAN_CAST   fan_avx2_cast
#include "sim/sensors/fan_kernel.h"
#endif
