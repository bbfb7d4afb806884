/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Expressions: what a rule's right-hand side and a function's body are made of.  Nothing is
 * profiled here: rules have no (profile).
 */
#include "mind/engine/clips_engine.h"

#include <prcdrfun.h>

enum {
    EVALUATE_UNITS = CLIPS_UNITS_A_TICK / 8, /* what a call of a function costs */
    EVALUATE_NEAR = 8
};

static inline void evaluate_bool(void *env, DATA_OBJECT *out, bool value)
{
    out->type = SYMBOL;
    out->value = value ? SymbolData(env)->TrueSymbolHN : SymbolData(env)->FalseSymbolHN;
}

static inline void evaluate_constant(DATA_OBJECT *out, unsigned short type, void *value)
{
    out->type = type;
    out->value = value;
}

/* A function's result where it is a number: as C has it. */
static void evaluate_number(void *env, const struct FunctionDefinition *f, DATA_OBJECT *out)
{
    union {
        int (*plain)(void);
        int (*of_int)(void *env);
        long (*of_long)(void *env);
        long long (*of_long_long)(void *env);
        float (*of_float)(void *env);
        double (*of_double)(void *env);
    } call = {.plain = f->functionPointer};
    switch (f->returnValueType) {
    case 'i': evaluate_constant(out, INTEGER, EnvAddLong(env, call.of_int(env))); break;
    case 'l': evaluate_constant(out, INTEGER, EnvAddLong(env, call.of_long(env))); break;
    case 'g': evaluate_constant(out, INTEGER, EnvAddLong(env, call.of_long_long(env))); break;
    case 'f': evaluate_constant(out, FLOAT, EnvAddDouble(env, (double)call.of_float(env))); break;
    default: evaluate_constant(out, FLOAT, EnvAddDouble(env, call.of_double(env))); break;
    }
}

/* The same where it is a pointer to what the engine has. */
static void evaluate_pointer(void *env, const struct FunctionDefinition *f, DATA_OBJECT *out)
{
    union {
        int (*plain)(void);
        void *(*of_pointer)(void *env);
    } call = {.plain = f->functionPointer};
    void *value = call.of_pointer(env);
    switch (f->returnValueType) {
    case 'a': evaluate_constant(out, EXTERNAL_ADDRESS, value); break;
    case 's': evaluate_constant(out, STRING, value); break;
    case 'w': evaluate_constant(out, SYMBOL, value); break;
    case 'o': evaluate_constant(out, INSTANCE_NAME, value); break;
    case 'x':
        evaluate_constant(out, INSTANCE_ADDRESS,
                          value ? value : (void *)&InstanceData(env)->DummyInstance);
        break;
    default:
        evaluate_constant(out, FACT_ADDRESS, value ? value : (void *)&FactData(env)->DummyFact);
        break;
    }
}

static void evaluate_letter(void *env, const struct FunctionDefinition *f, DATA_OBJECT *out)
{
    union {
        int (*plain)(void);
        char (*of_char)(void *env);
    } call = {.plain = f->functionPointer};
    char text[2] = {call.of_char(env), '\0'};
    evaluate_constant(out, SYMBOL, EnvAddSymbol(env, text));
}

/* A function that is told the environment takes it as its first argument; one that is not, ignores
 * it: both are called alike. */
static void evaluate_function(void *env, const struct FunctionDefinition *f, DATA_OBJECT *out)
{
    union {
        int (*plain)(void);
        int (*of_int)(void *env);
        void (*of_nothing)(void *env);
        void (*of_any)(void *env, DATA_OBJECT *out);
        void (*of_any_alone)(DATA_OBJECT *out);
    } call = {.plain = f->functionPointer};
    switch (f->returnValueType) {
    case 'j':
    case 'k':
    case 'm':
    case 'n':
    case 'u':
        if (f->environmentAware) {
            call.of_any(env, out);
        } else {
            call.of_any_alone(out);
        }
        break;
    case 'b': evaluate_bool(env, out, call.of_int(env)); break;
    case 'v':
        call.of_nothing(env);
        evaluate_constant(out, RVOID, SymbolData(env)->FalseSymbolHN);
        break;
    case 'i':
    case 'l':
    case 'g':
    case 'f':
    case 'd': evaluate_number(env, f, out); break;
    case 'c': evaluate_letter(env, f, out); break;
    case 'a':
    case 's':
    case 'w':
    case 'o':
    case 'x':
    case 'y': evaluate_pointer(env, f, out); break;
    default: clips_engine_assert(env, false, "EVALUATN", 2); break;
    }
}

