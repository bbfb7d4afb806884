/* SPDX-License-Identifier: Apache-2.0 */
/* What functions, methods and message-handlers of rules are called with. */
#include "agent/clips_engine.h"

#include <prccode.h>

static void call_complain(void *env, bool nothing, const char *name, const char *kind)
{
    if (nothing) {
        PrintErrorID(env, "PRCCODE", 2, FALSE);
        EnvPrintRouter(env, WERROR, "Functions without a return value are illegal as ");
        EnvPrintRouter(env, WERROR, kind);
        EnvPrintRouter(env, WERROR, " arguments.\n");
        SetEvaluationError(env, TRUE);
    }
    PrintErrorID(env, "PRCCODE", 6, FALSE);
    EnvPrintRouter(env, WERROR, "This error occurred while evaluating arguments for the ");
    EnvPrintRouter(env, WERROR, kind);
    EnvPrintRouter(env, WERROR, " ");
    EnvPrintRouter(env, WERROR, name);
    EnvPrintRouter(env, WERROR, ".\n");
}

/* The values of the arguments, or NULL: there are none, or one has failed. */
static DATA_OBJECT *call_evaluate(void *env, struct expr *arguments, int count, const char *name,
                                  const char *kind)
{
    DATA_OBJECT *values = gm2(env, (size_t)count * sizeof *values), value;
    for (int i = 0; arguments; i++, arguments = arguments->nextArg) {
        if (EvaluateExpression(env, arguments, &value) == TRUE || value.type == RVOID) {
            call_complain(env, value.type == RVOID, name, kind);
            rm(env, values, (size_t)count * sizeof *values);
            return NULL;
        }
        values[i].type = value.type;
        values[i].value = value.value;
        values[i].begin = value.begin;
        values[i].end = value.end;
    }
    return values;
}

void PushProcParameters(void *env, struct expr *arguments, int count, const char *name,
                        const char *kind, void (*unbound)(void *env))
{
    struct proceduralPrimitiveData *data = ProceduralPrimitiveData(env);
    PROC_PARAM_STACK *caller = clips_engine_take(env, sizeof *caller);
    caller->ParamArray = data->ProcParamArray;
    caller->ParamArraySize = data->ProcParamArraySize;
    caller->UnboundErrFunc = data->ProcUnboundErrFunc;
    caller->nxt = data->pstack;
    data->pstack = caller;
    DATA_OBJECT *values = count > 0 ? call_evaluate(env, arguments, count, name, kind) : NULL;
    if (values || count == 0) {
        data->ProcParamArray = values;
        data->ProcParamArraySize = count;
    }
    if (EvaluationData(env)->EvaluationError) {
        data->pstack = caller->nxt;
        clips_engine_give(env, caller, sizeof *caller);
        return;
    }
    /* arguments may have made these, so they are looked at behind them */
    caller->ParamExpressions = data->ProcParamExpressions;
    caller->WildcardValue = data->WildcardValue;
    data->ProcParamExpressions = NULL;
    data->WildcardValue = NULL;
    data->ProcUnboundErrFunc = unbound;
}

/* The multifield of $? goes, unless somebody uses it. */
static void call_end_wildcard(void *env, struct proceduralPrimitiveData *data)
{
    DATA_OBJECT *wildcard = data->WildcardValue;
    MultifieldDeinstall(env, wildcard->value);
    if (wildcard->value != data->NoParamValue) {
        AddToMultifieldList(env, wildcard->value);
    }
    clips_engine_give(env, wildcard, sizeof *wildcard);
}

void PopProcParameters(void *env)
{
    struct proceduralPrimitiveData *data = ProceduralPrimitiveData(env);
    PROC_PARAM_STACK *caller = data->pstack;
    size_t count = (size_t)data->ProcParamArraySize;
    if (data->ProcParamArray) {
        rm(env, data->ProcParamArray, count * sizeof *data->ProcParamArray);
    }
    if (data->ProcParamExpressions) {
        rm(env, data->ProcParamExpressions, count * sizeof *data->ProcParamExpressions);
    }
    if (data->WildcardValue) {
        call_end_wildcard(env, data);
    }
    data->pstack = caller->nxt;
    data->ProcParamArray = caller->ParamArray;
    data->ProcParamArraySize = caller->ParamArraySize;
    data->ProcParamExpressions = caller->ParamExpressions;
    data->WildcardValue = caller->WildcardValue;
    data->ProcUnboundErrFunc = caller->UnboundErrFunc;
    clips_engine_give(env, caller, sizeof *caller);
}
