/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/version.h"

const char *mu_version(void)
{
    return MU_VERSION;
}
