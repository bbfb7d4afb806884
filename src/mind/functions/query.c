/* SPDX-License-Identifier: Apache-2.0 */
/*
 * (findall (relation field...)): the facts that match.
 *
 * The parser below turns the pattern into arguments of a plain call: the relation (as a template
 * when there is one already, so that CLIPS counts its use), a string with one letter for each part
 * of the pattern, then the values.  Letters: v a value to be equal to, ?
 * any field, $ any fields, ( a slot, whose name is the next value, and ) its end.
 */
#include "mind/functions/table.h"

#include <string.h>

enum { QUERY_PARTS_MAX = 64 };

struct query_parser {
    void *env;
    const char *source;
    struct expr *top, *last;
    char mask[QUERY_PARTS_MAX + 1];
    size_t parts;
    bool in_slot;
};

static void query_append(struct query_parser *p, struct expr *value)
{
    *(p->last ? &p->last->nextArg : &p->top->argList) = value;
    p->last = value;
}

static bool query_complain(struct query_parser *p, const char *what)
{
    PrintErrorID(p->env, "MUSTER", 4, TRUE);
    EnvPrintRouter(p->env, WERROR, "Function findall expected ");
    EnvPrintRouter(p->env, WERROR, what);
    EnvPrintRouter(p->env, WERROR, "\n");
    return false;
}

/* Writes "part" behind a blank in the pretty print form, as CLIPS does between arguments. */
static void query_token(struct query_parser *p, struct token *t)
{
    SavePPBuffer(p->env, " ");
    GetToken(p->env, p->source, t);
    if (t->type == RPAREN) {
        PPBackup(p->env);
        PPBackup(p->env);
        SavePPBuffer(p->env, ")");
    }
}

static bool query_is_explicit(const struct query_parser *p)
{
    const struct expr *relation = p->top->argList;
    return relation->type == DEFTEMPLATE_PTR &&
           !((const struct deftemplate *)relation->value)->implied;
}

/* Reads one part, no closing parenthesis.  @return false: an error was printed */
static bool query_part(struct query_parser *p, struct token *t)
{
    char letter = 'v';
    if (p->parts == QUERY_PARTS_MAX) {
        return query_complain(p, "at most 64 fields in a pattern");
    }
    if (t->type == SF_WILDCARD || t->type == MF_WILDCARD) {
        letter = t->type == SF_WILDCARD ? '?' : '$';
    } else if (t->type == LPAREN && !p->in_slot && query_is_explicit(p)) {
        GetToken(p->env, p->source, t);
        if (t->type != SYMBOL) {
            return query_complain(p, "the name of a slot behind a parenthesis");
        }
        query_append(p, GenConstant(p->env, SYMBOL, t->value));
        letter = '(';
        p->in_slot = true;
    } else {
        struct expr *value = ParseAtomOrExpression(p->env, p->source, t);
        if (!value) {
            return false;
        }
        query_append(p, value);
    }
    p->mask[p->parts++] = letter;
    return true;
}

/* @return false: an error was printed */
static bool query_pattern(struct query_parser *p)
{
    struct token t;
    query_token(p, &t);
    if (t.type != LPAREN) {
        return query_complain(p, "a pattern in parentheses");
    }
    GetToken(p->env, p->source, &t);
    if (t.type != SYMBOL) {
        return query_complain(p, "the name of a relation behind the parenthesis");
    }
    sensors_note(environment_mind(p->env), ValueToString(t.value));
    struct deftemplate *relation = EnvFindDeftemplate(p->env, ValueToString(t.value));
    query_append(p, relation ? GenConstant(p->env, DEFTEMPLATE_PTR, relation)
                             : GenConstant(p->env, SYMBOL, t.value));
    struct expr *mask = GenConstant(p->env, STRING, EnvAddSymbol(p->env, ""));
    query_append(p, mask);
    for (query_token(p, &t); t.type != RPAREN || p->in_slot; query_token(p, &t)) {
        if (t.type == RPAREN) {
            p->in_slot = false;
            p->mask[p->parts++] = ')';
        } else if (!query_part(p, &t)) {
            return false;
        }
        if (p->parts > QUERY_PARTS_MAX) {
            return query_complain(p, "at most 64 fields in a pattern");
        }
    }
    p->mask[p->parts] = '\0';
    mask->value = EnvAddSymbol(p->env, p->mask);
    query_token(p, &t);
    return t.type == RPAREN || query_complain(p, "one pattern");
}

struct expr *query_parse(void *env, struct expr *top, const char *source)
{
    struct query_parser p = {.env = env, .source = source, .top = top};
    if (query_pattern(&p)) {
        return top;
    }
    ReturnExpression(env, top);
    return NULL;
}

/* A pattern with its values. */
struct query {
    char mask[QUERY_PARTS_MAX + 1];
    DATA_OBJECT values[QUERY_PARTS_MAX];
};

