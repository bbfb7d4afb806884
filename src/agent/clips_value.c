/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/clips_value.h"

void clips_value_refuse(void *env, const char *function, const char *wanted)
{
    PrintErrorID(env, "MUSTER", 1, FALSE);
    EnvPrintRouter(env, WERROR, "Function ");
    EnvPrintRouter(env, WERROR, function);
    EnvPrintRouter(env, WERROR, " expected ");
    EnvPrintRouter(env, WERROR, wanted);
    EnvPrintRouter(env, WERROR, "\n");
    SetHaltExecution(env, TRUE);
    SetEvaluationError(env, TRUE);
}

void clips_value_bool(void *env, DATA_OBJECT *out, bool value)
{
    out->type = SYMBOL;
    out->value = value ? EnvTrueSymbol(env) : EnvFalseSymbol(env);
}

void clips_value_float(void *env, DATA_OBJECT *out, double value)
{
    out->type = FLOAT;
    out->value = EnvAddDouble(env, value);
}

void clips_value_integer(void *env, DATA_OBJECT *out, long long value)
{
    out->type = INTEGER;
    out->value = EnvAddLong(env, value);
}

void clips_value_symbol(void *env, DATA_OBJECT *out, const char *value)
{
    out->type = SYMBOL;
    out->value = EnvAddSymbol(env, value);
}

void clips_value_multifield(DATA_OBJECT *out, struct multifield *fields)
{
    out->type = MULTIFIELD;
    out->value = fields;
    out->begin = 0;
    out->end = fields->multifieldLength - 1;
}

void clips_value_set_float(void *env, struct multifield *fields, size_t index, double value)
{
    fields->theFields[index].type = FLOAT;
    fields->theFields[index].value = EnvAddDouble(env, value);
}

void clips_value_set_symbol(void *env, struct multifield *fields, size_t index, const char *value)
{
    fields->theFields[index].type = SYMBOL;
    fields->theFields[index].value = EnvAddSymbol(env, value);
}

void clips_value_floats(void *env, DATA_OBJECT *out, size_t count, const double *values)
{
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        clips_value_set_float(env, fields, i, values[i]);
    }
    clips_value_multifield(out, fields);
}

bool clips_value_any(void *env, int index, DATA_OBJECT *out)
{
    EnvRtnUnknown(env, index, out);
    return !GetEvaluationError(env) && !GetHaltExecution(env);
}

double clips_value_of(unsigned short type, const void *value)
{
    if (type == FLOAT) {
        return ((const struct floatHashNode *)value)->contents;
    }
    return type == INTEGER ? (double)((const struct integerHashNode *)value)->contents : 0;
}

bool clips_value_number(void *env, const char *function, int index, double *out)
{
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(env, function, index, INTEGER_OR_FLOAT, &value)) {
        return false;
    }
    *out = clips_value_of(value.type, value.value);
    return true;
}

bool clips_value_numbers(void *env, const char *function, int count, double *out)
{
    for (int i = 0; i < count; i++) {
        if (!clips_value_number(env, function, i + 1, &out[i])) {
            return false;
        }
    }
    return true;
}

bool clips_value_whole(void *env, const char *function, int index, long long *out)
{
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(env, function, index, INTEGER, &value)) {
        return false;
    }
    *out = ((struct integerHashNode *)value.value)->contents;
    return true;
}

bool clips_value_word(void *env, const char *function, int index, const char **out)
{
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(env, function, index, SYMBOL_OR_STRING, &value)) {
        return false;
    }
    *out = ValueToString(value.value);
    return true;
}
