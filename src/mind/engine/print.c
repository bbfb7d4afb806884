/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the engine prints goes word by word to the first router that knows the name: a listing of a
 * thousand facts is five thousand words, and a robot lists them between two steps.
 */
#include "mind/engine/clips_engine.h"

#include <router.h>
#include <stdio.h>

enum { PRINT_UNITS = 16 }; /* what a word costs, with one for each byte */

static bool print_is_for(void *env, const struct router *r, const char *name)
{
    if (!r->printer || !r->active || !r->query) {
        return false;
    }
    SetEnvironmentRouterContext(env, r->context);
    return r->query(env, name) == TRUE;
}

int EnvPrintRouter(void *env, const char *name, const char *text)
{
    struct mind *m = clips_engine_mind(env);
    if (m) {
        m->units += PRINT_UNITS + strlen(text);
    }
    if ((const char *)RouterData(env)->FastSaveFilePtr == name) {
        fputs(text, RouterData(env)->FastSaveFilePtr);
        return 2;
    }
    for (const struct router *r = RouterData(env)->ListOfRouters; r; r = r->next) {
        if (print_is_for(env, r, name)) {
            r->printer(env, name, text);
            return 1;
        }
    }
    if (strcmp(WERROR, name) != 0) {
        UnrecognizedRouterMessage(env, name);
    }
    return 0;
}