static bool query_equal(const struct field *f, const DATA_OBJECT *value)
{
    return f->type == value->type && f->value == value->value;
}

/* @return whether fields match the mask up to a ')' or its end */
static bool query_match(const struct field *f, long count, const char *mask,
                        const DATA_OBJECT *value)
{
    if (*mask == '\0' || *mask == ')') {
        return count == 0;
    }
    if (*mask == '$') {
        for (long skip = 0; skip <= count; skip++) {
            if (query_match(f + skip, count - skip, mask + 1, value)) {
                return true;
            }
        }
        return false;
    }
    if (count == 0 || (*mask == 'v' && !query_equal(f, value))) {
        return false;
    }
    return query_match(f + 1, count - 1, mask + 1, value + (*mask == 'v'));
}

static bool query_match_slot(const struct fact *f, const char *mask, const DATA_OBJECT *value)
{
    short index;
    struct templateSlot *slot = FindSlot(f->whichDeftemplate, value->value, &index);
    if (!slot) {
        return false;
    }
    const struct field *content = &f->theProposition.theFields[index - 1];
    if (!slot->multislot) {
        return query_match(content, 1, mask + 1, value + 1);
    }
    const struct multifield *fields = content->value;
    return query_match(fields->theFields, fields->multifieldLength, mask + 1, value + 1);
}

static bool query_match_fact(const struct fact *f, const struct query *pattern)
{
    if (f->whichDeftemplate->implied) {
        const struct multifield *fields = f->theProposition.theFields[0].value;
        return query_match(fields->theFields, fields->multifieldLength, pattern->mask,
                           pattern->values);
    }
    const DATA_OBJECT *value = pattern->values;
    for (const char *mask = pattern->mask; *mask; mask++) {
        if (*mask == '(' && !query_match_slot(f, mask, value)) {
            return false;
        }
        value += *mask == '(' || *mask == 'v';
    }
    return true;
}

/* Evaluates the values of a pattern.  @return false: one ended in an error */
static bool query_read(void *env, const char *mask, struct query *pattern)
{
    size_t values = 0;
    size_t len = strlen(mask);
    if (len > QUERY_PARTS_MAX) {
        return false;
    }
    memcpy(pattern->mask, mask, len + 1);
    for (size_t i = 0; i < len; i++) {
        if (mask[i] == 'v' || mask[i] == '(') {
            if (!value_any(env, (int)values + 3, &pattern->values[values])) {
                return false;
            }
            values++;
        }
    }
    return true;
}

static struct deftemplate *query_template(void *env)
{
    const struct expr *relation = EvaluationData(env)->CurrentExpression->argList;
    return relation->type == DEFTEMPLATE_PTR
               ? relation->value
               : EnvFindDeftemplate(env, ValueToString(relation->value));
}

void query_findall(void *env, DATA_OBJECT *out)
{
    struct query pattern;
    const char *mask;
    long count = 0;
    EnvSetMultifieldErrorValue(env, out);
    if (EnvRtnArgCount(env) < 2) {
        value_refuse(env, "findall", "a pattern in parentheses");
        return;
    }
    if (!value_word(env, "findall", 2, &mask) || !query_read(env, mask, &pattern)) {
        return;
    }
    percept_show(environment_mind(env));
    struct deftemplate *t = query_template(env);
    if (!t) {
        return; /* no fact of this relation was ever there */
    }
    for (struct fact *f = t->factList; f; f = f->nextTemplateFact) {
        count += query_match_fact(f, &pattern);
    }
    struct multifield *facts = EnvCreateMultifield(env, count);
    long i = 0;
    for (struct fact *f = t->factList; f; f = f->nextTemplateFact) {
        if (query_match_fact(f, &pattern)) {
            facts->theFields[i].type = FACT_ADDRESS;
            facts->theFields[i++].value = f;
        }
    }
    value_multifield(out, facts);
}

void query_fields(void *env, DATA_OBJECT *out)
{
    DATA_OBJECT arg;
    EnvSetMultifieldErrorValue(env, out);
    if (!value_any(env, 1, &arg)) {
        return;
    }
    struct fact *f = arg.type == FACT_ADDRESS ? arg.value : NULL;
    if (arg.type == INTEGER) {
        f = FindIndexedFact(env, ((struct integerHashNode *)arg.value)->contents);
    }
    if (!f || f->garbage || !f->whichDeftemplate->implied) {
        value_refuse(env, "fact-fields", "an ordered fact that is there");
        return;
    }
    const struct multifield *content = f->theProposition.theFields[0].value;
    struct multifield *fields = EnvCreateMultifield(env, content->multifieldLength);
    memcpy(fields->theFields, content->theFields,
           (size_t)content->multifieldLength * sizeof content->theFields[0]);
    value_multifield(out, fields);
}
