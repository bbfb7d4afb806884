/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

/* A passport and the rules behind it. */
static char launch_bytes[LAUNCH_RULES_MAX + LAUNCH_HEAD_MAX];

struct mu_text *launch_text_begin(const char *name, bool start, int64_t seed)
{
    static struct mu_text text;
    mu_text_init(&text, launch_bytes, sizeof launch_bytes);
    mu_text_format(&text, "passport 2 launch %s %s 0 0 0 0 0 %lld 0 - \n", name,
                   start ? "running" : "standby", (long long)seed);
    return &text;
}

/* @return what is wrong with a text that was read, or NULL */
static const char *text_objection(FILE *f, const char *text, size_t len, size_t room)
{
    if (ferror(f)) {
        return strerror(errno);
    }
    bool good = len < room && strlen(text) == len && words_are_utf8(text);
    return good ? NULL : "expected a text of at most 512 KiB, in UTF-8";
}

mu_result launch_text_rules(struct mu_text *out, const char *file)
{
    FILE *f = fopen(file, "rb");
    if (!f) {
        fprintf(stderr, "%s: cannot be opened: %s\n", file, strerror(errno));
        return MU_FAULT_FILE;
    }
    size_t room = out->size - out->len - 1;
    char *text = out->at + out->len;
    size_t len = fread(text, 1, room, f);
    text[len] = '\0';
    const char *wrong = text_objection(f, text, len, room);
    fclose(f);
    if (wrong) {
        fprintf(stderr, "%s: %s\n", file, wrong);
        return MU_FAULT_FILE;
    }
    out->len += len;
    return MU_OK;
}
