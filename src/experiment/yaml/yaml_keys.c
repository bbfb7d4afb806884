/* SPDX-License-Identifier: Apache-2.0 */
#include "core/spell.h"
#include "core/text.h"
#include "experiment/yaml/yaml_tree.h"
#include "muster/memory.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { KEYS_TEXT_MAX = 4096 };

/* strtod alone would take hexadecimal, nan, inf and leading blanks. */
static bool keys_real(const char *text, double *value)
{
    char *end;
    if (text[strspn(text, "+-.0123456789eE")] != '\0') {
        return false;
    }
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

/* Decimal, without leading zeros: 010 is eight for some readers of YAML. */
static bool keys_whole(const char *text, unsigned long long most, unsigned long long *value)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits] || (digits > 1 && text[0] == '0')) {
        return false;
    }
    errno = 0;
    *value = strtoull(text, NULL, 10);
    return errno == 0 && *value <= most;
}

static bool keys_bool(const char *text, bool *value)
{
    static const char *const words[] = {"false", "true", "no", "yes", "off", "on", "0", "1"};
    size_t i = 0;
    while (i < sizeof words / sizeof words[0] && strcasecmp(words[i], text) != 0) {
        i++;
    }
    *value = i % 2 == 1;
    return i < sizeof words / sizeof words[0];
}

static bool keys_word(const char *const *words, const char *text, unsigned *value)
{
    unsigned i = 0;
    while (words[i] && strcmp(words[i], text) != 0) {
        i++;
    }
    *value = i;
    return words[i] != NULL;
}

const char *yaml_keys_put(const struct yaml_key *key, void *field, const char *text)
{
    static const char *const expected[] = {[YAML_KEY_TEXT] = "a text",
                                           [YAML_KEY_REAL] = "a number",
                                           [YAML_KEY_WHOLE] = "a whole number from 0",
                                           [YAML_KEY_COUNT] = "a whole number from 0",
                                           [YAML_KEY_BOOL] = "true or false"};
    unsigned long long whole = 0;
    bool good = false;
    if (key->kind == YAML_KEY_TEXT && strlen(text) > KEYS_TEXT_MAX) {
        return "a text of at most 4096 bytes";
    }
    switch (key->kind) {
    case YAML_KEY_TEXT:
        good = text[0] != '\0';
        *(char **)field = good ? mu_startup_string(text) : NULL;
        break;
    case YAML_KEY_REAL: good = keys_real(text, field); break;
    case YAML_KEY_WHOLE:
        good = keys_whole(text, UINT64_MAX, &whole);
        *(uint64_t *)field = whole;
        break;
    case YAML_KEY_COUNT:
        good = keys_whole(text, UINT_MAX, &whole);
        *(unsigned *)field = (unsigned)whole;
        break;
    case YAML_KEY_BOOL: good = keys_bool(text, field); break;
    case YAML_KEY_WORD: good = keys_word(key->words, text, field); break;
    case YAML_KEY_ANY:
    case YAML_KEY_KEYS: break;
    }
    return good ? NULL : key->what ? key->what : expected[key->kind];
}

static mu_result keys_expected(struct yaml_tree *tree, int node, struct mu_fault *fault,
                               const char *what)
{
    static const char *const kinds[] = {[YAML_TREE_NONE] = "nothing",
                                        [YAML_TREE_SCALAR] = "nothing",
                                        [YAML_TREE_LIST] = "a list",
                                        [YAML_TREE_MAPPING] = "a mapping"};
    const char *text = yaml_tree_scalar(tree, node);
    const char *got = kinds[yaml_tree_kind(tree, node)];
    return yaml_tree_fault(tree, node, fault, "expected %s, not '%.80s'", what,
                           text[0] ? text : got);
}

static void keys_list(struct mu_text *text, const struct yaml_key *keys)
{
    for (const struct yaml_key *k = keys; k->key; k++) {
        mu_text_format(text, "%s%s", k == keys ? "" : ", ", k->key);
    }
}

static mu_result keys_unknown(struct yaml_tree *tree, int node, const struct yaml_key *keys,
                              struct mu_fault *fault)
{
    char buffer[256];
    struct mu_text known = mu_text_in(buffer, sizeof buffer);
    struct mu_spell meant;
    mu_spell_init(&meant, yaml_tree_scalar(tree, node));
    for (const struct yaml_key *k = keys; k->key; k++) {
        mu_spell_offer(&meant, k->key);
    }
    keys_list(&known, keys);
    return yaml_tree_fault(tree, node, fault, "unknown key '%.80s'; expected one of: %s%s%s%s",
                           meant.word, buffer, meant.nearest ? "; did you mean '" : "",
                           meant.nearest ? meant.nearest : "", meant.nearest ? "'?" : "");
}

