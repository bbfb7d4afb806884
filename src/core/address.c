/* SPDX-License-Identifier: Apache-2.0 */
#include "core/address.h"

#include "core/name.h"

#include <stddef.h>
#include <string.h>

enum mu_address_kind mu_address_kind(const char *dst)
{
    static const char *const words[] = {
        [MU_ADDRESS_ALL] = "all", [MU_ADDRESS_ROBOTS] = "robots", [MU_ADDRESS_SPECIAL] = "special"};
    for (enum mu_address_kind kind = MU_ADDRESS_ALL; kind <= MU_ADDRESS_SPECIAL; kind++) {
        /* Most addresses are names, and differ in the first letter. */
        if (dst[0] == words[kind][0] && strcmp(dst, words[kind]) == 0) {
            return kind;
        }
    }
    const char *colon = strchr(dst, ':');
    if (!colon) {
        return MU_ADDRESS_NAMES;
    }
    return strncmp(dst, "group:", 6) == 0 ? MU_ADDRESS_GROUP : MU_ADDRESS_SCHEME;
}

const char *mu_address_rest(const char *dst)
{
    return strchr(dst, ':') + 1;
}

/* @return whether a name stands before the colon, and something that can be seen behind it */
static bool scheme_valid(const char *dst)
{
    char name[MU_NAME_MAX + 1];
    size_t len = strcspn(dst, ":");
    if (len > MU_NAME_MAX) {
        return false;
    }
    memcpy(name, dst, len);
    name[len] = '\0';
    for (const char *c = mu_address_rest(dst); *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127) {
            return false;
        }
    }
    return mu_name_valid(name) && mu_address_rest(dst)[0] != '\0';
}

bool mu_address_next(const char **list, char name[MU_NAME_MAX + 1])
{
    size_t len = strcspn(*list, ",");
    if (len > MU_NAME_MAX) {
        return false;
    }
    memcpy(name, *list, len);
    name[len] = '\0';
    if (!mu_name_valid(name)) {
        return false;
    }
    *list += len;
    if (**list == ',' && (*list)[1] != '\0') { /* a comma at the very end stays, and is refused */
        (*list)++;
    }
    return true;
}

bool mu_address_valid(const char *dst)
{
    char name[MU_NAME_MAX + 1];
    switch (mu_address_kind(dst)) {
    case MU_ADDRESS_ALL:
    case MU_ADDRESS_ROBOTS:
    case MU_ADDRESS_SPECIAL: return true;
    case MU_ADDRESS_GROUP: return mu_name_valid(mu_address_rest(dst));
    case MU_ADDRESS_SCHEME: return scheme_valid(dst);
    case MU_ADDRESS_NAMES: break;
    }
    bool list = strchr(dst, ',') != NULL;
    while (mu_address_next(&dst, name)) {
        if (list && mu_address_kind(name) != MU_ADDRESS_NAMES) {
            return false;
        }
        if (*dst == '\0') {
            return true;
        }
    }
    return false;
}
