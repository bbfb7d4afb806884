/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the engine prints goes word by word to the first router that knows the name: a listing of a
 * thousand facts is five thousand words, and a robot lists them between two steps.
 */
#include "agent/clips_engine.h"
#include "agent/clips_number.h"

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

void PrintLongInteger(void *env, const char *name, long long number)
{
    char digits[24], *at = digits + sizeof digits - 1;
    unsigned long long rest = (unsigned long long)number;
    rest = number < 0 ? 0 - rest : rest;
    *at = '\0';
    do {
        *--at = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0);
    if (number < 0) {
        *--at = '-';
    }
    EnvPrintRouter(env, name, at);
}

/* The engine makes a symbol of each number that it prints. */
void PrintFloat(void *env, const char *name, double number)
{
    char bytes[CLIPS_NUMBER_BYTES];
    EnvPrintRouter(env, name, clips_number_print(number, bytes));
}

const char *FloatToString(void *env, double number)
{
    char bytes[CLIPS_NUMBER_BYTES];
    return ValueToString(EnvAddSymbol(env, clips_number_print(number, bytes)));
}
