/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "core/name.h"

/* Only a broker speaks for agents that live elsewhere. */
bool validate_entry(const muster_Entry *e, bool of_a_broker)
{
    return validate_kind_word(e->kind) && validate_state_word(e->state) &&
           (unsigned)e->full <= muster_BOX_DROP_LOWEST &&
           (e->home[0] == '\0' || (of_a_broker && mu_name_valid(e->home)));
}

bool validate_process_name(const char *name)
{
    size_t len = 0;
    while (len <= MU_PROCESS_MAX && name[len] != '\0') {
        char c = name[len];
        if (c <= ' ' || c > '~' || c == '*' || c == '?') { /* wildcards of DDS partitions */
            return false;
        }
        len++;
    }
    return len >= 1 && len <= MU_PROCESS_MAX;
}

const char *validate_kind_word(muster_Kind kind)
{
    static const char *const words[] = {"agent", "robot", "host", "special"};
    return (unsigned)kind < sizeof words / sizeof words[0] ? words[kind] : NULL;
}

const char *validate_state_word(muster_State state)
{
    static const char *const words[] = {"standby", "running", "suspended", "moving", "absent"};
    return (unsigned)state < sizeof words / sizeof words[0] ? words[state] : NULL;
}
