/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/name.h"
#include "muster/memory.h"

#include <string.h>

void trust_init(struct trust *t)
{
    *t = (struct trust){.lines = mu_startup_array(MU_TRUST_LINES_MAX, sizeof *t->lines)};
    t->lines[t->lines_count++] =
        (struct trust_line){true, {TRUST_NAME, "observer"}, {TRUST_ALL, ""}};
    t->lines[t->lines_count++] =
        (struct trust_line){true, {TRUST_NAME, "operator"}, {TRUST_ALL, ""}};
}

/* --- the file --------------------------------------------------------------------------------- */

/* A line of the file that is read word by word. */
struct reader {
    const char *file;
    const char *begin, *at, *end;
    int line;
    struct mu_fault *fault;
};

struct word {
    const char *at;
    size_t len; /* 0: the line is over */
};

static struct word word_next(struct reader *r)
{
    while (r->at < r->end && (*r->at == ' ' || *r->at == '\t' || *r->at == '\r')) {
        r->at++;
    }
    struct word w = {.at = r->at};
    if (r->at < r->end && *r->at == '#') {
        return w;
    }
    while (r->at < r->end && !strchr(" \t\r#", *r->at)) {
        r->at++;
    }
    w.len = (size_t)(r->at - w.at);
    return w;
}

static bool word_is(struct word w, const char *text)
{
    return w.len == strlen(text) && memcmp(w.at, text, w.len) == 0;
}

static mu_result word_fault(const struct reader *r, struct word w, const char *expected)
{
    int column = (int)(w.at - r->begin) + 1;
    int shown = w.len < 64 ? (int)w.len : 64;
    if (w.len == 0) {
        return mu_fault_at(r->fault, r->file, r->line, column, "expected %s, found the line's end",
                           expected);
    }
    return mu_fault_at(r->fault, r->file, r->line, column, "expected %s, not '%.*s'", expected,
                       shown, w.at);
}

static bool party_of(struct word w, struct trust_party *out)
{
    static const struct {
        const char *text;
        bool prefix;
        enum trust_party_kind kind;
    } words[] = {
        {"all", false, TRUST_ALL},         {"robots", false, TRUST_ROBOTS},
        {"special", false, TRUST_SPECIAL}, {"group:", true, TRUST_GROUP},
        {"role:", true, TRUST_ROLE},       {"", true, TRUST_NAME},
    };
    size_t i = 0, len = strlen(words[0].text);
    while (words[i].prefix ? w.len < len || memcmp(w.at, words[i].text, len) != 0
                           : !word_is(w, words[i].text)) {
        len = strlen(words[++i].text);
    }
    *out = (struct trust_party){.kind = words[i].kind};
    if (!words[i].prefix) {
        return true;
    }
    if (w.len - len > MU_NAME_MAX) {
        return false;
    }
    memcpy(out->name, w.at + len, w.len - len);
    return out->kind == TRUST_GROUP ? mu_name_of_group(out->name) : mu_name_valid(out->name);
}

static mu_result party_read(struct reader *r, struct trust_party *out)
{
    struct word w = word_next(r);
    return party_of(w, out)
               ? MU_OK
               : word_fault(r, w, "a name, all, robots, special, group:NAME or role:NAME");
}

/* Reads what stands between r->begin and r->end.  @return MU_OK; MU_DONE: nothing stands there */
static mu_result line_read(struct reader *r, struct trust_line *line)
{
    struct word verb = word_next(r);
    if (verb.len == 0) {
        return MU_DONE;
    }
    line->allow = word_is(verb, "allow");
    if (!line->allow && !word_is(verb, "deny")) {
        return word_fault(r, verb, "allow or deny");
    }
    if (party_read(r, &line->who) != MU_OK) {
        return MU_FAULT_FILE;
    }
    struct word what = word_next(r);
    if (!word_is(what, "direct")) {
        return word_fault(r, what, "direct");
    }
    if (party_read(r, &line->whom) != MU_OK) {
        return MU_FAULT_FILE;
    }
    struct word rest = word_next(r);
    return rest.len == 0 ? MU_OK : word_fault(r, rest, "the line's end or a comment");
}

mu_result trust_read(struct trust *t, const char *text, const char *file, struct mu_fault *fault)
{
    struct reader r = {.file = file, .begin = text, .fault = fault};
    t->lines_count = 0;
    while (*r.begin) {
        struct trust_line line = {0};
        r.at = r.begin;
        r.end = r.begin + strcspn(r.begin, "\n");
        r.line++;
        mu_result read = line_read(&r, &line);
        if (read < 0) {
            return read;
        }
        if (read == MU_OK && t->lines_count == MU_TRUST_LINES_MAX) {
            return mu_fault_at(fault, file, r.line, 1, "expected at most %d lines of policy",
                               MU_TRUST_LINES_MAX);
        }
        if (read == MU_OK) {
            t->lines[t->lines_count++] = line;
        }
        r.begin = *r.end ? r.end + 1 : r.end;
    }
    return MU_OK;
}

/* --- deciding --------------------------------------------------------------------------------- */

/* Consoles are the operator under further names, each as special as it is. */
static bool party_is_named(const struct trust_party *p, const struct trust_agent *a)
{
    bool operates = strcmp(p->name, "operator") == 0 && a->kind == muster_KIND_SPECIAL &&
                    mu_name_of_operator(a->name);
    return operates || strcmp(p->name, a->name) == 0;
}

static bool party_fits(const struct trust *t, const struct trust_party *p,
                       const struct trust_agent *a)
{
    const struct trust_pages *pages = &t->pages;
    switch (p->kind) {
    case TRUST_NAME: return party_is_named(p, a);
    case TRUST_ALL: return true;
    case TRUST_ROBOTS: return a->kind == muster_KIND_ROBOT;
    case TRUST_SPECIAL: return a->kind == muster_KIND_SPECIAL;
    case TRUST_GROUP:
    case TRUST_ROLE: return pages->has && pages->has(pages->self, p, a->name);
    }
    return false;
}

bool trust_allows(const struct trust *t, const struct trust_agent *who,
                  const struct trust_agent *whom)
{
    for (uint32_t i = t->lines_count; i > 0; i--) {
        const struct trust_line *line = &t->lines[i - 1];
        if (party_fits(t, &line->who, who) && party_fits(t, &line->whom, whom)) {
            return line->allow;
        }
    }
    return false;
}

bool trust_allows_some(const struct trust *t, const struct trust_agent *who)
{
    for (uint32_t i = 0; i < t->lines_count; i++) {
        if (t->lines[i].allow && party_fits(t, &t->lines[i].who, who)) {
            return true;
        }
    }
    return false;
}
