/* SPDX-License-Identifier: Apache-2.0 */
#include "core/attributes.h"

#include "core/name.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* A piece of a text. */
struct piece {
    const char *at;
    size_t len;
};

/* Takes the next word.  @return false at the end */
static bool word_next(const char **text, struct piece *word)
{
    *text += strspn(*text, " ");
    *word = (struct piece){.at = *text, .len = strcspn(*text, " ")};
    *text += word->len;
    return word->len > 0;
}

/* Nothing that would not be seen, or that ends a word elsewhere. */
static bool piece_is_plain(struct piece p)
{
    for (size_t i = 0; i < p.len; i++) {
        if ((unsigned char)p.at[i] <= ' ' || p.at[i] == 127) {
            return false;
        }
    }
    return p.len > 0;
}

static bool piece_copy(struct piece p, char *to, size_t size)
{
    if (p.len >= size) {
        return false;
    }
    memcpy(to, p.at, p.len);
    to[p.len] = '\0';
    return true;
}

static bool piece_is(struct piece p, const char *text)
{
    return strncmp(text, p.at, p.len) == 0 && text[p.len] == '\0';
}

/* Splits key, relation and value.  @return whether it is that, and the key a name */
static bool word_split(struct piece word, struct piece *key, struct piece *relation,
                       struct piece *value)
{
    char name[MU_NAME_MAX + 1];
    *key = (struct piece){.at = word.at, .len = strcspn(word.at, "=!<> ")};
    if (key->len >= word.len || !piece_copy(*key, name, sizeof name) || !mu_name_valid(name)) {
        return false;
    }
    relation->at = word.at + key->len;
    relation->len = strspn(relation->at, "=!<>");
    value->at = relation->at + relation->len;
    value->len = word.len - key->len - relation->len;
    return piece_is_plain(*value) && value->len <= MU_FIELD_MAX;
}

/* Decimal numbers alone: what strtod knows beside them (0x1p3, inf, nan) is text. */
static bool number_read(struct piece p, double *number)
{
    char text[MU_FIELD_MAX + 1];
    char *end;
    if (!piece_copy(p, text, sizeof text) || p.len == 0 ||
        strspn(text, "0123456789+-.eE") != p.len) {
        return false;
    }
    *number = strtod(text, &end);
    return *end == '\0' && isfinite(*number);
}

/* --- attributes ------------------------------------------------------------------------------- */

/* @return whether there is an attribute of that name, and its value */
static bool attribute_find(const char *attributes, struct piece name, struct piece *value)
{
    struct piece word;
    while (word_next(&attributes, &word)) {
        const char *equals = memchr(word.at, '=', word.len);
        size_t len = equals ? (size_t)(equals - word.at) : 0;
        if (equals && len == name.len && memcmp(word.at, name.at, len) == 0) {
            *value = (struct piece){.at = equals + 1, .len = word.len - len - 1};
            return true;
        }
    }
    return false;
}

bool mu_attributes_valid(const char *text)
{
    struct piece word, key, relation, value, first;
    if (strnlen(text, MU_ATTRIBUTES_MAX + 1) > MU_ATTRIBUTES_MAX) {
        return false;
    }
    for (const char *at = text; word_next(&at, &word);) {
        if (!word_split(word, &key, &relation, &value) || !piece_is(relation, "=")) {
            return false;
        }
        if (!attribute_find(text, key, &first) || first.at != value.at) {
            return false; /* said twice */
        }
    }
    return true;
}

/* --- queries ---------------------------------------------------------------------------------- */

static bool relation_read(struct piece p, enum mu_relation *relation)
{
    static const char *const words[] = {"=", "!=", "<", "<=", ">", ">="};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (piece_is(p, words[i])) {
            *relation = (enum mu_relation)i;
            return true;
        }
    }
    return false;
}

