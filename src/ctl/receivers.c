/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/receivers.h"

#include "core/name.h"
#include "ctl/operator.h"
#include "muster/directory.h"

#include <stdio.h>
#include <string.h>

static const char *const wide[] = {"all", "robots", "special"};

static bool is_wide(const char *to)
{
    for (size_t i = 0; i < sizeof wide / sizeof wide[0]; i++) {
        if (strcmp(to, wide[i]) == 0) {
            return true;
        }
    }
    return false;
}

static const char *group_of(const char *to)
{
    return strncmp(to, "group:", 6) == 0 ? to + 6 : NULL;
}

bool receivers_are_many(const char *to)
{
    return is_wide(to) || strchr(to, ':') != NULL;
}

/* group:G, or another address that somebody resolves. */
static bool scheme_valid(const char *to)
{
    char scheme[MU_NAME_MAX + 2];
    const char *rest = strchr(to, ':') + 1;
    snprintf(scheme, sizeof scheme, "%.*s", (int)strcspn(to, ":"), to);
    if (!mu_name_valid(scheme) || *rest == '\0') {
        return false;
    }
    for (const char *c = rest; *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127) {
            return false;
        }
    }
    return !group_of(to) || mu_name_valid(rest);
}

/* Takes the next name of a list.  @return its length; 0: that is no name */
static size_t name_next(const char *list, char name[MU_NAME_MAX + 2])
{
    size_t len = strcspn(list, ",");
    snprintf(name, MU_NAME_MAX + 2, "%.*s", (int)(len < MU_NAME_MAX + 2 ? len : MU_NAME_MAX + 1),
             list);
    return mu_name_valid(name) ? len : 0;
}

bool receivers_valid(const char *to)
{
    char name[MU_NAME_MAX + 2];
    if (strchr(to, ':')) {
        return scheme_valid(to);
    }
    bool list = strchr(to, ',') != NULL;
    for (size_t len; (len = name_next(to, name)) > 0; to += len + 1) {
        if (list && is_wide(name)) {
            return false;
        }
        if (to[len] == '\0') {
            return true;
        }
    }
    return false;
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

static bool is_addressed(const mu_process *p, const char *to, const struct mu_member *m)
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
    return strcmp(to, "special") == 0 ? is_special && !is_broker : !is_special;
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
        count += m->state != MU_GONE && strcmp(m->name, from) != 0 && !operator_is_reader(m) &&
                 is_addressed(p, to, m) && (!robots_only || m->kind == MU_KIND_ROBOT);
    }
    return count;
}
