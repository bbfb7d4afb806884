/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include <string.h>

void forms_clear(struct forms *f)
{
    f->len = 0;
    f->depth = 0;
    f->string = f->escaped = f->comment = f->done = false;
    f->text[0] = '\0';
}

bool forms_are_open(const struct forms *f)
{
    return !f->done && f->len > 0;
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

static void form_add(struct forms *f, char c)
{
    if (f->len < MU_CONTENT_MAX) {
        f->text[f->len] = c;
        f->text[f->len + 1] = '\0';
    }
    f->len++;
}

static enum forms_found form_end(struct forms *f)
{
    f->done = true;
    return f->len > MU_CONTENT_MAX ? FORMS_LONG : FORMS_READY;
}

/* @return whether the form ends with this character of a string */
static bool string_goes_on(struct forms *f, char c)
{
    bool ends = c == '"' && !f->escaped;
    f->escaped = c == '\\' && !f->escaped;
    f->string = !ends;
    form_add(f, c);
    return ends && f->depth == 0;
}

/* @return whether a word that stands outside of parentheses ends before this character */
static bool word_ends(const struct forms *f, char c)
{
    return f->len > 0 && f->depth == 0 && (is_space(c) || strchr("()\";", c));
}

/* A character that is in no string and no comment.  @return whether the form ends with it */
static bool form_goes_on(struct forms *f, char c)
{
    if (f->len == 0 && is_space(c)) {
        return false;
    }
    f->depth += c == '(';
    f->depth -= c == ')';
    f->string = c == '"';
    f->comment = c == ';';
    if (!f->comment || f->depth > 0) {
        form_add(f, c);
    }
    return c == ')' && f->depth == 0;
}

static enum forms_found form_read(struct forms *f, const char **at)
{
    for (; **at; (*at)++) {
        char c = **at;
        bool ends = false;
        if (f->comment) {
            f->comment = c != '\n';
            if (f->depth > 0) {
                form_add(f, c);
            }
        } else if (f->string) {
            ends = string_goes_on(f, c);
        } else if (word_ends(f, c)) {
            return form_end(f);
        } else if (c == ')' && f->depth == 0) {
            (*at)++;
            return FORMS_EXTRA;
        } else {
            ends = form_goes_on(f, c);
        }
        if (ends) {
            (*at)++;
            return form_end(f);
        }
    }
    return FORMS_MORE;
}

enum forms_found forms_next(struct forms *f, const char **at)
{
    if (f->done) {
        forms_clear(f);
    }
    return form_read(f, at);
}
