/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Globals and facts in a snapshot.  Facts keep their indices and their order, which may differ from
 * the order of indices: see percept_show.
 */
#include "mind/snapshot/fields.h"

#include <string.h>

static bool fields_add(struct mu_text *out, const struct multifield *fields, long first, long last)
{
    for (long i = first; i <= last; i++) {
        if (!snapshot_add(out, fields->theFields[i].type, fields->theFields[i].value)) {
            return false;
        }
    }
    return true;
}

/* --- globals ---------------------------------------------------------------------------------- */

static bool global_save(struct mu_text *out, const struct defglobal *g)
{
    const DATA_OBJECT *value = &g->current;
    bool many = value->type == MULTIFIELD;
    mu_text_add(out, "global");
    snapshot_add_word(out, ValueToString(g->header.whichModule->theModule->name));
    snapshot_add_word(out, ValueToString(g->header.name));
    mu_text_add(out, many ? " many" : " one");
    bool good = many ? fields_add(out, value->value, value->begin, value->end)
                     : snapshot_add(out, value->type, value->value);
    mu_text_add(out, "\n");
    return good;
}

bool snapshot_save_globals(struct mind *m, struct mu_text *out, const char **why)
{
    bool good = true;
    for (struct defmodule *d = NULL; (d = environment_next_module(m, d));) {
        for (struct defglobal *g = EnvGetNextDefglobal(m->env, NULL); g && good;
             g = EnvGetNextDefglobal(m->env, g)) {
            good = global_save(out, g);
        }
    }
    *why = good ? NULL : "a global holds an address that means nothing elsewhere";
    return good;
}

/* Reads a module, which becomes the current one, and a name in it.  @return NULL: there is none */
static const char *name_load(struct snapshot *c)
{
    void *env = c->mind->env;
    const char *word = snapshot_word(c);
    struct defmodule *module = word ? EnvFindDefmodule(env, word) : NULL;
    word = snapshot_word(c);
    if (!module || !word) {
        return NULL;
    }
    EnvSetCurrentModule(env, module);
    return word;
}

/* @return the global that a line names; NULL: there is none */
static struct defglobal *global_find(struct snapshot *c)
{
    const char *name = name_load(c);
    return name ? EnvFindDefglobal(c->mind->env, name) : NULL;
}

static mu_result global_load(struct snapshot *c)
{
    struct defglobal *g = global_find(c);
    bool many = strncmp(c->at, " many", 5) == 0;
    if (!g || (!many && strncmp(c->at, " one", 4) != 0)) {
        return snapshot_wrong(c, "a global of the rules");
    }
    c->at += many ? 5 : 4;
    struct multifield *fields = snapshot_fields(c);
    if (!fields) {
        return snapshot_wrong(c, "the value of a global");
    }
    if (!many && fields->multifieldLength != 1) {
        ReturnMultifield(c->mind->env, fields);
        return snapshot_wrong(c, "one value of a global");
    }
    DATA_OBJECT value = {.type = MULTIFIELD, .end = fields->multifieldLength - 1};
    value.value = fields;
    if (!many) {
        value.type = fields->theFields[0].type;
        value.value = fields->theFields[0].value;
    }
    QSetDefglobalValue(c->mind->env, g, &value, FALSE);
    ReturnMultifield(c->mind->env, fields);
    return snapshot_end(c) ? MU_OK : snapshot_wrong(c, "the end of a global");
}

mu_result snapshot_load_globals(struct snapshot *c)
{
    mu_result r = MU_OK;
    while (r == MU_OK && snapshot_line(c, "global")) {
        r = global_load(c);
    }
    return r;
}

/* --- facts ------------------------------------------------------------------------------------ */

