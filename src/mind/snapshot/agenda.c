/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The agenda in a snapshot.  Facts that are asserted in another mind activate all rules again, also
 * those that have fired.  So each activation has a key that is equal in both minds, and an
 * activation whose key is not in the snapshot is deleted.
 */
#include "core/hash.h"
#include "mind/snapshot/fields.h"

#include <string.h>

/* CLIPS compiles a rule with an `or` to several rules of one name. */
static int disjunct_number(const struct defrule *rule)
{
    const struct constructHeader *h = rule->header.whichModule->firstItem;
    while (h && h->name != rule->header.name) {
        h = h->next;
    }
    int number = 0;
    for (const struct defrule *r = (const struct defrule *)h; r && r != rule; r = r->disjunct) {
        number++;
    }
    return number;
}

/* Adds the facts of an activation, and where the `$?` in them begin and end. */
static void basis_add(struct mu_text *key, const struct partialMatch *basis)
{
    for (unsigned i = 0; i < basis->bcount; i++) {
        const struct alphaMatch *match = basis->binds[i].gm.theMatch;
        mu_text_add(key, ",");
        value_add_match(key, match);
        for (const struct multifieldMarker *k = match ? match->markers : NULL; k; k = k->next) {
            mu_text_format(key, ":%d/%ld-%ld", k->whichField, k->startPosition, k->endPosition);
        }
    }
}

static void key_make(struct mu_text *key, const struct activation *a)
{
    const struct defrule *rule = a->theRule;
    mu_text_clear(key);
    mu_text_format(key, " %d", disjunct_number(rule));
    snapshot_add_word(key, ValueToString(rule->header.whichModule->theModule->name));
    snapshot_add_word(key, ValueToString(rule->header.name));
    mu_text_add(key, " ");
    basis_add(key, a->basis);
}

static void module_save(struct mind *m, struct mu_text *out)
{
    char bytes[SNAPSHOT_KEY_MAX];
    struct mu_text key = mu_text_in(bytes, sizeof bytes);
    for (struct activation *a = EnvGetNextActivation(m->env, NULL); a;
         a = EnvGetNextActivation(m->env, a)) {
        key_make(&key, a);
        int random = EnvGetStrategy(m->env) == RANDOM_STRATEGY ? a->randomID : 0;
        mu_text_format(out, "act %d %llu %d%s\n", a->salience, a->timetag, random, key.at);
        out->cut = out->cut || key.cut;
    }
}

void snapshot_save_agenda(struct mind *m, struct mu_text *out)
{
    for (struct defmodule *d = NULL; (d = environment_next_module(m, d));) {
        module_save(m, out);
    }
    mu_text_format(out, "agenda-end %llu\n", AgendaData(m->env)->CurrentTimetag);
    mu_text_add(out, "focus");
    for (const struct focus *f = EngineData(m->env)->CurrentFocus; f; f = f->next) {
        snapshot_add_word(out, ValueToString(f->theModule->name));
    }
    mu_text_add(out, "\n");
}

/* --- reading ---------------------------------------------------------------------------------- */

/* A line about the activation with that key; key NULL: the place is free. */
struct agenda_line {
    const char *key;
    size_t len;
    int salience, random;
    unsigned long long timetag;
};

/* A hash table of the lines by their keys, and how many activations were found again. */
struct agenda {
    struct agenda_line *lines;
    size_t places; /* a power of two, twice as many as lines at least */
    uint64_t count, found;
};

static struct agenda_line *agenda_place(const struct agenda *g, const char *key, size_t len)
{
    size_t at = (size_t)mu_hash_bytes(MU_HASH_EMPTY, key, len) & (g->places - 1);
    while (g->lines[at].key &&
           (g->lines[at].len != len || memcmp(g->lines[at].key, key, len) != 0)) {
        at = (at + 1) & (g->places - 1);
    }
    return &g->lines[at];
}

