/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/address.h"

#include "core/name.h"

#include <stddef.h>
#include <string.h>

enum address_kind address_kind(const char *dst)
{
    static const char *const words[] = {
        [ADDRESS_ALL] = "all", [ADDRESS_ROBOTS] = "robots", [ADDRESS_SPECIAL] = "special"};
    for (enum address_kind kind = ADDRESS_ALL; kind <= ADDRESS_SPECIAL; kind++) {
        if (strcmp(dst, words[kind]) == 0) {
            return kind;
        }
    }
    const char *colon = strchr(dst, ':');
    if (!colon) {
        return ADDRESS_NAMES;
    }
    return strncmp(dst, "group:", 6) == 0 ? ADDRESS_GROUP : ADDRESS_SCHEME;
}

const char *address_rest(const char *dst)
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
    for (const char *c = address_rest(dst); *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127) {
            return false;
        }
    }
    return mu_name_valid(name) && address_rest(dst)[0] != '\0';
}

bool address_next(const char **list, char name[MU_NAME_MAX + 1])
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

bool address_valid(const char *dst)
{
    char name[MU_NAME_MAX + 1];
    switch (address_kind(dst)) {
    case ADDRESS_ALL:
    case ADDRESS_ROBOTS:
    case ADDRESS_SPECIAL: return true;
    case ADDRESS_GROUP: return mu_name_valid(address_rest(dst));
    case ADDRESS_SCHEME: return scheme_valid(dst);
    case ADDRESS_NAMES: break;
    }
    bool list = strchr(dst, ',') != NULL;
    while (address_next(&dst, name)) {
        if (list && address_kind(name) != ADDRESS_NAMES) {
            return false;
        }
        if (*dst == '\0') {
            return true;
        }
    }
    return false;
}
