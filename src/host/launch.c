/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lines between the snapshot's header and the rules of a launched agent: one for each global,
 * "global mate=red", and one for each group, "group scouts".
 */
#include "host/host.h"
#include "muster/directory.h"

#include <string.h>

/* Takes the next line of a kind.  @return whether there is one that fits */
static bool line_take(const char **text, const char *kind, char out[MU_FIELD_MAX + 1])
{
    size_t head = strlen(kind), len = strcspn(*text, "\n");
    bool is_one =
        strncmp(*text, kind, head) == 0 && (*text)[len] == '\n' && len - head <= MU_FIELD_MAX;
    if (is_one) {
        memcpy(out, *text + head, len - head);
        out[len - head] = '\0';
        *text += len + 1;
    }
    return is_one;
}

const char *launch_rules(const char *rest)
{
    char line[MU_FIELD_MAX + 1];
    while (line_take(&rest, "global ", line) || line_take(&rest, "group ", line)) {
    }
    return rest;
}

mu_result launch_set_globals(struct robot *r, const char *rest, struct mu_fault *fault)
{
    char line[MU_FIELD_MAX + 1];
    while (line_take(&rest, "global ", line)) {
        char *equals = strchr(line, '=');
        if (equals) {
            *equals = '\0';
        }
        if (!equals || mind_set_global(r->mind, line, equals + 1) != MU_OK) {
            return mu_fault_at(fault, r->name, 0, 0,
                               "global %s: no such global, or not a CLIPS field", line);
        }
    }
    return MU_OK;
}

mu_result launch_join_groups(struct robot *r, const char *rest)
{
    char line[MU_FIELD_MAX + 1];
    mu_result joined = MU_OK;
    while (joined == MU_OK &&
           (line_take(&rest, "global ", line) || line_take(&rest, "group ", line))) {
        bool is_group = !strchr(line, '=');
        joined = is_group ? mu_agent_group_join(r->agent, line) : MU_OK;
    }
    return joined;
}
