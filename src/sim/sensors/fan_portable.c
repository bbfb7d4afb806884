/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels for plain C vectors, for any processor. */
#define FAN_WIDTH  2
#define FAN_NAME   "portable"
#define FAN_KERNEL fan_portable
#define FAN_SWEEP  fan_portable_sweep
#define FAN_NEAR   fan_portable_near
#define FAN_CAST   fan_portable_cast
#include "sim/sensors/fan_kernel.h"
