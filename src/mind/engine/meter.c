/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The cost of CLIPS's functions that read every byte or field of their arguments.  CLIPS has no
 * tick inside of a function, so each argument is charged when it has its value: the same on every
 * machine.  An argument that exceeds the budget becomes empty, and the rule ends after the call.
 */
#include "mind/engine/engine.h"

#include <string.h>

/* How a function uses its arguments. */
enum meter_kind {
    METER_BYTES,   /* reads texts */
    METER_SCAN,    /* reads texts, letter by letter */
    METER_FIELDS,  /* goes through multifields */
    METER_TEXT,    /* prints values, and the fields of multifields */
    METER_PRODUCT, /* for each field of the first, goes through the others */
    METER_SORT,    /* sorts all */
    METER_FACT,    /* searches the facts for the index that its first argument may be */
    METER_FACTS,   /* the same for each argument */
    METER_AGENDA,  /* sorts the agenda */
    METER_ALL      /* looks at all symbols, or all matches of a rule */
};

/* Units, of which BUDGET_UNITS_A_TICK are a tick. */
enum {
    METER_BYTES_A_UNIT = 64, /* copied or compared */
    METER_A_SCAN = 8,
    METER_A_FIELD = 4,
    METER_A_NUMBER = 64, /* printed */
    METER_A_FACT = 2,
    METER_AN_ALL = 64 * 2000,
    METER_AN_ACTIVATION = 2
};

struct meter_row {
    const char *name;
    enum meter_kind kind;
};

static const struct meter_row meter_rows[] = {
    {"str-cat", METER_BYTES},
    {"sym-cat", METER_BYTES},
    {"str-length", METER_BYTES},
    {"str-compare", METER_BYTES},
    {"str-index", METER_BYTES},
    {"sub-string", METER_BYTES},
    {"upcase", METER_BYTES},
    {"lowcase", METER_BYTES},
    {"length", METER_BYTES},
    {"length$", METER_BYTES},
    {"format", METER_BYTES},
    {"instance-name", METER_BYTES},
    {"symbol-to-instance-name", METER_BYTES},
    {"instance-name-to-symbol", METER_BYTES},
    {"string-to-field", METER_SCAN},
    {"explode$", METER_SCAN},
    {"str-explode", METER_SCAN},
    {"eval", METER_SCAN},
    {"build", METER_SCAN},
    {"check-syntax", METER_SCAN},
    {"assert-string", METER_SCAN},
    {"str-assert", METER_SCAN},
    {"bind", METER_FIELDS},
    {"return", METER_FIELDS},
    {"eq", METER_FIELDS},
    {"neq", METER_FIELDS},
    {"create$", METER_FIELDS},
    {"mv-append", METER_FIELDS},
    {"insert$", METER_FIELDS},
    {"replace$", METER_FIELDS},
    {"mv-replace", METER_FIELDS},
    {"delete$", METER_FIELDS},
    {"mv-delete", METER_FIELDS},
    {"delete-member$", METER_FIELDS},
    {"replace-member$", METER_FIELDS},
    {"(expansion-call)", METER_FIELDS},
    {"funcall", METER_FIELDS},
    {"progn$", METER_FIELDS},
    {"foreach", METER_FIELDS},
    {"slot-insert$", METER_FIELDS},
    {"slot-replace$", METER_FIELDS},
    {"slot-delete$", METER_FIELDS},
    {"slot-direct-insert$", METER_FIELDS},
    {"slot-direct-replace$", METER_FIELDS},
    {"slot-direct-delete$", METER_FIELDS},
    {"implode$", METER_TEXT},
    {"str-implode", METER_TEXT},
    {"printout", METER_TEXT},
    {"member", METER_PRODUCT},
    {"member$", METER_PRODUCT},
    {"subset", METER_PRODUCT},
    {"subsetp", METER_PRODUCT},
    {"sort", METER_SORT},
    {"retract", METER_FACTS},
    {"modify", METER_FACT},
    {"duplicate", METER_FACT},
    {"fact-existp", METER_FACT},
    {"fact-relation", METER_FACT},
    {"fact-slot-value", METER_FACT},
    {"fact-slot-names", METER_FACT},
    {"ppfact", METER_FACT},
    {"timetag", METER_FACT},
    {"dependents", METER_FACT},
    {"dependencies", METER_FACT},
    {"set-strategy", METER_AGENDA},
    {"refresh-agenda", METER_AGENDA},
    {"set-salience-evaluation", METER_AGENDA},
    {"apropos", METER_ALL},
    {"matches", METER_ALL},
    {"join-activity", METER_ALL},
    {"join-activity-reset", METER_ALL},
    {"refresh", METER_ALL},
};

