/* SPDX-License-Identifier: Apache-2.0 */
/* Groups, the yellow pages, the white pages, and lines that are set aside, as rules see them. */
#include "core/attributes.h"
#include "core/name.h"
#include "mind/functions/table.h"

#include <string.h>

/* --- changes ---------------------------------------------------------------------------------- */

static bool group_name(void *env, const char *function, const char *wanted, const char **name)
{
    if (!value_word(env, function, 1, name)) {
        return false;
    }
    if (!mu_name_valid(*name)) {
        value_refuse(env, function, wanted);
        return false;
    }
    return true;
}

static void group_begin(void *env, enum mind_change change, const char *name,
                        const char *attributes, uint64_t lease_ns, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    value_bool(env, out,
               ports->change &&
                   ports->change(ports->self, change, name, attributes, lease_ns) == MU_OK);
}

/* (FUNCTION NAME) */
static void group_change(void *env, const char *function, enum mind_change change,
                         const char *wanted, DATA_OBJECT *out)
{
    const char *name;
    value_bool(env, out, false);
    if (group_name(env, function, wanted, &name)) {
        group_begin(env, change, name, "", 0, out);
    }
}

void directory_create(void *env, DATA_OBJECT *out)
{
    group_change(env, "group-create", MIND_GROUP_CREATE, "a name for a group", out);
}

void directory_join(void *env, DATA_OBJECT *out)
{
    group_change(env, "group-join", MIND_GROUP_JOIN, "the name of a group", out);
}

void directory_leave(void *env, DATA_OBJECT *out)
{
    group_change(env, "group-leave", MIND_GROUP_LEAVE, "the name of a group", out);
}

void directory_withdraw(void *env, DATA_OBJECT *out)
{
    group_change(env, "withdraw", MIND_WITHDRAW, "the name of a service", out);
}

/* Adds a word or number as it is: attributes and queries have no quotes. */
static bool word_add(struct mu_text *to, unsigned short type, const void *value)
{
    switch (type) {
    case SYMBOL:
    case STRING: mu_text_add(to, ((const struct symbolHashNode *)value)->contents); return true;
    case INTEGER:
        mu_text_format(to, "%lld", ((const struct integerHashNode *)value)->contents);
        return true;
    case FLOAT: mu_text_format(to, "%.15g", value_of(type, value)); return true;
    default: return false;
    }
}

/* Words for how long something lasts, elsewhere: an attribute of that name would be a mistake. */
static bool key_is_mistaken(const char *key)
{
    static const char *const words[] = {"ttl", "reply-by", "lease-time", "expires"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(words[i], key) == 0) {
            return true;
        }
    }
    return false;
}

/* Adds a key or a value.  @return false: it can be none */
static bool attribute_add(struct mu_text *to, const DATA_OBJECT *word, bool is_key)
{
    mu_text_add(to, is_key && to->len > 0 ? " " : "");
    size_t start = to->len;
    bool good = word_add(to, word->type, word->value) && !strpbrk(to->at + start, " ") &&
                (!is_key || mu_name_valid(to->at + start));
    mu_text_add(to, is_key ? "=" : "");
    return good;
}

/* Reads a key and its value: an attribute, or the lease. */
static bool attribute_read(void *env, int index, struct mu_text *to, uint64_t *lease_ns)
{
    DATA_OBJECT key, value;
    if (!value_any(env, index, &key)) {
        return false;
    }
    const char *word = key.type == SYMBOL || key.type == STRING ? ValueToString(key.value) : "";
    if (strcmp(word, "lease") == 0) {
        return send_seconds(env, "advertise", index + 1, "lease", lease_ns);
    }
    if (key_is_mistaken(word)) {
        value_refuse(env, "advertise", "lease in place of ttl, reply-by, lease-time or expires");
        return false;
    }
    return attribute_add(to, &key, true) && value_any(env, index + 1, &value) &&
           attribute_add(to, &value, false);
}

/*
 * Writes the arguments from the second on as key=value.
 * @return false: they are no such pairs, or one ended in an error
 */
static bool attributes_read(void *env, struct mu_text *to, uint64_t *lease_ns)
{
    int count = EnvRtnArgCount(env);
    bool good = count % 2 == 1;
    for (int i = 2; good && i < count; i += 2) {
        good = attribute_read(env, i, to, lease_ns);
    }
    return good && !to->cut && mu_attributes_valid(to->at);
}

void directory_advertise(void *env, DATA_OBJECT *out)
{
    char bytes[MU_ATTRIBUTES_MAX + 1];
    const char *service;
    uint64_t lease_ns = 0;
    value_bool(env, out, false);
    if (!group_name(env, "advertise", "a name for a service", &service)) {
        return;
    }
    struct mu_text attributes = mu_text_in(bytes, sizeof bytes);
    if (attributes_read(env, &attributes, &lease_ns)) {
        group_begin(env, MIND_ADVERTISE, service, bytes, lease_ns, out);
    } else if (!GetEvaluationError(env)) {
        value_refuse(env, "advertise",
                     "pairs of key and value: each key a name, and once; values without "
                     "blanks; 255 bytes in all");
    }
}

