/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/attributes.h"
#include "core/name.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

bool words_join(char *text, size_t size, const char *const *words, size_t count)
{
    struct mu_text t = mu_text_in(text, size);
    for (size_t i = 0; i < count; i++) {
        mu_text_add(&t, i ? " " : "");
        mu_text_add(&t, words[i]);
    }
    return !t.cut;
}

bool words_are_utf8(const char *text)
{
    uint32_t code;
    for (size_t len; (len = mu_utf8_next(text, &code)) > 0; text += len) {
        if (code == MU_UTF8_BROKEN && strncmp(text, MU_UTF8_BROKEN_TEXT, 3) != 0) {
            return false;
        }
    }
    return true;
}

bool words_name_check(const char *program, const char *what, const char *name)
{
    char shown[MU_TEXT_SHOWN];
    if (mu_name_valid(name)) {
        return true;
    }
    fprintf(stderr, "%s: '%s' is no name of %s: it must match [A-Za-z_][A-Za-z0-9_.-]{0,30}\n",
            program, mu_text_show(shown, name), what);
    return false;
}

bool words_place_check(const char *program, const char *name)
{
    char shown[MU_TEXT_SHOWN];
    if (mu_name_valid(name) && !mu_name_reserved(name)) {
        return true;
    }
    fprintf(stderr, "%s: '%s' cannot be the name of an agent or a host\n", program,
            mu_text_show(shown, name));
    return false;
}

bool words_group_check(const char *program, const char *name)
{
    if (!words_name_check(program, "a group", name)) {
        return false;
    }
    if (!mu_name_of_group(name)) {
        fprintf(stderr, "%s: '%s' is reserved: expected another name of a group\n", program, name);
        return false;
    }
    return true;
}

bool words_query_check(const char *program, const char *query)
{
    struct mu_query read;
    bool good = mu_attributes_query(&read, query) == MU_OK;
    if (!good) {
        fprintf(stderr,
                "%s: expected a service, or *, and up to %d constraints such as role=scout "
                "battery>=0.5 near=X,Y,RADIUS, at most %d bytes\n",
                program, MU_CONSTRAINTS_MAX, MU_QUERY_MAX);
    }
    return good;
}
