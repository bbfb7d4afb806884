/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Handlers of layers: deffunctions that see a mail before it becomes a fact.  A handler is kept by
 * its name, so that rules may redefine or remove the deffunction.  So is the one that resolves
 * addresses.
 */
#include "core/name.h"
#include "mind/functions/table.h"

#include <string.h>

/* @return the deffunction of that name if it takes so many arguments, or NULL */
static struct deffunctionStruct *function_that_takes(const struct mind *m, const char *name,
                                                     int arguments)
{
    struct deffunctionStruct *f = EnvFindDeffunction(m->env, name);
    bool fits = f && f->minNumberOfParameters <= arguments &&
                (f->maxNumberOfParameters < 0 || f->maxNumberOfParameters >= arguments);
    return fits ? f : NULL;
}

struct deffunctionStruct *layers_function(const struct mind *m, const char *name)
{
    return function_that_takes(m, name, LAYERS_ARGUMENTS);
}

mu_result layers_add(struct mind *m, uint32_t layer, const char *function)
{
    size_t place = 0;
    if (!layers_function(m, function)) {
        return MU_ABSENT;
    }
    SYMBOL_HN *name = EnvAddSymbol(m->env, function);
    while (place < output_of(m)->handler_count &&
           (output_of(m)->handlers[place].layer != layer ||
            output_of(m)->handlers[place].function != name)) {
        place++;
    }
    if (place == LAYERS_HANDLERS_MAX) {
        return MU_FULL;
    }
    if (place < output_of(m)->handler_count) { /* it is there already, and becomes the youngest */
        output_of(m)->handler_count--;
        memmove(&output_of(m)->handlers[place], &output_of(m)->handlers[place + 1],
                (output_of(m)->handler_count - place) * sizeof output_of(m)->handlers[0]);
    } else {
        IncrementSymbolCount(name);
    }
    output_of(m)->handlers[output_of(m)->handler_count++] =
        (struct layers_handler){.layer = layer, .function = name};
    return MU_OK;
}

void layers_on(void *env, DATA_OBJECT *out)
{
    long long layer;
    const char *function;
    value_bool(env, out, false);
    if (!value_whole(env, "on-layer", 1, &layer) || !value_word(env, "on-layer", 2, &function)) {
        return;
    }
    if (layer < 1 || layer > UINT32_MAX) {
        value_refuse(env, "on-layer", "a layer: a whole number from 1 on");
        return;
    }
    mu_result r = layers_add(environment_mind(env), (uint32_t)layer, function);
    if (r == MU_ABSENT) {
        value_refuse(env, "on-layer",
                     "a deffunction that takes four arguments: id, from, performative, "
                     "content");
    } else if (r == MU_FULL) {
        value_refuse(env, "on-layer", "at most 32 handlers");
    }
    value_bool(env, out, r == MU_OK);
}

/* --- addresses -------------------------------------------------------------------------------- */

struct deffunctionStruct *layers_resolver(const struct mind *m)
{
    const SYMBOL_HN *name = output_of(m)->resolver;
    return name ? function_that_takes(m, ValueToString(name), RESOLVER_ARGUMENTS) : NULL;
}

mu_result layers_set_resolver(struct mind *m, const char *scheme, const char *function)
{
    struct mind_output *out = output_of(m);
    if (!mu_name_valid(scheme) || strcmp(scheme, "group") == 0) { /* groups are the broker's */
        return MU_MALFORMED;
    }
    if (!function_that_takes(m, function, RESOLVER_ARGUMENTS)) {
        return MU_ABSENT;
    }
    SYMBOL_HN *before = out->resolver;
    out->resolver = EnvAddSymbol(m->env, function);
    IncrementSymbolCount(out->resolver);
    if (before) {
        DecrementSymbolCount(m->env, before);
    }
    (void)mu_text_copy(out->scheme, sizeof out->scheme, scheme);
    return MU_OK;
}

mu_result layers_resolve(struct mind *m, const char *scheme, const char *function)
{
    const struct mind_ports *ports = &m->options.ports;
    mu_result r = layers_set_resolver(m, scheme, function);
    if (r != MU_OK || !ports->change) {
        return r;
    }
    return ports->change(ports->self, MIND_RESOLVE, output_of(m)->scheme, "", 0);
}

void layers_on_resolve(void *env, DATA_OBJECT *out)
{
    const char *scheme, *function;
    value_bool(env, out, false);
    if (!value_word(env, "on-resolve", 1, &scheme) ||
        !value_word(env, "on-resolve", 2, &function)) {
        return;
    }
    mu_result r = layers_resolve(environment_mind(env), scheme, function);
    if (r == MU_MALFORMED) {
        value_refuse(env, "on-resolve", "the name of a scheme, and not group");
    } else if (r == MU_ABSENT) {
        value_refuse(env, "on-resolve", "a deffunction that takes two arguments: rest, sender");
    }
    value_bool(env, out, r == MU_OK);
}