/* A function that pays for its arguments. */
static void evaluate_metered(void *env, const struct FunctionDefinition *f, const struct expr *e,
                             DATA_OBJECT *out)
{
    struct mind *m = clips_engine_mind(env);
    struct clips_meter meter = {.row = f->context, .call = e};
    if (clips_meter_begin(m, &meter)) {
        evaluate_function(env, f, out);
    } else if (f->returnValueType == 'v') {
        evaluate_constant(out, RVOID, SymbolData(env)->FalseSymbolHN);
    } else {
        evaluate_bool(env, out, false);
    }
    m->meter = meter.outer;
}

static inline void evaluate_call(void *env, struct evaluationData *data, struct expr *e,
                                 DATA_OBJECT *out)
{
    struct environmentData *environment = env;
    const struct FunctionDefinition *f = e->value;
    struct expr *caller = data->CurrentExpression;
    void *context = environment->functionContext;
    environment->functionContext = NULL;
    data->CurrentExpression = e;
    if (f->context) {
        evaluate_metered(env, f, e, out);
    } else {
        evaluate_function(env, f, out);
    }
    environment->functionContext = context;
    data->CurrentExpression = caller;
}

static void evaluate_variable(void *env, struct expr *e, DATA_OBJECT *out)
{
    if (GetBoundVariable(env, out, e->value)) {
        return;
    }
    PrintErrorID(env, "EVALUATN", 1, FALSE);
    EnvPrintRouter(env, WERROR, "Variable ");
    EnvPrintRouter(env, WERROR, ValueToString(e->value));
    EnvPrintRouter(env, WERROR, " is unbound\n");
    evaluate_bool(env, out, false);
    SetEvaluationError(env, TRUE);
}

/* Globals, functions that are defined in rules, what a pattern has bound, ... */
static inline void evaluate_primitive(void *env, struct evaluationData *data, struct expr *e,
                                      DATA_OBJECT *out)
{
    const struct entityRecord *entity = data->PrimitivesArray[e->type];
    clips_engine_assert(env, entity != NULL, "EVALUATN", 3);
    if (entity->copyToEvaluate) {
        evaluate_constant(out, e->type, e->value);
        return;
    }
    clips_engine_assert(env, entity->evaluateFunction != NULL, "EVALUATN", 4);
    struct expr *caller = data->CurrentExpression;
    data->CurrentExpression = e;
    entity->evaluateFunction(env, e->value, out);
    data->CurrentExpression = caller;
}

int EvaluateExpression(void *env, struct expr *e, DATA_OBJECT *out)
{
    struct evaluationData *data = EvaluationData(env);
    struct mind *m = clips_engine_mind(env);
    unsigned units = 1;
    if (!e) {
        evaluate_bool(env, out, false);
        return data->EvaluationError;
    }
    switch (e->type) {
    case STRING:
    case SYMBOL:
    case FLOAT:
    case INTEGER:
    case INSTANCE_NAME:
    case INSTANCE_ADDRESS:
    case EXTERNAL_ADDRESS:
    case DATA_OBJECT_ARRAY: evaluate_constant(out, e->type, e->value); break;
    case FCALL:
        units = EVALUATE_UNITS;
        evaluate_call(env, data, e, out);
        break;
    case MULTIFIELD:
        evaluate_constant(out, MULTIFIELD, ((DATA_OBJECT *)e->value)->value);
        out->begin = ((DATA_OBJECT *)e->value)->begin;
        out->end = ((DATA_OBJECT *)e->value)->end;
        break;
    case MF_VARIABLE:
    case SF_VARIABLE: evaluate_variable(env, e, out); break;
    default: evaluate_primitive(env, data, e, out); break;
    }
    if (m) {
        m->units += units;
        if (__builtin_expect(m->units > CLIPS_UNITS_LEFT, 0) && m->sheltered) {
            clips_guard_leave(m, "ticks");
        }
        if (m->meter && m->meter->call == data->CurrentExpression) {
            clips_meter_take(m, m->meter, out);
        }
    }
    return data->EvaluationError;
}

/* An argument of a function, counted from 1.  One of a hundred thousand is far down the list. */
DATA_OBJECT *EnvRtnUnknown(void *env, int position, DATA_OBJECT *out)
{
    struct mind *m = clips_engine_mind(env);
    struct expr *call = EvaluationData(env)->CurrentExpression, *at = call->argList;
    bool paid = !m || clips_guard_charge(m, position > EVALUATE_NEAR ? (uint64_t)position : 0);
    for (int i = 1; paid && at && i < position; i++) {
        at = at->nextArg;
    }
    if (!paid || !at) {
        SetHaltExecution(env, TRUE);
        SetEvaluationError(env, TRUE);
        evaluate_bool(env, out, false);
        return NULL;
    }
    EvaluateExpression(env, at, out);
    return out;
}

int EnvRtnArgCount(void *env)
{
    int count = 0;
    for (const struct expr *a = EvaluationData(env)->CurrentExpression->argList; a;
         a = a->nextArg) {
        count++;
    }
    return count;
}
