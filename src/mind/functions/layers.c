/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Handlers of layers: deffunctions that see a mail before it becomes a fact.  A handler is kept by
 * its name, so that rules may redefine or remove the deffunction.
 */
#include "mind/functions/table.h"

#include <string.h>

struct deffunctionStruct *layers_function(const struct mind *m, const char *name)
{
    struct deffunctionStruct *f = EnvFindDeffunction(m->env, name);
    bool fits = f && f->minNumberOfParameters <= LAYERS_ARGUMENTS &&
                (f->maxNumberOfParameters < 0 || f->maxNumberOfParameters >= LAYERS_ARGUMENTS);
    return fits ? f : NULL;
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