static bool fact_save(struct mu_text *out, const struct fact *f)
{
    const struct deftemplate *t = f->whichDeftemplate;
    const struct field *slots = f->theProposition.theFields;
    bool good = true;
    mu_text_format(out, "fact %lld", f->factIndex);
    snapshot_add_word(out, ValueToString(t->header.whichModule->theModule->name));
    snapshot_add_word(out, ValueToString(t->header.name));
    long count = t->implied ? 1 : (long)t->numberOfSlots;
    for (long i = 0; i < count && good; i++) {
        if (slots[i].type == MULTIFIELD) {
            const struct multifield *fields = slots[i].value;
            mu_text_add(out, " (");
            good = fields_add(out, fields, 0, fields->multifieldLength - 1);
            mu_text_add(out, " )");
        } else {
            good = snapshot_add(out, slots[i].type, slots[i].value);
        }
    }
    mu_text_add(out, "\n");
    return good;
}

bool snapshot_save_facts(struct mind *m, struct mu_text *out, const char **why)
{
    *why = NULL;
    for (struct fact *f = EnvGetNextFact(m->env, NULL); f && !*why; f = EnvGetNextFact(m->env, f)) {
        if (f->factHeader.dependents) {
            *why = "a fact has logical support";
        } else if (!fact_save(out, f)) {
            *why = "a fact holds an address that means nothing elsewhere";
        }
    }
    mu_text_format(out, "facts-end %lld\n", FactData(m->env)->NextFactIndex);
    return !*why;
}

/*
 * @return the template that a line names; NULL: there is none.  Creates one of ordered facts if no
 * rule has it.
 */
static struct deftemplate *template_find(struct snapshot *c)
{
    void *env = c->mind->env;
    const char *name = name_load(c);
    if (!name) {
        return NULL;
    }
    struct deftemplate *t = EnvFindDeftemplate(env, name);
    return t ? t : CreateImpliedDeftemplate(env, EnvAddSymbol(env, name), TRUE);
}

static bool slot_load(struct snapshot *c, struct field *slot)
{
    c->at += strspn(c->at, " ");
    if (*c->at != '(') {
        return snapshot_field(c, slot);
    }
    c->at++;
    slot->value = snapshot_fields(c);
    slot->type = slot->value ? MULTIFIELD : RVOID;
    c->at += strspn(c->at, " ");
    bool closed = slot->value && *c->at == ')';
    c->at += closed;
    return closed;
}

static bool slots_load(struct snapshot *c, const struct deftemplate *t, struct field *slots)
{
    const struct templateSlot *slot = t->slotList; /* none: ordered facts */
    long count = t->implied ? 1 : (long)t->numberOfSlots;
    bool good = true;
    for (long i = 0; i < count; i++) {
        bool many = t->implied || slot->multislot;
        if (slots[i].type == MULTIFIELD) {
            ReturnMultifield(c->mind->env, slots[i].value);
        }
        slots[i].type = RVOID;
        good = good && slot_load(c, &slots[i]) && (slots[i].type == MULTIFIELD) == many;
        slot = slot ? slot->next : NULL;
    }
    return good;
}

static mu_result fact_load(struct snapshot *c)
{
    void *env = c->mind->env;
    long long index;
    struct deftemplate *t = snapshot_whole(c, &index) ? template_find(c) : NULL;
    if (!t || index < 0) {
        return snapshot_wrong(c, "a fact");
    }
    struct fact *f = EnvCreateFact(env, t);
    if (!slots_load(c, t, f->theProposition.theFields)) {
        ReturnFact(env, f);
        return snapshot_wrong(c, "the fields of a fact");
    }
    FactData(env)->NextFactIndex = index;
    if (!EnvAssert(env, f) || !snapshot_end(c)) {
        return snapshot_wrong(c, "a fact that can be asserted");
    }
    return MU_OK;
}

mu_result snapshot_load_facts(struct snapshot *c)
{
    void *env = c->mind->env;
    long long next;
    mu_result r = MU_OK;
    FactData(env)->NextFactIndex = 0;
    int duplication = EnvSetFactDuplication(env, TRUE);
    while (r == MU_OK && snapshot_line(c, "fact")) {
        r = fact_load(c);
    }
    EnvSetFactDuplication(env, duplication);
    MU_TRY(r);
    if (!snapshot_line(c, "facts-end") || !snapshot_whole(c, &next) || next < 0 ||
        !snapshot_end(c)) {
        return snapshot_wrong(c, "the end of the facts");
    }
    FactData(env)->NextFactIndex = next;
    return MU_OK;
}
