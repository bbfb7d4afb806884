/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels for SSE2, which every 64-bit x86 processor has. */
#include "sim/sensors/fan.h"

#if defined(__x86_64__)
#define FAN_WIDTH  2
#define FAN_NAME   "sse2"
#define FAN_KERNEL fan_sse2
#define FAN_SWEEP  fan_sse2_sweep
#define FAN_NEAR   fan_sse2_near
#define FAN_CAST   fan_sse2_cast
#include "sim/sensors/fan_kernel.h"
#endif
