/* SPDX-License-Identifier: Apache-2.0 */
#include "resolver/scheme.h"

static bool task_resolve(void *self, mu_agent *a, const char *rest, const char *sender,
                         mu_resolution *r)
{
    (void)a;
    (void)sender;
    return offers_resolve(self, "task", rest, r);
}

const struct scheme task_scheme = {.name = MU_SCHEME_TASK,
                                   .means = "agents that offer something with task=REST",
                                   .resolve = task_resolve};
