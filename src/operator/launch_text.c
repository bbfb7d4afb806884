/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/text_file.h"
#include "muster/memory.h"

#include <string.h>

static const char expected[] = "expected a text of at most 512 KiB, in UTF-8, with what it extends";

enum { EXTENDS_MAX = 255, EXTENDS_DEEP = 16 };

/* A passport and the rules behind it. */
static char launch_bytes[LAUNCH_RULES_MAX + LAUNCH_HEAD_MAX];

struct mu_text *launch_text_begin(const char *name, bool start, int64_t seed)
{
    static struct mu_text text;
    mu_text_init(&text, launch_bytes, sizeof launch_bytes);
    mu_text_format(&text, "passport 3 robot launch %s %s 0 0 0 0 0 %lld 0 - \n", name,
                   start ? "running" : "standby", (long long)seed);
    return &text;
}

/* @return behind a comment, a string or another character */
static const char *behind(const char *at)
{
    if (*at == ';') {
        return at + strcspn(at, "\n");
    }
    if (*at != '"') {
        return at + 1;
    }
    for (at++; *at && *at != '"'; at++) {
        at += *at == '\\' && at[1];
    }
    return at + (*at == '"');
}

/* @return the next (extends "FILE") outside of forms, or the end; *len: of the form, or 0 */
static const char *extends_find(const char *at, char file[EXTENDS_MAX + 1], int *len)
{
    int depth = 0;
    for (*len = 0; *at; at = behind(at)) {
        if (depth == 0 && *at == '(' &&
            sscanf(at, "( extends \"%255[^\"\\]\" )%n", file, len) == 1 && *len > 0) {
            return at;
        }
        depth += (*at == '(') - (*at == ')');
    }
    return at;
}

static mu_result rules_read(struct mu_text *text, const char *file, unsigned deep,
                            struct mu_fault *fault)
{
    mu_result read = mu_text_file_read(file, text, fault);
    if (read != MU_OK) {
        return read;
    }
    if (text->cut || strlen(text->at) != text->len || !words_are_utf8(text->at)) {
        return mu_fault_at(fault, file, 0, 0, expected);
    }
    return deep < EXTENDS_DEEP ? MU_OK
                               : mu_fault_at(fault, file, 0, 0, "more than %d files deep", deep);
}

/* Adds a file.  What it extends and lies beside it is not on the host, and stands in the place of
 * the form; the rest is of the library. */
static mu_result rules_add(struct mu_text *out, const char *file, unsigned deep,
                           struct mu_fault *fault)
{
    char name[EXTENDS_MAX + 1], beside[PATH_MAX];
    const char *slash = strrchr(file, '/');
    int len, folder = slash ? (int)(slash - file) + 1 : 0;
    struct mu_text text = mu_text_in(out->at + out->len, out->size - out->len);
    mu_result added = rules_read(&text, file, deep, fault);
    if (added != MU_OK) {
        return added;
    }
    const char *at = mu_startup_string(text.at);
    for (const char *form; *(form = extends_find(at, name, &len)); at = form + len) {
        bool outside = name[0] == '/' || strstr(name, "..");
        mu_text_add_bytes(out, at, (size_t)(form - at));
        snprintf(beside, sizeof beside, "%.*s%s", folder, file, name);
        added = outside ? MU_ABSENT : rules_add(out, beside, deep + 1, fault);
        if (added != MU_OK && added != MU_ABSENT) {
            return added;
        }
        mu_text_add_bytes(out, added == MU_OK ? "\n" : form, added == MU_OK ? 1 : (size_t)len);
    }
    mu_text_add(out, at);
    return out->cut ? mu_fault_at(fault, file, 0, 0, expected) : MU_OK;
}

mu_result launch_text_rules(struct mu_text *out, const char *file)
{
    struct mu_fault fault;
    if (rules_add(out, file, 0, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    return MU_OK;
}