/* Refuses keys that are not in the table, and the second of two that are the same. */
static mu_result keys_check(struct yaml_tree *tree, int node, const struct yaml_key *keys,
                            struct mu_fault *fault)
{
    for (size_t i = 0; i < yaml_tree_count(tree, node); i++) {
        int key_node = yaml_tree_key(tree, node, i);
        const char *key = yaml_tree_scalar(tree, key_node);
        const struct yaml_key *k = keys;
        while (k->key && strcmp(k->key, key) != 0) {
            k++;
        }
        if (!k->key) {
            return keys_unknown(tree, key_node, keys, fault);
        }
        if (yaml_tree_child(tree, node, key) != yaml_tree_value(tree, node, i)) {
            return yaml_tree_fault(tree, key_node, fault, "key '%s' stands here a second time",
                                   key);
        }
    }
    return MU_OK;
}

static mu_result keys_value(struct yaml_tree *tree, int node, const struct yaml_key *key,
                            void *field, struct mu_fault *fault)
{
    if (key->kind == YAML_KEY_ANY) {
        return MU_OK;
    }
    if (key->alone && strcmp(yaml_tree_scalar(tree, node), key->alone) == 0) {
        *(bool *)field = true;
        return MU_OK;
    }
    if (key->kind == YAML_KEY_KEYS) {
        return yaml_keys_read(tree, node, key->keys, field, fault);
    }
    const char *expected = yaml_keys_put(key, field, yaml_tree_scalar(tree, node));
    return expected ? keys_expected(tree, node, fault, expected) : MU_OK;
}

static mu_result keys_items(struct yaml_tree *tree, int node, const struct yaml_key *key,
                            char *base, struct mu_fault *fault)
{
    size_t count = yaml_tree_count(tree, node);
    bool list = yaml_tree_kind(tree, node) == YAML_TREE_LIST;
    if (key->pair && (!list || count != 2)) {
        return keys_expected(tree, node, fault, key->what);
    }
    if (!list && !key->single) {
        return keys_expected(tree, node, fault, "a list");
    }
    count = list ? count : 1;
    if (count < key->min && key->min != key->max) {
        return yaml_tree_fault(tree, node, fault, "expected at least %u in this list", key->min);
    }
    if (count < key->min || count > key->max) {
        return yaml_tree_fault(tree, node, fault, "expected %s%u in this list, not %zu",
                               key->min == key->max ? "" : "at most ", key->max, count);
    }
    char *items = base + key->offset;
    if (!key->pair) {
        items = mu_startup_array(count, key->size);
        *(void **)(void *)(base + key->offset) = items;
    }
    if (key->count) {
        *(unsigned *)(void *)(base + key->count) = (unsigned)count;
    }
    for (size_t i = 0; i < count; i++) {
        int item = list ? yaml_tree_item(tree, node, i) : node;
        MU_TRY(keys_value(tree, item, key, items + i * key->size, fault));
    }
    return MU_OK;
}

/* A number that the file does not have. */
static void keys_absent(const struct yaml_key *key, void *field)
{
    if (key->kind == YAML_KEY_REAL) {
        *(double *)field = key->absent;
    } else if (key->kind == YAML_KEY_WHOLE) {
        *(uint64_t *)field = (uint64_t)key->absent;
    } else if (key->kind == YAML_KEY_COUNT) {
        *(unsigned *)field = (unsigned)key->absent;
    }
}

mu_result yaml_keys_read(struct yaml_tree *tree, int node, const struct yaml_key *keys, void *into,
                         struct mu_fault *fault)
{
    if (yaml_tree_kind(tree, node) != YAML_TREE_MAPPING) {
        char buffer[256];
        struct mu_text what = mu_text_in(buffer, sizeof buffer);
        mu_text_add(&what, "a mapping with the keys ");
        keys_list(&what, keys);
        return keys_expected(tree, node, fault, buffer);
    }
    MU_TRY(keys_check(tree, node, keys, fault));
    for (const struct yaml_key *k = keys; k->key; k++) {
        int child = yaml_tree_child(tree, node, k->key);
        void *field = (char *)into + k->offset;
        if (child) {
            MU_TRY(k->max ? keys_items(tree, child, k, into, fault)
                          : keys_value(tree, child, k, field, fault));
        } else if (k->needed) {
            return yaml_tree_fault(tree, node, fault, "expected a key '%s' here", k->key);
        } else if (!k->max) {
            keys_absent(k, field);
        }
    }
    return MU_OK;
}
