/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/address.h"
#include "muster/directory.h"

#include <stdio.h>
#include <string.h>

static bool is_wide(const char *to)
{
    enum mu_address_kind kind = mu_address_kind(to);
    return kind == MU_ADDRESS_ALL || kind == MU_ADDRESS_ROBOTS || kind == MU_ADDRESS_SPECIAL;
}

static const char *group_of(const char *to)
{
    return mu_address_kind(to) == MU_ADDRESS_GROUP ? mu_address_rest(to) : NULL;
}

bool receivers_are_many(const char *to)
{
    return mu_address_kind(to) != MU_ADDRESS_NAMES;
}

bool receivers_are_group(const mu_process *p, const char *name)
{
    const char *group = NULL;
    for (size_t i = 0; (group = mu_process_group(p, i)) && strcmp(group, name) != 0; i++) {
    }
    return group != NULL;
}

/* Each name once: that is how the broker reads them. */
static unsigned names_count(const char *to)
{
    unsigned count = 0;
    for (const char *at = to; *at; at += strcspn(at, ","), at += *at == ',') {
        size_t len = strcspn(at, ",");
        bool had = false;
        for (const char *e = to; e < at && !had; e += strcspn(e, ",") + 1) {
            had = strcspn(e, ",") == len && memcmp(e, at, len) == 0;
        }
        count += !had;
    }
    return count;
}

bool receivers_have(const mu_process *p, const char *to, const struct mu_member *m)
{
    const char *group = group_of(to);
    if (group) {
        return mu_process_in_group(p, group, m->name);
    }
    if (strcmp(to, "robots") == 0) {
        return m->kind == MU_KIND_ROBOT;
    }
    bool is_special = m->kind == MU_KIND_SPECIAL;
    bool is_broker = strcmp(m->name, "broker") == 0 || strncmp(m->name, "broker.", 7) == 0;
    return strcmp(to, "special") == 0 ? is_special && !is_broker
                                      : !is_special && m->kind != MU_KIND_HOST;
}

unsigned receivers_count(const mu_process *p, const char *to, const char *from, bool robots_only)
{
    if (!receivers_are_many(to)) {
        return names_count(to);
    }
    if (!is_wide(to) && !group_of(to)) {
        return 1;
    }
    unsigned count = 0;
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(p, i)); i++) {
        count += m->state != MU_GONE && strcmp(m->name, from) != 0 && !reader_is(m) &&
                 receivers_have(p, to, m) && (!robots_only || m->kind == MU_KIND_ROBOT);
    }
    return count;
}
