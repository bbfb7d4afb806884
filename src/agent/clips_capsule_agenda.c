/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The agenda in a capsule.  What a mind has fired is not on its agenda any more; when its facts are
 * asserted in another mind, everything is activated again.  So each activation has a key that is
 * the same in both, and what is not in the list is taken off.
 */
#include "agent/clips_capsule.h"

#include <string.h>

/* Rules with an `or` are several of one name. */
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

/* The facts that it stands on, and where in them `$?` begin and end. */
static void basis_add(struct mu_text *key, const struct partialMatch *basis)
{
    for (unsigned i = 0; i < basis->bcount; i++) {
        const struct alphaMatch *match = basis->binds[i].gm.theMatch;
        if (!match || !match->matchingItem) {
            mu_text_add(key, ",*");
            continue;
        }
        mu_text_format(key, ",%lld", ((const struct fact *)match->matchingItem)->factIndex);
        for (const struct multifieldMarker *k = match->markers; k; k = k->next) {
            mu_text_format(key, ":%d/%ld-%ld", k->whichField, k->startPosition, k->endPosition);
        }
    }
}

static void key_make(struct mu_text *key, const struct activation *a)
{
    const struct defrule *rule = a->theRule;
    mu_text_clear(key);
    mu_text_format(key, " %d", disjunct_number(rule));
    clips_capsule_add_word(key, ValueToString(rule->header.whichModule->theModule->name));
    clips_capsule_add_word(key, ValueToString(rule->header.name));
    mu_text_add(key, " ");
    basis_add(key, a->basis);
}

static void modules_each(struct mind *m, void *self, void (*visit)(struct mind *m, void *self))
{
    struct defmodule *current = EnvGetCurrentModule(m->env);
    for (struct defmodule *module = EnvGetNextDefmodule(m->env, NULL); module;
         module = EnvGetNextDefmodule(m->env, module)) {
        EnvSetCurrentModule(m->env, module);
        visit(m, self);
    }
    EnvSetCurrentModule(m->env, current);
}

static void module_save(struct mind *m, void *self)
{
    struct mu_text *out = self;
    char bytes[CLIPS_CAPSULE_KEY_MAX];
    struct mu_text key;
    mu_text_init(&key, bytes, sizeof bytes);
    for (struct activation *a = EnvGetNextActivation(m->env, NULL); a;
         a = EnvGetNextActivation(m->env, a)) {
        key_make(&key, a);
        int random = EnvGetStrategy(m->env) == RANDOM_STRATEGY ? a->randomID : 0;
        mu_text_format(out, "act %d %llu %d%s\n", a->salience, a->timetag, random, key.at);
        out->cut = out->cut || key.cut;
    }
}

void clips_capsule_save_agenda(struct mind *m, struct mu_text *out)
{
    modules_each(m, out, module_save);
    mu_text_format(out, "agenda-end %llu\n", AgendaData(m->env)->CurrentTimetag);
    mu_text_add(out, "focus");
    for (const struct focus *f = EngineData(m->env)->CurrentFocus; f; f = f->next) {
        clips_capsule_add_word(out, ValueToString(f->theModule->name));
    }
    mu_text_add(out, "\n");
}

/* --- reading ---------------------------------------------------------------------------------- */

/* The lines of the agenda, and how many of them were found again. */
struct agenda {
    const char *lines;
    uint64_t found;
};

/* Looks for the line of a key.  @return whether it is there, with what it says of the activation */
static bool agenda_find(const char *lines, const char *key, struct activation *a)
{
    size_t len = strlen(key);
    int salience, random;
    unsigned long long timetag;
    for (const char *at = lines; strncmp(at, "act ", 4) == 0; at = strchr(at, '\n') + 1) {
        int head = 0;
        bool read = sscanf(at, "act %d %llu %d%n", &salience, &timetag, &random, &head) == 3;
        if (read && strncmp(at + head, key, len) == 0 && at[head + len] == '\n') {
            a->salience = salience;
            a->timetag = timetag;
            a->randomID = random;
            return true;
        }
    }
    return false;
}

static void module_load(struct mind *m, void *self)
{
    struct agenda *agenda = self;
    char bytes[CLIPS_CAPSULE_KEY_MAX];
    struct mu_text key;
    mu_text_init(&key, bytes, sizeof bytes);
    struct activation *next;
    for (struct activation *a = EnvGetNextActivation(m->env, NULL); a; a = next) {
        next = EnvGetNextActivation(m->env, a);
        key_make(&key, a);
        if (agenda_find(agenda->lines, key.at, a)) {
            agenda->found++;
        } else {
            EnvDeleteActivation(m->env, a); /* it has fired */
        }
    }
    EnvReorderAgenda(m->env, EnvGetCurrentModule(m->env));
}

/* The stack was written from its top: the last comes first. */
static mu_result focus_load(struct capsule *c)
{
    struct capsule rest = *c;
    if (!clips_capsule_more(c)) {
        return MU_OK;
    }
    const char *word = clips_capsule_word(&rest);
    struct defmodule *module = word ? EnvFindDefmodule(c->mind->env, word) : NULL;
    if (!module) {
        return clips_capsule_wrong(c, "a module of the rules");
    }
    *c = rest;
    MU_TRY(focus_load(c));
    EnvFocus(c->mind->env, module);
    return MU_OK;
}

mu_result clips_capsule_load_agenda(struct capsule *c)
{
    struct mind *m = c->mind;
    struct agenda agenda = {.lines = c->at};
    uint64_t lines = 0, timetag;
    modules_each(m, &agenda, module_load);
    while (strncmp(c->at, "act ", 4) == 0) {
        c->at = strchr(c->at, '\n') + 1;
        c->line++;
        lines++;
    }
    if (agenda.found != lines) {
        return mu_fault_at(c->fault, "capsule", c->line, 0,
                           "%llu of %llu activations do not come about again",
                           (unsigned long long)(lines - agenda.found), (unsigned long long)lines);
    }
    if (!clips_capsule_line(c, "agenda-end") || !clips_capsule_count(c, &timetag) ||
        !clips_capsule_end(c) || !clips_capsule_line(c, "focus")) {
        return clips_capsule_wrong(c, "the end of the agenda");
    }
    AgendaData(m->env)->CurrentTimetag = timetag;
    EnvClearFocusStack(m->env);
    MU_TRY(focus_load(c));
    return clips_capsule_end(c) ? MU_OK : clips_capsule_wrong(c, "the end of the focus stack");
}