void meter_install(struct mind *m)
{
    for (size_t i = 0; i < sizeof meter_rows / sizeof meter_rows[0]; i++) {
        struct FunctionDefinition *f = FindFunction(m->env, meter_rows[i].name);
        MU_ASSERT(f);
        f->context = (void *)(uintptr_t)&meter_rows[i];
    }
}

static bool meter_is_text(unsigned short type)
{
    return type == STRING || type == SYMBOL || type == INSTANCE_NAME;
}

static uint64_t meter_fields(const DATA_OBJECT *value)
{
    return value->type == MULTIFIELD ? (uint64_t)(value->end - value->begin + 1) : 1;
}

/* A text costs its bytes; a number costs its printing. */
static uint64_t meter_word(unsigned short type, const void *value)
{
    return meter_is_text(type) ? strlen(ValueToString(value)) / METER_BYTES_A_UNIT : METER_A_NUMBER;
}

/* One text may stand in many fields, so that the sum exceeds all memory: it ends at the budget. */
static uint64_t meter_text(const DATA_OBJECT *value)
{
    uint64_t units = 0;
    const struct multifield *fields = value->value;
    for (long i = value->begin; i <= value->end && units < BUDGET_UNITS_MAX; i++) {
        const struct field *f = &fields->theFields[i];
        units += METER_A_FIELD + meter_word(f->type, f->value);
    }
    return units;
}

static uint64_t meter_sort(uint64_t before, uint64_t fields)
{
    uint64_t rounds = 1;
    while ((before + fields) >> rounds) {
        rounds++;
    }
    return 4 * METER_A_FIELD * rounds * fields;
}

static bool meter_is_index(const struct meter *meter, const DATA_OBJECT *value)
{
    bool first = meter->fields == 0;
    return value->type == INTEGER && (meter->row->kind == METER_FACTS || first);
}

static uint64_t meter_units(const struct mind *m, const struct meter *meter,
                            const DATA_OBJECT *value)
{
    bool text = meter_is_text(value->type);
    uint64_t fields = meter_fields(value), facts = FactData(m->env)->NumberOfFacts;
    switch (meter->row->kind) {
    case METER_BYTES: return value->type == MULTIFIELD ? 0 : meter_word(value->type, value->value);
    case METER_SCAN: return text ? METER_A_SCAN * strlen(ValueToString(value->value)) : 0;
    case METER_FIELDS: return METER_A_FIELD * fields;
    case METER_TEXT:
        if (value->type == MULTIFIELD) {
            return meter_text(value);
        }
        return meter_word(value->type, value->value);
    case METER_PRODUCT: return METER_A_FIELD * fields * (meter->fields > 0 ? meter->fields : 1);
    case METER_SORT: return meter_sort(meter->fields, fields);
    case METER_FACT:
    case METER_FACTS: return meter_is_index(meter, value) ? METER_A_FACT * facts : 0;
    case METER_AGENDA:
    case METER_ALL: return 0;
    }
    return 0;
}

/* Charges for an argument that has its value now, or empties it. */
static void meter_take(struct mind *m, struct meter *meter, DATA_OBJECT *value)
{
    if (budget_charge(m, meter_units(m, meter, value))) {
        meter->fields += meter_fields(value);
    } else if (value->type == MULTIFIELD) {
        value->end = value->begin - 1;
    } else if (meter_is_text(value->type)) {
        value->value = EnvAddSymbol(m->env, "");
    } else if (meter_is_index(meter, value)) {
        value->value = EnvAddLong(m->env, -1);
    }
}

int meter_begin(void *env, struct meter *meter, const struct meter_row *row)
{
    struct mind *m = environment_mind(env);
    uint64_t count = AgendaData(env)->NumberOfActivations;
    *meter = (struct meter){
        .row = row, .call = EvaluationData(env)->CurrentExpression, .outer = m->cost.meter};
    m->cost.meter = meter;
    uint64_t units = row->kind == METER_AGENDA ? METER_AN_ACTIVATION * count * count
                     : row->kind == METER_ALL  ? METER_AN_ALL
                                               : 0;
    return units == 0 || budget_charge(m, units);
}

void meter_end(void *env, struct meter *meter)
{
    environment_mind(env)->cost.meter = meter->outer;
}

void meter_evaluated(void *env, DATA_OBJECT *value)
{
    struct mind *m = environment_mind(env);
    struct meter *meter = m->cost.meter;
    if (m->cost.units > BUDGET_UNITS_LEFT && state_is_limited(m)) {
        budget_leave(m, "ticks");
    }
    if (meter && meter->call == EvaluationData(env)->CurrentExpression) {
        meter_take(m, meter, value);
    }
}
