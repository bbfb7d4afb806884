/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/yaml/yaml_tree.h"

#include "muster/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <yaml.h>

struct yaml_tree {
    yaml_document_t document;
    const char *path;
    const char *text;
    size_t len;
};

/* libyaml names the byte, not the line, of what is no UTF-8. */
static mu_result yaml_tree_encoding_fault(const struct yaml_tree *tree, const char *problem,
                                          size_t offset, struct mu_fault *fault)
{
    int line = 1, column = 1;
    for (size_t i = 0; i < offset && i < tree->len; i++) {
        column = tree->text[i] == '\n' ? 1 : column + 1;
        line += tree->text[i] == '\n';
    }
    return mu_fault_at(fault, tree->path, line, column, "expected UTF-8 text: %s", problem);
}

static mu_result yaml_tree_syntax_fault(const struct yaml_tree *tree, const yaml_parser_t *parser,
                                        struct mu_fault *fault)
{
    const char *problem = parser->problem ? parser->problem : "out of memory";
    if (parser->error == YAML_READER_ERROR) {
        return yaml_tree_encoding_fault(tree, problem, parser->problem_offset, fault);
    }
    return mu_fault_at(fault, tree->path, (int)parser->problem_mark.line + 1,
                       (int)parser->problem_mark.column + 1, "not YAML: %s%s%s", problem,
                       parser->context ? ", " : "", parser->context ? parser->context : "");
}

/* The second document of a stream would be passed over in silence. */
static mu_result yaml_tree_check_single(const struct yaml_tree *tree, yaml_parser_t *parser,
                                        struct mu_fault *fault)
{
    yaml_document_t next;
    if (!yaml_parser_load(parser, &next)) {
        return yaml_tree_syntax_fault(tree, parser, fault);
    }
    const yaml_node_t *root = yaml_document_get_root_node(&next);
    mu_result result = MU_OK;
    if (root) {
        result = mu_fault_at(fault, tree->path, (int)root->start_mark.line + 1, 1,
                             "expected the end of the file, not a second YAML document");
    }
    yaml_document_delete(&next);
    return result;
}

mu_result yaml_tree_open(struct yaml_tree **out, const char *path, const char *text, size_t len,
                         struct mu_fault *fault)
{
    yaml_parser_t parser;
    struct yaml_tree *tree = mu_startup_alloc(sizeof *tree);
    *tree = (struct yaml_tree){.path = path, .text = text, .len = len};
    if (!yaml_parser_initialize(&parser)) {
        return mu_fault_at(fault, path, 0, 0, "out of memory");
    }
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, len);
    mu_result result = MU_OK;
    if (!yaml_parser_load(&parser, &tree->document)) {
        result = yaml_tree_syntax_fault(tree, &parser, fault);
    } else {
        result = yaml_tree_check_single(tree, &parser, fault);
        if (result != MU_OK) {
            yaml_document_delete(&tree->document);
        }
    }
    yaml_parser_delete(&parser);
    *out = tree;
    return result;
}

void yaml_tree_close(struct yaml_tree *tree)
{
    yaml_document_delete(&tree->document);
}

static yaml_node_t *yaml_tree_get(struct yaml_tree *tree, int node)
{
    return node ? yaml_document_get_node(&tree->document, node) : NULL;
}

int yaml_tree_root(struct yaml_tree *tree)
{
    return yaml_document_get_root_node(&tree->document) ? 1 : 0;
}

enum yaml_tree_kind yaml_tree_kind(struct yaml_tree *tree, int node)
{
    static const enum yaml_tree_kind kinds[] = {[YAML_NO_NODE] = YAML_TREE_NONE,
                                                [YAML_SCALAR_NODE] = YAML_TREE_SCALAR,
                                                [YAML_SEQUENCE_NODE] = YAML_TREE_LIST,
                                                [YAML_MAPPING_NODE] = YAML_TREE_MAPPING};
    const yaml_node_t *n = yaml_tree_get(tree, node);
    return n ? kinds[n->type] : YAML_TREE_NONE;
}

const char *yaml_tree_scalar(struct yaml_tree *tree, int node)
{
    const yaml_node_t *n = yaml_tree_get(tree, node);
    return n && n->type == YAML_SCALAR_NODE ? (const char *)n->data.scalar.value : "";
}

size_t yaml_tree_count(struct yaml_tree *tree, int node)
{
    const yaml_node_t *n = yaml_tree_get(tree, node);
    if (n && n->type == YAML_SEQUENCE_NODE) {
        return (size_t)(n->data.sequence.items.top - n->data.sequence.items.start);
    }
    if (n && n->type == YAML_MAPPING_NODE) {
        return (size_t)(n->data.mapping.pairs.top - n->data.mapping.pairs.start);
    }
    return 0;
}

int yaml_tree_item(struct yaml_tree *tree, int node, size_t index)
{
    const yaml_node_t *n = yaml_tree_get(tree, node);
    bool there = n && n->type == YAML_SEQUENCE_NODE && index < yaml_tree_count(tree, node);
    return there ? n->data.sequence.items.start[index] : 0;
}

static const yaml_node_pair_t *yaml_tree_pair(struct yaml_tree *tree, int node, size_t index)
{
    const yaml_node_t *n = yaml_tree_get(tree, node);
    bool there = n && n->type == YAML_MAPPING_NODE && index < yaml_tree_count(tree, node);
    return there ? &n->data.mapping.pairs.start[index] : NULL;
}

int yaml_tree_key(struct yaml_tree *tree, int node, size_t index)
{
    const yaml_node_pair_t *pair = yaml_tree_pair(tree, node, index);
    return pair ? pair->key : 0;
}

int yaml_tree_value(struct yaml_tree *tree, int node, size_t index)
{
    const yaml_node_pair_t *pair = yaml_tree_pair(tree, node, index);
    return pair ? pair->value : 0;
}

int yaml_tree_child(struct yaml_tree *tree, int node, const char *key)
{
    if (yaml_tree_kind(tree, node) != YAML_TREE_MAPPING) {
        return 0;
    }
    for (size_t i = 0; i < yaml_tree_count(tree, node); i++) {
        if (strcmp(yaml_tree_scalar(tree, yaml_tree_key(tree, node, i)), key) == 0) {
            return yaml_tree_value(tree, node, i);
        }
    }
    return 0;
}

mu_result yaml_tree_fault(struct yaml_tree *tree, int node, struct mu_fault *fault,
                          const char *format, ...)
{
    const yaml_node_t *n = yaml_tree_get(tree, node);
    char text[MU_FAULT_TEXT_MAX + 1];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return mu_fault_at(fault, tree->path, n ? (int)n->start_mark.line + 1 : 0,
                       n ? (int)n->start_mark.column + 1 : 0, "%s", text);
}
