/* SPDX-License-Identifier: Apache-2.0 */
#include "resolver/scheme.h"

static bool role_resolve(void *self, mu_agent *a, const char *rest, const char *sender,
                         mu_resolution *r)
{
    (void)a;
    (void)sender;
    return offers_resolve(self, "role", rest, r);
}

const struct scheme role_scheme = {.name = MU_SCHEME_ROLE,
                                   .means = "agents that offer something with role=REST",
                                   .resolve = role_resolve};
