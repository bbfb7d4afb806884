/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/yaml/yaml_tree.h"

#include "core/text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

bool yaml_check_real(const char *text, double *value)
{
    char *end;
    if (text[strspn(text, "+-.0123456789eE")] != '\0') {
        return false; /* strtod would take hexadecimal, nan, inf and leading blanks */
    }
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

bool yaml_check_uint(const char *text, unsigned long long *value)
{
    size_t digits = strspn(text, "0123456789");
    if (digits == 0 || text[digits] || (digits > 1 && text[0] == '0')) {
        return false;
    }
    errno = 0;
    *value = strtoull(text, NULL, 10);
    return errno == 0;
}

static const char *yaml_check_got(struct yaml_tree *tree, int node)
{
    switch (yaml_tree_kind(tree, node)) {
    case YAML_TREE_NONE: return "nothing";
    case YAML_TREE_LIST: return "a list";
    case YAML_TREE_MAPPING: return "a mapping";
    case YAML_TREE_SCALAR: break;
    }
    const char *text = yaml_tree_scalar(tree, node);
    return text[0] ? text : "nothing";
}

static mu_result yaml_check_expected(struct yaml_tree *tree, int node, struct mu_fault *fault,
                                     const char *what)
{
    return yaml_tree_fault(tree, node, fault, "expected %s, not '%.80s'", what,
                           yaml_check_got(tree, node));
}

static void yaml_check_list_keys(struct mu_text *text, const cyaml_schema_field_t *fields)
{
    for (const cyaml_schema_field_t *f = fields; f->key; f++) {
        mu_text_format(text, "%s%s", f == fields ? "" : ", ", f->key);
    }
}

static const cyaml_schema_field_t *yaml_check_field(const cyaml_schema_field_t *fields,
                                                    const char *key)
{
    const cyaml_schema_field_t *f = fields;
    while (f->key && strcmp(f->key, key) != 0) {
        f++;
    }
    return f->key ? f : NULL;
}

static mu_result yaml_check_keys(struct yaml_tree *tree, int node,
                                 const cyaml_schema_field_t *fields, struct mu_fault *fault)
{
    for (size_t i = 0; i < yaml_tree_count(tree, node); i++) {
        int key_node = yaml_tree_key(tree, node, i);
        const char *key = yaml_tree_scalar(tree, key_node);
        if (!yaml_check_field(fields, key)) {
            char buffer[256];
            struct mu_text keys;
            mu_text_init(&keys, buffer, sizeof buffer);
            yaml_check_list_keys(&keys, fields);
            return yaml_tree_fault(tree, key_node, fault,
                                   "unknown key '%.80s'; expected one of: %s", key, buffer);
        }
        if (yaml_tree_child(tree, node, key) != yaml_tree_value(tree, node, i)) {
            return yaml_tree_fault(tree, key_node, fault, "key '%s' stands here a second time",
                                   key);
        }
    }
    return MU_OK;
}

static mu_result yaml_check_mapping(struct yaml_tree *tree, int node,
                                    const cyaml_schema_value_t *schema, struct mu_fault *fault)
{
    const cyaml_schema_field_t *fields = schema->mapping.fields;
    if (yaml_tree_kind(tree, node) != YAML_TREE_MAPPING) {
        char buffer[256];
        struct mu_text text;
        mu_text_init(&text, buffer, sizeof buffer);
        mu_text_add(&text, "a mapping with the keys ");
        yaml_check_list_keys(&text, fields);
        return yaml_check_expected(tree, node, fault, buffer);
    }
    mu_result result = yaml_check_keys(tree, node, fields, fault);
    for (const cyaml_schema_field_t *f = fields; f->key && result == MU_OK; f++) {
        int child = yaml_tree_child(tree, node, f->key);
        if (child) {
            result = yaml_check(tree, child, &f->value, fault);
        } else if (!(f->value.flags & CYAML_FLAG_OPTIONAL)) {
            result = yaml_tree_fault(tree, node, fault, "expected a key '%s' here", f->key);
        }
    }
    return result;
}

static mu_result yaml_check_list(struct yaml_tree *tree, int node,
                                 const cyaml_schema_value_t *schema, struct mu_fault *fault)
{
    size_t count = yaml_tree_count(tree, node);
    size_t min = schema->sequence.min, max = schema->sequence.max;
    if (yaml_tree_kind(tree, node) != YAML_TREE_LIST) {
        return yaml_check_expected(tree, node, fault, "a list");
    }
    if (count < min && min != max) {
        return yaml_tree_fault(tree, node, fault, "expected at least %zu in this list", min);
    }
    if (count < min || count > max) {
        return yaml_tree_fault(tree, node, fault, "expected %s%zu in this list, not %zu",
                               min == max ? "" : "at most ", max, count);
    }
    mu_result result = MU_OK;
    for (size_t i = 0; i < count && result == MU_OK; i++) {
        result = yaml_check(tree, yaml_tree_item(tree, node, i), schema->sequence.entry, fault);
    }
    return result;
}

static mu_result yaml_check_enum(struct yaml_tree *tree, int node,
                                 const cyaml_schema_value_t *schema, struct mu_fault *fault)
{
    char buffer[128];
    struct mu_text words;
    mu_text_init(&words, buffer, sizeof buffer);
    for (uint32_t i = 0; i < schema->enumeration.count; i++) {
        const char *word = schema->enumeration.strings[i].str;
        if (strcmp(word, yaml_tree_scalar(tree, node)) == 0) {
            return MU_OK;
        }
        mu_text_format(&words, "%s%s", i ? " or " : "", word);
    }
    return yaml_check_expected(tree, node, fault, buffer);
}

static mu_result yaml_check_string(struct yaml_tree *tree, int node,
                                   const cyaml_schema_value_t *schema, struct mu_fault *fault)
{
    size_t len = strlen(yaml_tree_scalar(tree, node));
    if (yaml_tree_kind(tree, node) != YAML_TREE_SCALAR || len < schema->string.min) {
        return yaml_check_expected(tree, node, fault, "a text");
    }
    if (len > schema->string.max) {
        return yaml_tree_fault(tree, node, fault, "expected a text of at most %u bytes, not %zu",
                               (unsigned)schema->string.max, len);
    }
    return MU_OK;
}

static mu_result yaml_check_number(struct yaml_tree *tree, int node,
                                   const cyaml_schema_value_t *schema, struct mu_fault *fault)
{
    double real;
    unsigned long long whole;
    if (schema->type == CYAML_UINT) {
        return yaml_check_uint(yaml_tree_scalar(tree, node), &whole)
                   ? MU_OK
                   : yaml_check_expected(tree, node, fault, "a whole number from 0");
    }
    return yaml_check_real(yaml_tree_scalar(tree, node), &real)
               ? MU_OK
               : yaml_check_expected(tree, node, fault, "a number");
}

mu_result yaml_check(struct yaml_tree *tree, int node, const cyaml_schema_value_t *schema,
                     struct mu_fault *fault)
{
    typedef mu_result (*check_fn)(struct yaml_tree *, int, const cyaml_schema_value_t *,
                                  struct mu_fault *);
    /* The types that our schemas use; libcyaml judges the others alone. */
    static const check_fn checks[CYAML__TYPE_COUNT] = {
        [CYAML_MAPPING] = yaml_check_mapping,     [CYAML_SEQUENCE] = yaml_check_list,
        [CYAML_SEQUENCE_FIXED] = yaml_check_list, [CYAML_ENUM] = yaml_check_enum,
        [CYAML_STRING] = yaml_check_string,       [CYAML_FLOAT] = yaml_check_number,
        [CYAML_UINT] = yaml_check_number,
    };
    check_fn check = checks[schema->type];
    return check ? check(tree, node, schema, fault) : MU_OK;
}
