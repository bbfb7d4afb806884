/* SPDX-License-Identifier: Apache-2.0 */
#include "mind/engine/engine.h"

#include <math.h>

void value_refuse(void *env, const char *function, const char *wanted)
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

/* What a value is, in a word, and the value itself where it is short. */
static void value_describe(void *env, const DATA_OBJECT *value, struct mu_text *out)
{
    switch (value->type) {
    case SYMBOL: mu_text_format(out, "the symbol %.40s", ValueToString(value->value)); break;
    case STRING: mu_text_format(out, "the string \"%.40s\"", ValueToString(value->value)); break;
    case INTEGER: mu_text_format(out, "the whole number %lld", ValueToLong(value->value)); break;
    case FLOAT: mu_text_format(out, "the number %.15g", ValueToDouble(value->value)); break;
    case INSTANCE_NAME:
        mu_text_format(out, "the instance [%.40s]", ValueToString(value->value));
        break;
    case MULTIFIELD:
        mu_text_format(out, "a multifield of %ld fields", value->end - value->begin + 1);
        break;
    case FACT_ADDRESS: mu_text_add(out, "a fact"); break;
    default: mu_text_add(out, value->type == RVOID ? "nothing" : "something else"); break;
    }
    (void)env;
}

/* The same of one argument, counted from 1: "... expected WANTED as argument #1, and got GOT". */
static void value_refuse_argument(void *env, const char *function, int index, const char *wanted,
                                  const DATA_OBJECT *got)
{
    char bytes[256];
    struct mu_text text = mu_text_in(bytes, sizeof bytes);
    mu_text_format(&text, "%s as argument #%d, and got ", wanted, index);
    value_describe(env, got, &text);
    value_refuse(env, function, bytes);
}

void value_bool(void *env, DATA_OBJECT *out, bool value)
{
    out->type = SYMBOL;
    out->value = value ? EnvTrueSymbol(env) : EnvFalseSymbol(env);
}

void value_float(void *env, DATA_OBJECT *out, double value)
{
    out->type = FLOAT;
    out->value = EnvAddDouble(env, value);
}

void value_integer(void *env, DATA_OBJECT *out, long long value)
{
    out->type = INTEGER;
    out->value = EnvAddLong(env, value);
}

void value_symbol(void *env, DATA_OBJECT *out, const char *value)
{
    out->type = SYMBOL;
    out->value = EnvAddSymbol(env, value);
}

void value_multifield(DATA_OBJECT *out, struct multifield *fields)
{
    out->type = MULTIFIELD;
    out->value = fields;
    out->begin = 0;
    out->end = fields->multifieldLength - 1;
}

void value_set_float(void *env, struct multifield *fields, size_t index, double value)
{
    fields->theFields[index].type = FLOAT;
    fields->theFields[index].value = EnvAddDouble(env, value);
}

void value_set_symbol(void *env, struct multifield *fields, size_t index, const char *value)
{
    fields->theFields[index].type = SYMBOL;
    fields->theFields[index].value = EnvAddSymbol(env, value);
}

void value_set_word(void *env, struct multifield *fields, size_t index, const char *value)
{
    value_set_symbol(env, fields, index, value);
    fields->theFields[index].type = value[0] ? SYMBOL : STRING;
}

void value_floats(void *env, DATA_OBJECT *out, size_t count, const double *values)
{
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        value_set_float(env, fields, i, values[i]);
    }
    value_multifield(out, fields);
}

bool value_any(void *env, int index, DATA_OBJECT *out)
{
    EnvRtnUnknown(env, index, out);
    return !GetEvaluationError(env) && !GetHaltExecution(env);
}

double value_of(unsigned short type, const void *value)
{
    if (type == FLOAT) {
        return ((const struct floatHashNode *)value)->contents;
    }
    return type == INTEGER ? (double)((const struct integerHashNode *)value)->contents : 0;
}

bool value_number(void *env, const char *function, int index, double *out)
{
    DATA_OBJECT value;
    if (!value_any(env, index, &value)) {
        return false;
    }
    if (value.type != INTEGER && value.type != FLOAT) {
        value_refuse_argument(env, function, index, "a number", &value);
        return false;
    }
    *out = value_of(value.type, value.value);
    return true;
}

bool value_numbers(void *env, const char *function, int count, double *out)
{
    for (int i = 0; i < count; i++) {
        if (!value_number(env, function, i + 1, &out[i])) {
            return false;
        }
    }
    return true;
}

bool value_whole(void *env, const char *function, int index, long long *out)
{
    DATA_OBJECT value;
    if (!value_any(env, index, &value)) {
        return false;
    }
    if (value.type == FLOAT && ValueToDouble(value.value) == rint(ValueToDouble(value.value)) &&
        fabs(ValueToDouble(value.value)) < 9e15) { /* as CLIPS takes it */
        *out = (long long)ValueToDouble(value.value);
        return true;
    }
    if (value.type != INTEGER) {
        value_refuse_argument(env, function, index, "a whole number", &value);
        return false;
    }
    *out = ((struct integerHashNode *)value.value)->contents;
    return true;
}

void value_add_match(struct mu_text *out, const struct alphaMatch *match)
{
    const struct patternEntity *item = match ? match->matchingItem : NULL;
    if (!item) {
        mu_text_add(out, "*");
    } else if (item->theInfo->base.type == FACT_ADDRESS) {
        mu_text_add_number(out, ((const struct fact *)item)->factIndex);
    } else {
        const char *name = ValueToString(((const INSTANCE_TYPE *)item)->name);
        mu_text_format(out, "[%s]", strpbrk(name, " ,\n\r") ? "?" : name);
    }
}

bool value_word(void *env, const char *function, int index, const char **out)
{
    DATA_OBJECT value;
    if (!value_any(env, index, &value)) {
        return false;
    }
    if (value.type != SYMBOL && value.type != STRING) {
        value_refuse_argument(env, function, index, "a word or a string", &value);
        return false;
    }
    *out = ValueToString(value.value);
    return true;
}

double value_norm_deg(double angle_deg)
{
    double a = remainder(angle_deg, 360);
    return a <= -180 ? a + 360 : a;
}
