/* SPDX-License-Identifier: Apache-2.0 */
/* Settings of a person at a console: breakpoints, and watched items. */
#include "mind/snapshot/fields.h"

#include <string.h>

/* In the order of a snapshot; facts, rules and activations have exceptions by construct. */
static const char *const items[] = {"facts", "rules",   "activations",
                                    "focus", "globals", "deffunctions"};

enum { ITEMS = sizeof items / sizeof items[0] };

static bool is_watched(struct mind *m, const char *item)
{
    return EnvGetWatchItem(m->env, item) > 0;
}

/* --- saving ----------------------------------------------------------------------------------- */

static void name_add(struct mu_text *out, const char *word, const struct constructHeader *h)
{
    mu_text_add(out, word);
    snapshot_add_word(out, ValueToString(h->whichModule->theModule->name));
    snapshot_add_word(out, ValueToString(h->name));
}

static void rules_save(struct mind *m, struct mu_text *out)
{
    bool firings = is_watched(m, "rules"), activations = is_watched(m, "activations");
    for (struct defrule *r = EnvGetNextDefrule(m->env, NULL); r; r = EnvGetNextDefrule(m->env, r)) {
        if (r->afterBreakpoint || r->watchFiring != firings || r->watchActivation != activations) {
            name_add(out, "rule", &r->header);
            mu_text_format(out, " %d %d %d\n", r->afterBreakpoint, r->watchFiring,
                           r->watchActivation);
        }
    }
}

static void templates_save(struct mind *m, struct mu_text *out)
{
    bool facts = is_watched(m, "facts");
    for (struct deftemplate *t = EnvGetNextDeftemplate(m->env, NULL); t;
         t = EnvGetNextDeftemplate(m->env, t)) {
        if (t->watch != facts) {
            name_add(out, "relation", &t->header);
            mu_text_format(out, " %d\n", t->watch);
        }
    }
}

void snapshot_save_watch(struct mind *m, struct mu_text *out)
{
    mu_text_add(out, "watch");
    for (size_t i = 0; i < ITEMS; i++) {
        mu_text_format(out, " %d", is_watched(m, items[i]));
    }
    mu_text_format(out, " %d", output_of(m)->passes);
    snapshot_add_word(out, output_of(m)->stands);
    mu_text_add(out, "\n");
    for (struct defmodule *d = NULL; (d = environment_next_module(m, d));) {
        rules_save(m, out);
        templates_save(m, out);
    }
}

/* --- loading ---------------------------------------------------------------------------------- */

/* Reads a module and makes it the current one.  @return whether it is there */
static bool module_load(struct snapshot *c)
{
    struct defmodule *module = snapshot_word(c) ? EnvFindDefmodule(c->mind->env, c->word) : NULL;
    if (module) {
        EnvSetCurrentModule(c->mind->env, module);
    }
    return module != NULL;
}

static bool flags_load(struct snapshot *c, uint64_t *flags, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!snapshot_count(c, &flags[i]) || flags[i] > 1) {
            return false;
        }
    }
    return snapshot_end(c);
}

static bool rule_load(struct snapshot *c)
{
    void *env = c->mind->env;
    uint64_t flags[3];
    struct defrule *rule = module_load(c) && snapshot_word(c) ? EnvFindDefrule(env, c->word) : NULL;
    if (!rule || !flags_load(c, flags, 3)) {
        return false;
    }
    if (flags[0]) {
        EnvSetBreak(env, rule);
    }
    EnvSetDefruleWatchFirings(env, flags[1] != 0, rule);
    EnvSetDefruleWatchActivations(env, flags[2] != 0, rule);
    return true;
}

static bool template_load(struct snapshot *c)
{
    void *env = c->mind->env;
    uint64_t watch;
    struct deftemplate *t =
        module_load(c) && snapshot_word(c) ? EnvFindDeftemplate(env, c->word) : NULL;
    if (!t || !flags_load(c, &watch, 1)) {
        return false;
    }
    EnvSetDeftemplateWatch(env, watch != 0, t);
    return true;
}

static bool items_load(struct snapshot *c)
{
    uint64_t on = 0;
    for (size_t i = 0; i < ITEMS; i++) {
        if (!snapshot_count(c, &on) || on > 1) {
            return false;
        }
        if (on) {
            (void)EnvWatch(c->mind->env, items[i]);
        }
    }
    bool good =
        snapshot_count(c, &on) && snapshot_word(c) &&
        mu_text_copy(output_of(c->mind)->stands, sizeof output_of(c->mind)->stands, c->word);
    output_of(c->mind)->passes = on != 0;
    return good && snapshot_end(c);
}

mu_result snapshot_load_watch(struct snapshot *c)
{
    bool good = snapshot_line(c, "watch") && items_load(c);
    for (bool more = true; good && more;) {
        if (snapshot_line(c, "rule")) {
            good = rule_load(c);
        } else if (snapshot_line(c, "relation")) {
            good = template_load(c);
        } else {
            more = false;
        }
    }
    return good ? MU_OK : snapshot_wrong(c, "breakpoints and what is watched");
}
