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
    return ADDRESS_NAMES;
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
    if (address_kind(dst) != ADDRESS_NAMES) {
        return true;
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