static void agenda_make(struct mind *m, struct agenda *g, const char *text)
{
    *g = (struct agenda){.places = 2};
    while (strncmp(text, "act ", 4) == 0) {
        text = strchr(text, '\n') + 1;
        g->count++;
    }
    while (g->places < 2 * g->count) {
        g->places *= 2;
    }
    g->lines = gm2(m->env, g->places * sizeof *g->lines);
    memset(g->lines, 0, g->places * sizeof *g->lines);
}

static bool agenda_read(struct snapshot *c, struct agenda *g)
{
    while (snapshot_line(c, "act")) {
        long long salience, random;
        uint64_t timetag;
        if (!snapshot_whole(c, &salience) || !snapshot_count(c, &timetag) ||
            !snapshot_whole(c, &random)) {
            return false;
        }
        struct agenda_line line = {.key = c->at,
                                   .len = strcspn(c->at, "\n"),
                                   .salience = (int)salience,
                                   .random = (int)random,
                                   .timetag = timetag};
        *agenda_place(g, line.key, line.len) = line;
        c->at += line.len + 1;
        c->line++;
    }
    return true;
}

static void module_load(struct mind *m, struct agenda *g)
{
    char bytes[SNAPSHOT_KEY_MAX];
    struct mu_text key = mu_text_in(bytes, sizeof bytes);
    struct activation *next;
    for (struct activation *a = EnvGetNextActivation(m->env, NULL); a; a = next) {
        next = EnvGetNextActivation(m->env, a);
        key_make(&key, a);
        const struct agenda_line *line = agenda_place(g, key.at, key.len);
        if (!line->key) {
            EnvDeleteActivation(m->env, a); /* it has fired */
            continue;
        }
        a->salience = line->salience;
        a->timetag = line->timetag;
        a->randomID = line->random;
        g->found++;
    }
    EnvReorderAgenda(m->env, EnvGetCurrentModule(m->env));
}

static mu_result activations_load(struct snapshot *c)
{
    struct mind *m = c->mind;
    struct agenda g;
    agenda_make(m, &g, c->at);
    bool read = agenda_read(c, &g);
    for (struct defmodule *d = NULL; read && (d = environment_next_module(m, d));) {
        module_load(m, &g);
    }
    rm(m->env, g.lines, g.places * sizeof *g.lines);
    if (!read) {
        return snapshot_wrong(c, "an activation");
    }
    return g.found == g.count
               ? MU_OK
               : mu_fault_at(c->fault, "capsule", c->line, 0,
                             "%llu of %llu activations do not come about again",
                             (unsigned long long)(g.count - g.found), (unsigned long long)g.count);
}

/* The stack was written from its top, so the last name is pushed first. */
static mu_result focus_load(struct snapshot *c)
{
    void *env = c->mind->env;
    struct multifield *names = snapshot_fields(c);
    bool good = names != NULL;
    for (long i = good ? names->multifieldLength : 0; i > 0 && good; i--) {
        const struct field *f = &names->theFields[i - 1];
        void *module = f->type == SYMBOL ? EnvFindDefmodule(env, ValueToString(f->value)) : NULL;
        good = module != NULL;
        if (good) {
            EnvFocus(env, module);
        }
    }
    ReturnMultifield(env, names);
    return good ? MU_OK : snapshot_wrong(c, "modules of the rules");
}

mu_result snapshot_load_agenda(struct snapshot *c)
{
    struct mind *m = c->mind;
    uint64_t timetag;
    MU_TRY(activations_load(c));
    if (!snapshot_line(c, "agenda-end") || !snapshot_count(c, &timetag) || !snapshot_end(c) ||
        !snapshot_line(c, "focus")) {
        return snapshot_wrong(c, "the end of the agenda");
    }
    AgendaData(m->env)->CurrentTimetag = timetag;
    EnvClearFocusStack(m->env);
    MU_TRY(focus_load(c));
    return snapshot_end(c) ? MU_OK : snapshot_wrong(c, "the end of the focus stack");
}
