/* SPDX-License-Identifier: Apache-2.0 */
#include "core/name.h"

#include "muster/limits.h"

#include <stddef.h>
#include <string.h>

static bool name_starts(char c)
{
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}

static bool name_goes_on(char c)
{
    return name_starts(c) || (c >= '0' && c <= '9') || c == '.' || c == '-';
}

bool mu_name_valid(const char *name)
{
    if (!name_starts(name[0])) {
        return false;
    }
    size_t len = 1;
    while (len <= MU_NAME_MAX && name_goes_on(name[len])) {
        len++;
    }
    return len <= MU_NAME_MAX && name[len] == '\0';
}

bool mu_name_reserved(const char *name)
{
    static const char *const reserved[] = {"all",      "robots",   "special",
                                           "observer", "operator", "broker"};
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++) {
        if (strcmp(name, reserved[i]) == 0) {
            return true;
        }
    }
    return strncmp(name, "broker.", 7) == 0;
}
