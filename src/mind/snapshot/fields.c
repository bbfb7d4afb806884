/* SPDX-License-Identifier: Apache-2.0 */
/* The fields of a snapshot: every value of CLIPS, exact to the last bit. */
#include "mind/snapshot/fields.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

mu_result snapshot_wrong(struct snapshot *c, const char *what)
{
    return mu_fault_at(c->fault, "capsule", c->line, 0, "expected %s, found '%.40s'", what, c->at);
}

/* --- writing ---------------------------------------------------------------------------------- */

static void add_quoted(struct mu_text *out, char type, const char *s)
{
    mu_text_format(out, " %c\"", type);
    while (*s) {
        size_t plain = strcspn(s, "\"\\\n\r");
        mu_text_add_bytes(out, s, plain);
        s += plain;
        if (*s) {
            char escaped[3] = {'\\', *s == '\n' ? 'n' : *s == '\r' ? 'r' : *s, '\0'};
            mu_text_add(out, escaped);
            s++;
        }
    }
    mu_text_add(out, "\"");
}

void snapshot_add_word(struct mu_text *out, const char *word)
{
    add_quoted(out, 'y', word);
}

void snapshot_add_real(struct mu_text *out, double x)
{
    mu_text_format(out, " %a", x);
}

bool snapshot_add(struct mu_text *out, unsigned short type, const void *value)
{
    switch (type) {
    case INTEGER: mu_text_format(out, " i%lld", ValueToLong(value)); return true;
    case FLOAT: mu_text_format(out, " f%a", ValueToDouble(value)); return true;
    case SYMBOL: add_quoted(out, 'y', ValueToString(value)); return true;
    case STRING: add_quoted(out, 's', ValueToString(value)); return true;
    case INSTANCE_NAME: add_quoted(out, 'n', ValueToString(value)); return true;
    case FACT_ADDRESS: {
        const struct fact *f = value;
        mu_text_format(out, " a%lld", f->garbage ? SNAPSHOT_NONE : f->factIndex);
        return true;
    }
    default: return false;
    }
}

long long snapshot_index(const struct mind *m, struct fact *fact)
{
    return fact && EnvFactExistp(m->env, fact) ? fact->factIndex : SNAPSHOT_NONE;
}

/* --- reading ---------------------------------------------------------------------------------- */

static void skip_spaces(struct snapshot *c)
{
    c->at += strspn(c->at, " ");
}

bool snapshot_more(const struct snapshot *c)
{
    const char *at = c->at + strspn(c->at, " ");
    return *at && !strchr("\n()", *at);
}

struct fact *snapshot_fact(const struct snapshot *c, long long index)
{
    if (index < 0) {
        return NULL;
    }
    struct fact *f = EnvGetNextFact(c->mind->env, NULL);
    while (f && f->factIndex != index) {
        f = EnvGetNextFact(c->mind->env, f);
    }
    return f;
}

/* @return room enough for the text that begins here */
static size_t text_bytes(const char *at)
{
    const char *end = at + (*at == '"');
    while (*end && *end != '"' && *end != '\n') {
        end += *end == '\\' && end[1] ? 2 : 1;
    }
    return (size_t)(end - at) + 1;
}

/* Reads what stands in quotes.  @return false: no quotes */
static bool text_read(struct snapshot *c, char *to)
{
    const char *at = c->at;
    if (*at++ != '"') {
        return false;
    }
    while (*at && *at != '"' && *at != '\n') {
        bool escaped = *at == '\\' && at[1];
        at += escaped;
        *to++ = escaped && *at == 'n' ? '\n' : escaped && *at == 'r' ? '\r' : *at;
        at++;
    }
    *to = '\0';
    bool good = *at == '"';
    c->at = at + good;
    return good;
}

/* A text may be as long as the snapshot. */
static bool field_text(struct snapshot *c, unsigned short type, struct field *out)
{
    void *env = c->mind->env;
    size_t bytes = text_bytes(c->at);
    char *text = gm2(env, bytes);
    bool good = text_read(c, text);
    out->type = type;
    out->value = good ? EnvAddSymbol(env, text) : NULL;
    rm(env, text, bytes);
    return good;
}

static bool field_whole(struct snapshot *c, struct field *out)
{
    long long number;
    bool good = snapshot_whole(c, &number);
    out->type = INTEGER;
    out->value = good ? EnvAddLong(c->mind->env, number) : NULL;
    return good;
}

static bool field_real(struct snapshot *c, struct field *out)
{
    double number;
    bool good = snapshot_real(c, &number);
    out->type = FLOAT;
    out->value = good ? EnvAddDouble(c->mind->env, number) : NULL;
    return good;
}

static bool field_fact(struct snapshot *c, struct field *out)
{
    long long index;
    bool good = snapshot_whole(c, &index);
    struct fact *f = good ? snapshot_fact(c, index) : NULL;
    out->type = FACT_ADDRESS;
    out->value = f ? f : &FactData(c->mind->env)->DummyFact;
    return good;
}

bool snapshot_field(struct snapshot *c, struct field *out)
{
    skip_spaces(c);
    switch (*c->at) {
    case 'i': c->at++; return field_whole(c, out);
    case 'f': c->at++; return field_real(c, out);
    case 'y': c->at++; return field_text(c, SYMBOL, out);
    case 's': c->at++; return field_text(c, STRING, out);
    case 'n': c->at++; return field_text(c, INSTANCE_NAME, out);
    case 'a': c->at++; return field_fact(c, out);
    default: return false;
    }
}

/* @return how many fields there are up to the line's end or a parenthesis; -1: one is wrong */
static long fields_count(struct snapshot c)
{
    struct field skipped;
    long count = 0;
    while (snapshot_more(&c)) {
        if (!snapshot_field(&c, &skipped)) {
            return -1;
        }
        count++;
    }
    return count;
}

struct multifield *snapshot_fields(struct snapshot *c)
{
    long count = fields_count(*c);
    if (count < 0) {
        return NULL;
    }
    struct multifield *fields = CreateMultifield2(c->mind->env, count);
    for (long i = 0; i < count; i++) {
        (void)snapshot_field(c, &fields->theFields[i]);
    }
    return fields;
}

const char *snapshot_word(struct snapshot *c)
{
    struct field f;
    c->word = snapshot_field(c, &f) && f.type == SYMBOL ? ValueToString(f.value) : NULL;
    return c->word;
}

bool snapshot_whole(struct snapshot *c, long long *out)
{
    char *end;
    errno = 0;
    *out = strtoll(c->at, &end, 10);
    bool good = end != c->at && errno == 0;
    c->at = end;
    return good;
}

bool snapshot_count(struct snapshot *c, uint64_t *out)
{
    char *end;
    errno = 0;
    *out = strtoull(c->at, &end, 10);
    bool good = end != c->at && errno == 0;
    c->at = end;
    return good;
}

bool snapshot_real(struct snapshot *c, double *out)
{
    char *end;
    *out = strtod(c->at, &end);
    bool good = end != c->at;
    c->at = end;
    return good;
}

bool snapshot_line(struct snapshot *c, const char *word)
{
    size_t len = strlen(word);
    bool same = strncmp(c->at, word, len) == 0 && strchr(" \n", c->at[len]);
    c->at += same ? len : 0;
    return same;
}

bool snapshot_end(struct snapshot *c)
{
    skip_spaces(c);
    if (*c->at != '\n') {
        return false;
    }
    c->at++;
    c->line++;
    return true;
}