/* Reads x,y,r. */
static bool near_read(struct piece value, struct mu_constraint *c)
{
    double *const numbers[] = {&c->x_m, &c->y_m, &c->radius_m};
    for (size_t i = 0; i < 3; i++) {
        const char *comma = i < 2 ? memchr(value.at, ',', value.len) : value.at + value.len;
        struct piece number = {.at = value.at, .len = comma ? (size_t)(comma - value.at) : 0};
        if (!comma || !number_read(number, numbers[i])) {
            return false;
        }
        value.len -= i < 2 ? number.len + 1 : number.len;
        value.at = comma + 1;
    }
    return c->radius_m >= 0.0;
}

static bool constraint_read(struct piece word, struct mu_constraint *c)
{
    struct piece key, relation, value;
    *c = (struct mu_constraint){0};
    if (!word_split(word, &key, &relation, &value) || !relation_read(relation, &c->relation) ||
        !piece_copy(key, c->key, sizeof c->key) || !piece_copy(value, c->value, sizeof c->value)) {
        return false;
    }
    if (c->relation == MU_RELATION_EQUAL && strcmp(c->key, "near") == 0) {
        c->relation = MU_RELATION_NEAR;
        return near_read(value, c);
    }
    c->is_number = number_read(value, &c->number);
    return c->is_number || c->relation <= MU_RELATION_UNEQUAL;
}

mu_result mu_attributes_query(struct mu_query *q, const char *text)
{
    struct piece word;
    q->count = 0;
    if (strnlen(text, MU_QUERY_MAX + 1) > MU_QUERY_MAX || !word_next(&text, &word) ||
        !piece_copy(word, q->service, sizeof q->service) ||
        !(mu_name_valid(q->service) || strcmp(q->service, "*") == 0)) {
        return MU_MALFORMED;
    }
    while (word_next(&text, &word)) {
        if (q->count == MU_CONSTRAINTS_MAX) {
            return MU_FULL;
        }
        if (!constraint_read(word, &q->constraints[q->count++])) {
            return MU_MALFORMED;
        }
    }
    return MU_OK;
}

static bool number_of(const char *attributes, const char *key, double *number)
{
    struct piece value;
    return attribute_find(attributes, (struct piece){.at = key, .len = strlen(key)}, &value) &&
           number_read(value, number);
}

static bool near_holds(const struct mu_constraint *c, const char *attributes)
{
    double x_m, y_m;
    if (!number_of(attributes, "x", &x_m) || !number_of(attributes, "y", &y_m)) {
        return false;
    }
    double dx_m = x_m - c->x_m, dy_m = y_m - c->y_m;
    return dx_m * dx_m + dy_m * dy_m <= c->radius_m * c->radius_m;
}

static bool numbers_hold(enum mu_relation relation, double a, double b)
{
    switch (relation) {
    case MU_RELATION_EQUAL: return a >= b && a <= b;
    case MU_RELATION_UNEQUAL: return a < b || a > b;
    case MU_RELATION_LESS: return a < b;
    case MU_RELATION_AT_MOST: return a <= b;
    case MU_RELATION_MORE: return a > b;
    case MU_RELATION_AT_LEAST: return a >= b;
    case MU_RELATION_NEAR: break;
    }
    return false;
}

static bool constraint_holds(const struct mu_constraint *c, const char *attributes)
{
    struct piece value;
    double number;
    if (c->relation == MU_RELATION_NEAR) {
        return near_holds(c, attributes);
    }
    if (!attribute_find(attributes, (struct piece){.at = c->key, .len = strlen(c->key)}, &value)) {
        return false;
    }
    if (c->is_number && number_read(value, &number)) {
        return numbers_hold(c->relation, number, c->number);
    }
    bool same = piece_is(value, c->value);
    return c->relation == MU_RELATION_EQUAL ? same : c->relation == MU_RELATION_UNEQUAL && !same;
}

bool mu_attributes_match(const struct mu_query *q, const char *service, const char *attributes)
{
    if (strcmp(q->service, "*") != 0 && strcmp(q->service, service) != 0) {
        return false;
    }
    for (unsigned i = 0; i < q->count; i++) {
        if (!constraint_holds(&q->constraints[i], attributes)) {
            return false;
        }
    }
    return true;
}