/* --- questions -------------------------------------------------------------------------------- */

static void list_answer(void *env, enum mind_list list, const char *of, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    size_t count = 0;
    while (ports->entry && ports->entry(ports->self, list, of, count)) {
        count++;
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        const char *name = ports->entry(ports->self, list, of, i);
        value_set_symbol(env, fields, i, name ? name : "nil");
    }
    value_multifield(out, fields);
}

void directory_groups(void *env, DATA_OBJECT *out)
{
    list_answer(env, MIND_GROUPS, "", out);
}

void directory_members(void *env, DATA_OBJECT *out)
{
    const char *group;
    EnvSetMultifieldErrorValue(env, out);
    if (group_name(env, "members", "the name of a group", &group)) {
        list_answer(env, MIND_MEMBERS, group, out);
    }
}

/*
 * Adds a word of a query behind a blank, unless a relation joins it to the word before.  CLIPS
 * reads battery<=0.5 as two words, and a variable may hold the number.
 */
static bool query_add(struct mu_text *to, unsigned short type, const void *value)
{
    bool word = type == SYMBOL || type == STRING;
    const char *text = word ? ((const struct symbolHashNode *)value)->contents : "";
    bool joins = to->len == 0 || text[0] == '<' || strchr("=<>", to->at[to->len - 1]);
    mu_text_add(to, joins ? "" : " ");
    return word_add(to, type, value);
}

static bool query_read(void *env, struct mu_text *to)
{
    int count = EnvRtnArgCount(env);
    for (int i = 1; i <= count; i++) {
        DATA_OBJECT value;
        bool good = true;
        if (!value_any(env, i, &value)) {
            return false;
        }
        if (value.type != MULTIFIELD) {
            good = query_add(to, value.type, value.value);
        }
        for (long k = value.begin; value.type == MULTIFIELD && good && k <= value.end; k++) {
            const struct field *f = &((struct multifield *)value.value)->theFields[k];
            good = query_add(to, f->type, f->value);
        }
        if (!good) {
            return false;
        }
    }
    return !to->cut;
}

/* Names an agent with several services once. */
static void names_once(DATA_OBJECT *names)
{
    struct field *fields = ((struct multifield *)names->value)->theFields;
    long kept = 0;
    for (long i = 0; i <= names->end; i++) {
        long same = 0;
        while (same < kept && fields[same].value != fields[i].value) {
            same++;
        }
        if (same == kept) {
            fields[kept++] = fields[i];
        }
    }
    names->end = kept - 1;
}

void directory_find_service(void *env, DATA_OBJECT *out)
{
    char query[MU_QUERY_MAX + 1];
    struct mu_query read;
    EnvSetMultifieldErrorValue(env, out);
    struct mu_text text = mu_text_in(query, sizeof query);
    if (!query_read(env, &text) || mu_attributes_query(&read, query) != MU_OK) {
        if (!GetEvaluationError(env)) {
            value_refuse(env, "find-service",
                         "a service, or *, and constraints such as role=scout battery>=0.5 "
                         "near=X,Y,METRES");
        }
        return;
    }
    list_answer(env, MIND_PROVIDERS, query, out);
    if (query[0] == '*') {
        names_once(out);
    }
}

void directory_my_name(void *env, DATA_OBJECT *out)
{
    value_symbol(env, out, environment_mind(env)->options.name);
}

void directory_lookup(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    struct mind_member member;
    const char *name;
    value_bool(env, out, false);
    if (!value_word(env, "lookup", 1, &name) || !ports->lookup ||
        ports->lookup(ports->self, name, &member) != MU_OK) {
        return;
    }
    struct multifield *fields = EnvCreateMultifield(env, 4);
    value_set_symbol(env, fields, 0, member.name);
    value_set_symbol(env, fields, 1, member.kind);
    value_set_symbol(env, fields, 2, member.state);
    value_set_word(env, fields, 3, member.host);
    value_multifield(out, fields);
}

void directory_listing(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    struct mind_member member;
    size_t count = 0;
    while (ports->listing && ports->listing(ports->self, count, &member) == MU_OK) {
        count++;
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        bool there = ports->listing(ports->self, i, &member) == MU_OK;
        value_set_symbol(env, fields, i, there ? member.name : "nil");
    }
    value_multifield(out, fields);
}

void directory_aside(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    size_t count = 0;
    while (ports->aside && ports->aside(ports->self, count)) {
        count++;
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)count);
    for (size_t i = 0; i < count; i++) {
        fields->theFields[i].type = STRING;
        fields->theFields[i].value = EnvAddSymbol(env, ports->aside(ports->self, i));
    }
    value_multifield(out, fields);
}

void directory_drop_aside(void *env, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &environment_mind(env)->options.ports;
    long long number;
    value_bool(env, out, false);
    if (value_whole(env, "drop-aside", 1, &number) && number > 0 && ports->drop_aside) {
        value_bool(env, out, ports->drop_aside(ports->self, (size_t)number - 1));
    }
}
