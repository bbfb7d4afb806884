/* SPDX-License-Identifier: Apache-2.0 */
#include "run/observer.h"

#include <string.h>

/* What stands behind WHO. */
enum rest { REST_NONE, REST_COMMAND, REST_LINE, REST_COUNT, REST_NO_WHO };

static const struct form {
    const char *name;
    const char *performative;
    enum observer_answer answer;
    enum rest rest;
    const char *usage;
} forms[] = {
    {"you-do", "do", OBSERVER_MAIL, REST_COMMAND, "(you-do WHO COMMAND WORD...)"},
    {"inspect", "do", OBSERVER_MAIL, REST_LINE, "(inspect WHO [LINE])"},
    {"start", "start", OBSERVER_MAIL, REST_NONE, "(start WHO)"},
    {"suspend", "suspend", OBSERVER_MAIL, REST_NONE, "(suspend WHO)"},
    {"resume", "resume", OBSERVER_MAIL, REST_NONE, "(resume WHO)"},
    {"step", "step", OBSERVER_MAIL, REST_COUNT, "(step WHO N)"},
    {"agents", NULL, OBSERVER_HERE, REST_NO_WHO, "(agents)"},
};

enum { FORMS = sizeof forms / sizeof forms[0] };

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static void blank_skip(const char **at)
{
    while (is_space(**at)) {
        (*at)++;
    }
}

/* Reads a word, without quotes if it has any.  @return false: there is none */
static bool word_read(const char **at, struct mu_text *out)
{
    blank_skip(at);
    bool quoted = **at == '"';
    const char *end = *at + quoted;
    while (*end && (quoted ? *end != '"' : !is_space(*end) && !strchr("()\"", *end))) {
        end++;
    }
    size_t len = (size_t)(end - *at) - quoted;
    if (len == 0 || (quoted && *end != '"')) {
        return false;
    }
    mu_text_add_bytes(out, *at + quoted, len);
    *at = end + quoted;
    return !out->cut;
}

/* (create$ a b c): names joined by commas. */
static bool list_read(const char **at, struct mu_text *out)
{
    char bytes[MU_NAME_MAX + 1];
    struct mu_text word = mu_text_in(bytes, sizeof bytes);
    (*at)++;
    if (!word_read(at, &word) || strcmp(word.at, "create$") != 0) {
        return false;
    }
    bool read = false;
    for (blank_skip(at); **at && **at != ')'; blank_skip(at)) {
        mu_text_add(out, read ? "," : "");
        read = word_read(at, out);
        if (!read) {
            return false;
        }
    }
    *at += **at == ')';
    return read;
}

static bool who_read(const char **at, char who[MU_DST_MAX + 1])
{
    struct mu_text t = mu_text_in(who, MU_DST_MAX + 1);
    blank_skip(at);
    return **at == '(' ? list_read(at, &t) : word_read(at, &t);
}

/* The rest of a line, without the parenthesis that closes it.  @return its bytes */
static size_t rest_len(const char *at)
{
    size_t len = strlen(at);
    while (len > 0 && is_space(at[len - 1])) {
        len--;
    }
    len -= len > 0 && at[len - 1] == ')';
    while (len > 0 && is_space(at[len - 1])) {
        len--;
    }
    return len;
}

static bool rest_read(const char *at, enum rest rest, struct mu_text *content)
{
    blank_skip(&at);
    size_t len = rest_len(at);
    switch (rest) {
    case REST_NONE:
    case REST_NO_WHO: return len == 0;
    case REST_COMMAND:
        mu_text_format(content, "(%.*s)", (int)len, at);
        return len > 0 && *at != '(' && *at != ')' && !content->cut;
    case REST_LINE:
        mu_text_format(content, "%.*s", len > 0 ? (int)len : 7, len > 0 ? at : "(facts)");
        return !content->cut;
    case REST_COUNT:
        mu_text_add_bytes(content, at, len);
        return len > 0 && len < 10 && strspn(at, "0123456789") >= len && strspn(at, "0") < len;
    }
    return false;
}

static const struct form *form_find(const char **at)
{
    char bytes[MU_NAME_MAX + 1];
    struct mu_text name = mu_text_in(bytes, sizeof bytes);
    blank_skip(at);
    if (**at != '(') {
        return NULL;
    }
    (*at)++;
    if (!word_read(at, &name)) {
        return NULL;
    }
    for (size_t i = 0; i < FORMS; i++) {
        if (strcmp(forms[i].name, name.at) == 0) {
            return &forms[i];
        }
    }
    return NULL;
}

mu_result observer_read(struct observer_order *o, const char *line, struct mu_text *why)
{
    const struct form *form = form_find(&line);
    o->who[0] = '\0';
    if (!form) {
        mu_text_add(why, "expected one of");
        for (size_t i = 0; i < FORMS; i++) {
            mu_text_format(why, " %s", forms[i].usage);
        }
        mu_text_add(why, "\n");
        return MU_MALFORMED;
    }
    struct mu_text content = mu_text_in(o->content, sizeof o->content);
    o->performative = form->performative;
    o->answer = form->answer;
    bool good = form->rest == REST_NO_WHO || who_read(&line, o->who);
    if (!good || !rest_read(line, form->rest, &content)) {
        mu_text_format(why, "expected %s\n", form->usage);
        return MU_MALFORMED;
    }
    return MU_OK;
}

void observer_words(struct mu_text *out)
{
    static const char *const others[] = {"create$", "all", "robots", "special"};
    for (size_t i = 0; i < FORMS; i++) {
        mu_text_format(out, "f %s\n", forms[i].name);
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        mu_text_format(out, "%s %s\n", i == 0 ? "f" : "w", others[i]);
    }
}
