/* SPDX-License-Identifier: Apache-2.0 */
#include "core/name.h"

#include "core/text.h"
#include "muster/limits.h"

#include <stdio.h>
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
    if (!name || !name_starts(name[0])) {
        return false;
    }
    size_t len = 1;
    while (len <= MU_NAME_MAX && name_goes_on(name[len])) {
        len++;
    }
    return len <= MU_NAME_MAX && name[len] == '\0';
}

static bool name_is_in(const char *name, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(name, names[i]) == 0) {
            return true;
        }
    }
    return false;
}

bool mu_name_of_group(const char *name)
{
    static const char *const others[] = {"all", "robots", "special", "broker"};
    return mu_name_valid(name) && !name_is_in(name, others, sizeof others / sizeof others[0]);
}

bool mu_name_of_operator(const char *name)
{
    static const char operator_[] = "operator-";
    size_t len = sizeof operator_ - 1;
    return strncmp(name, operator_, len) == 0 && name[len] &&
           name[len + strspn(name + len, "0123456789")] == '\0';
}

bool mu_name_reserved(const char *name)
{
    static const char *const reserved[] = {"all",      "robots",   "special",
                                           "observer", "operator", "broker"};
    return name_is_in(name, reserved, sizeof reserved / sizeof reserved[0]) ||
           strncmp(name, "broker.", 7) == 0;
}

static const struct {
    const char *now, *was;
} renamed[] = {
    {"broker.names", "broker.registrar"},
    {"broker.mail", "broker.postmaster"},
    {"broker.delivery", "broker.courier"},
    {"broker.federation", "broker.liaison"},
};

const char *mu_name_now(const char *name)
{
    for (size_t i = 0; i < sizeof renamed / sizeof renamed[0]; i++) {
        if (strcmp(name, renamed[i].was) == 0) {
            return renamed[i].now;
        }
    }
    return name;
}

const char *mu_name_was(const char *name)
{
    for (size_t i = 0; i < sizeof renamed / sizeof renamed[0]; i++) {
        if (strcmp(name, renamed[i].now) == 0) {
            return renamed[i].was;
        }
    }
    return NULL;
}

bool mu_name_check(const char *program, const char *whose, const char *name)
{
    char shown[MU_TEXT_SHOWN];
    bool good = mu_name_valid(name) && !mu_name_reserved(name);
    if (!good) {
        fprintf(stderr,
                "%s: '%s' cannot be %s's name: it must match [A-Za-z_][A-Za-z0-9_.-]{0,30} and not "
                "be reserved\n",
                program, mu_text_show(shown, name), whose);
    }
    return good;
}
