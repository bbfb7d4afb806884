/* SPDX-License-Identifier: Apache-2.0 */
#include "world/parse/parser.h"

#include "core/paths.h"
#include "core/text.h"
#include "muster/memory.h"
#include "world/parse/lexer.h"

#include <errno.h>
#include <limits.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct parser {
    struct world_file *file;
    struct lexer lexer;
    struct token token; /* the one that is looked at */
    const char *path;
    int include_depth;
    struct mu_fault *fault;
};

static mu_result worldfile_read(struct parser *outer, const char *path, const struct token *at);

void worldfile_init(struct world_file *file)
{
    *file = (struct world_file){.bytes = mu_startup_alloc(WORLDFILE_BYTES_MAX)};
}

void *worldfile_take(struct world_file *file, size_t bytes)
{
    size_t start = (file->bytes_used + alignof(max_align_t) - 1) & ~(alignof(max_align_t) - 1);
    if (start > WORLDFILE_BYTES_MAX || bytes > WORLDFILE_BYTES_MAX - start) {
        return NULL;
    }
    file->bytes_used = start + bytes;
    return memset(file->bytes + start, 0, bytes);
}

static const char *worldfile_keep(struct world_file *file, const char *text, size_t len)
{
    char *copy = worldfile_take(file, len + 1);
    if (copy) {
        memcpy(copy, text, len);
    }
    return copy;
}

static void parser_next(struct parser *p)
{
    lexer_next(&p->lexer, &p->token);
}

static mu_result parser_full(struct parser *p)
{
    return mu_fault_at(p->fault, p->path, p->token.line, p->token.column,
                       "the world is too large: more than %d bytes", WORLDFILE_BYTES_MAX);
}

/* Puts a token into words: for "expected ..., found ...". */
static const char *parser_token_text(const struct token *token, char *buffer, size_t size)
{
    struct mu_text text = mu_text_in(buffer, size);
    if (token->kind == TOKEN_END) {
        mu_text_add(&text, "the end of the file");
    } else {
        int len = token->len > 40 ? 40 : (int)token->len;
        mu_text_format(&text, token->kind == TOKEN_STRING ? "\"%.*s\"" : "'%.*s'", len,
                       token->text);
    }
    for (size_t i = 0; i < text.len; i++) { /* a stray escape must not reach a terminal */
        unsigned char c = (unsigned char)buffer[i];
        buffer[i] = c < ' ' || c > '~' ? '?' : buffer[i];
    }
    return buffer;
}

static mu_result parser_expected(struct parser *p, const char *what)
{
    char found[64];
    if (p->token.kind == TOKEN_BAD) {
        return mu_fault_at(p->fault, p->path, p->token.line, p->token.column, "%.*s",
                           (int)p->token.len, p->token.text);
    }
    return mu_fault_at(p->fault, p->path, p->token.line, p->token.column, "expected %s, found %s",
                       what, parser_token_text(&p->token, found, sizeof found));
}

static bool parser_at_word(const struct parser *p, const char *word)
{
    return p->token.kind == TOKEN_WORD && p->token.len == strlen(word) &&
           memcmp(p->token.text, word, p->token.len) == 0;
}

static struct mu_fault_place parser_place(const struct parser *p, const struct token *token)
{
    return (struct mu_fault_place){.file = p->path, .line = token->line, .column = token->column};
}

static mu_result parser_take_value(struct parser *p, struct worldfile_value *value)
{
    if (p->token.kind == TOKEN_NUMBER) {
        *value = (struct worldfile_value){.number = p->token.number};
    } else {
        const char *text = worldfile_keep(p->file, p->token.text, p->token.len);
        if (!text) {
            return parser_full(p);
        }
        *value = (struct worldfile_value){.text = text};
    }
    parser_next(p);
    return MU_OK;
}

static bool parser_at_value(const struct parser *p)
{
    return p->token.kind == TOKEN_NUMBER || p->token.kind == TOKEN_STRING ||
           p->token.kind == TOKEN_WORD;
}

static mu_result parser_take_tuple(struct parser *p, struct worldfile_property *property)
{
    struct worldfile_value values[WORLDFILE_TUPLE_MAX];
    size_t count = 0;
    parser_next(p);
    while (p->token.kind != TOKEN_CLOSE_TUPLE) {
        if (!parser_at_value(p)) {
            return parser_expected(p, "a number, a text or ']'");
        }
        if (count == WORLDFILE_TUPLE_MAX) {
            return parser_expected(p, "']' after 256 values at most");
        }
        MU_TRY(parser_take_value(p, &values[count++]));
    }
    parser_next(p);
    struct worldfile_value *kept = worldfile_take(p->file, count * sizeof *kept);
    if (!kept) {
        return parser_full(p);
    }
    memcpy(kept, values, count * sizeof *kept);
    property->values = kept;
    property->value_count = count;
    return MU_OK;
}

/* Takes the index off a key: "point[12]" is "point" and 12; one of five digits stays in the key. */
static mu_result parser_split_key(struct parser *p, const struct token *key,
                                  struct worldfile_property *property)
{
    size_t len = key->len;
    property->index = -1;
    if (key->text[len - 1] == ']') {
        size_t open = len - 1;
        while (key->text[open] != '[') {
            open--;
        }
        if (len - 2 - open <= 4) {
            property->index = 0;
            for (size_t i = open + 1; i < len - 1; i++) {
                property->index = property->index * 10 + (key->text[i] - '0');
            }
            len = open;
        }
    }
    property->key = worldfile_keep(p->file, key->text, len);
    return property->key ? MU_OK : parser_full(p);
}

static mu_result parser_take_property(struct parser *p, struct worldfile_entity *into,
                                      const struct token *key)
{
    if (into->property_count++ == WORLDFILE_PROPERTIES_MAX) {
        return mu_fault_at(p->fault, p->path, key->line, key->column,
                           "more than %d properties in one model", WORLDFILE_PROPERTIES_MAX);
    }
    struct worldfile_property *property = worldfile_take(p->file, sizeof *property);
    if (!property) {
        return parser_full(p);
    }
    property->at = parser_place(p, key);
    MU_TRY(parser_split_key(p, key, property));
    if (p->token.kind == TOKEN_OPEN_TUPLE) {
        MU_TRY(parser_take_tuple(p, property));
    } else if (parser_at_value(p)) {
        struct worldfile_value *value = worldfile_take(p->file, sizeof *value);
        if (!value) {
            return parser_full(p);
        }
        bool word = p->token.kind == TOKEN_WORD;
        MU_TRY(parser_take_value(p, value));
        if (word && p->token.kind == TOKEN_OPEN) { /* the word was the next model's type */
            return mu_fault_at(p->fault, p->path, key->line, key->column,
                               "expected a value for '%s'", property->key);
        }
        property->values = value;
        property->value_count = 1;
    } else {
        return parser_expected(p, "a value or '('");
    }
    if (into->last_property) {
        into->last_property->next = property;
    } else {
        into->properties = property;
    }
    into->last_property = property;
    return MU_OK;
}

/*
 * A listener hears of a mistake in a statement that began on some line.  Then reading goes on where
 * a new statement may begin: at the line where the mistake was seen, or the next one if the
 * statement began there.  At the end of the file nothing is left to say.
 */
static mu_result parser_go_on(struct parser *p, int began, mu_result result)
{
    struct world_file *file = p->file;
    if (result != MU_FAULT_FILE || !file->listener ||
        file->mistake_count == MU_FAULT_MISTAKES_MAX) {
        return result;
    }
    if (p->token.kind != TOKEN_END || file->mistake_count == 0) {
        file->mistake_count++;
        file->listener->tell(file->listener->self, p->fault, true);
    }
    int line = p->token.line;
    if (line > began && p->token.kind != TOKEN_END) {
        p->lexer.at = p->lexer.line_start;
        parser_next(p);
        return MU_OK;
    }
    while (p->token.kind != TOKEN_END && p->token.line == line) {
        parser_next(p);
    }
    return MU_OK;
}

static mu_result parser_take_statement(struct parser *p, struct worldfile_entity *into, int depth);

/* Reads the statements of a model up to and with its ')'. */
static mu_result parser_take_body(struct parser *p, struct worldfile_entity *into, int depth)
{
    parser_next(p);
    if (depth > WORLDFILE_NESTING_MAX) {
        return mu_fault_at(p->fault, p->path, into->at.line, into->at.column,
                           "models nest deeper than %d", WORLDFILE_NESTING_MAX);
    }
    while (p->token.kind != TOKEN_CLOSE) {
        if (p->token.kind == TOKEN_END) {
            return mu_fault_at(p->fault, p->path, p->token.line, p->token.column,
                               "expected ')' to end '%.40s' of line %d, found the end of the file",
                               into->type, into->at.line);
        }
        int line = p->token.line;
        MU_TRY(parser_go_on(p, line, parser_take_statement(p, into, depth)));
    }
    parser_next(p);
    return MU_OK;
}

static struct worldfile_entity *parser_new_entity(struct parser *p, const struct token *type)
{
    struct worldfile_entity *entity = worldfile_take(p->file, sizeof *entity);
    const char *name = worldfile_keep(p->file, type->text, type->len);
    if (!entity || !name) {
        return NULL;
    }
    entity->type = name;
    entity->at = parser_place(p, type);
    entity->base = worldfile_definition(p->file, name);
    entity->derivation = entity->base ? entity->base->derivation + 1 : 0;
    return entity;
}

static mu_result parser_take_statement(struct parser *p, struct worldfile_entity *into, int depth)
{
    if (p->token.kind != TOKEN_WORD) {
        return parser_expected(p, depth ? "a property, a model or ')'" : "a property or a model");
    }
    if (depth > 0 && (parser_at_word(p, "define") || parser_at_word(p, "include"))) {
        return parser_expected(p, "a property, a model or ')'");
    }
    struct token name = p->token;
    parser_next(p);
    if (p->token.kind != TOKEN_OPEN) {
        return parser_take_property(p, into, &name);
    }
    struct worldfile_entity *child = parser_new_entity(p, &name);
    if (!child) {
        return parser_full(p);
    }
    if (into->last_child) {
        into->last_child->next = child;
    } else {
        into->children = child;
    }
    into->last_child = child;
    return parser_take_body(p, child, depth + 1);
}

static mu_result parser_take_define(struct parser *p)
{
    parser_next(p);
    if (p->token.kind != TOKEN_WORD) {
        return parser_expected(p, "the name that is defined");
    }
    struct token name = p->token;
    parser_next(p);
    if (p->token.kind != TOKEN_WORD) {
        return parser_expected(p, "the model that the new one derives from");
    }
    struct worldfile_entity *entity = parser_new_entity(p, &p->token);
    if (!entity) {
        return parser_full(p);
    }
    entity->defines = worldfile_keep(p->file, name.text, name.len);
    if (!entity->defines) {
        return parser_full(p);
    }
    if (entity->derivation > WORLDFILE_DERIVATION_MAX) {
        return mu_fault_at(p->fault, p->path, name.line, name.column,
                           "definitions derive from one another more than %d deep",
                           WORLDFILE_DERIVATION_MAX);
    }
    if (p->file->definition_count++ == WORLDFILE_DEFINITIONS_MAX) {
        return mu_fault_at(p->fault, p->path, name.line, name.column, "more than %d definitions",
                           WORLDFILE_DEFINITIONS_MAX);
    }
    entity->at = parser_place(p, &name);
    parser_next(p);
    if (p->token.kind != TOKEN_OPEN) {
        return parser_expected(p, "'('");
    }
    MU_TRY(parser_take_body(p, entity, 1));
    entity->next = p->file->definitions;
    p->file->definitions = entity;
    return MU_OK;
}

static mu_result parser_take_include(struct parser *p)
{
    parser_next(p);
    if (p->token.kind != TOKEN_STRING) {
        return parser_expected(p, "the file to include, in quotes");
    }
    struct token name = p->token;
    char path[MU_FAULT_FILE_MAX + 1];
    char text[MU_FAULT_FILE_MAX + 1];
    struct mu_text t = mu_text_in(text, sizeof text);
    mu_text_add_bytes(&t, name.text, name.len);
    if (t.cut || !worldfile_path(p->path, text, path, sizeof path)) {
        return parser_expected(p, "a shorter path");
    }
    MU_TRY(worldfile_read(p, path, &name));
    parser_next(p);
    return MU_OK;
}

static mu_result parser_run(struct parser *p, const char *text, size_t len)
{
    lexer_init(&p->lexer, text, len);
    parser_next(p);
    while (p->token.kind != TOKEN_END) {
        int line = p->token.line;
        if (parser_at_word(p, "include")) {
            MU_TRY(parser_go_on(p, line, parser_take_include(p)));
        } else if (parser_at_word(p, "define")) {
            MU_TRY(parser_go_on(p, line, parser_take_define(p)));
        } else {
            MU_TRY(parser_go_on(p, line, parser_take_statement(p, &p->file->root, 0)));
        }
    }
    return MU_OK;
}

/* Reads a whole file into the world's memory.  @return NULL, with errno, when it cannot */
static const char *worldfile_text(struct world_file *file, const char *path, size_t *len)
{
    struct stat status;
    if (stat(path, &status) != 0) {
        return NULL;
    }
    if (!S_ISREG(status.st_mode)) { /* a pipe or a device might never end */
        errno = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
        return NULL;
    }
    if (status.st_size > WORLDFILE_TEXT_MAX) {
        errno = EFBIG;
        return NULL;
    }
    char *text = worldfile_take(file, (size_t)status.st_size + 1);
    if (!text) {
        errno = EFBIG;
        return NULL;
    }
    FILE *in = fopen(path, "rb");
    if (!in) {
        return NULL;
    }
    *len = fread(text, 1, (size_t)status.st_size, in);
    bool failed = ferror(in) != 0;
    fclose(in);
    errno = failed ? EIO : 0;
    return failed ? NULL : text;
}

/* Reports a file that cannot be read; of a missing one, it names the folder of muster's own files.
 * */
static mu_result worldfile_missing(const struct parser *outer, const char *path,
                                   const struct token *at)
{
    char rules[PATH_MAX], own[PATH_MAX], worlds[PATH_MAX];
    const char *why = strerror(errno);
    bool missing = at && errno == ENOENT && mu_path_rules(rules, sizeof rules) &&
                   mu_path_join(own, sizeof own, rules, "../worlds") && realpath(own, worlds);
    return mu_fault_at(outer->fault, at ? outer->path : path, at ? at->line : 0,
                       at ? at->column : 0, "cannot read the file '%s': %s%s%s", path, why,
                       missing ? "; muster's own are in " : "", missing ? worlds : "");
}

void worldfile_note(struct world_file *file, const char *path)
{
    for (size_t i = 0; i < file->files_count; i++) {
        if (strcmp(file->files[i], path) == 0) {
            return;
        }
    }
    const char *kept = worldfile_keep(file, path, strlen(path));
    if (kept && file->files_count < WORLDFILE_FILES_MAX) {
        file->files[file->files_count++] = kept;
    }
}

/* Reads and parses a file.  outer is the including file, at a token, or only lends its fault. */
static mu_result worldfile_read(struct parser *outer, const char *path, const struct token *at)
{
    int line = at ? at->line : 0;
    int column = at ? at->column : 0;
    struct parser p = {.file = outer->file,
                       .path = worldfile_keep(outer->file, path, strlen(path)),
                       .include_depth = outer->include_depth + (at != NULL),
                       .fault = outer->fault};
    if (p.include_depth > WORLDFILE_INCLUDE_DEPTH_MAX) {
        return mu_fault_at(p.fault, outer->path, line, column,
                           "files include one another more than %d deep",
                           WORLDFILE_INCLUDE_DEPTH_MAX);
    }
    if (outer->file->include_count++ > WORLDFILE_INCLUDES_MAX) {
        return mu_fault_at(p.fault, outer->path, line, column, "more than %d files are included",
                           WORLDFILE_INCLUDES_MAX);
    }
    size_t len = 0;
    const char *text = p.path ? worldfile_text(p.file, path, &len) : NULL;
    if (!text) {
        return worldfile_missing(outer, path, at);
    }
    worldfile_note(p.file, path);
    return parser_run(&p, text, len);
}

static void worldfile_forget(struct world_file *file)
{
    *file = (struct world_file){.bytes = file->bytes, .listener = file->listener};
    file->root.type = "world";
}

mu_result worldfile_parse(struct world_file *file, const char *path, struct mu_fault *fault)
{
    worldfile_forget(file);
    struct parser outer = {.file = file, .path = path, .fault = fault};
    return worldfile_read(&outer, path, NULL);
}

mu_result worldfile_parse_text(struct world_file *file, const char *path, const char *text,
                               size_t len, struct mu_fault *fault)
{
    worldfile_forget(file);
    struct parser p = {.file = file, .path = path, .fault = fault};
    return parser_run(&p, text, len);
}

const struct worldfile_property *worldfile_property(const struct worldfile_entity *entity,
                                                    const char *key)
{
    for (const struct worldfile_entity *e = entity; e; e = e->base) {
        const struct worldfile_property *found = NULL;
        for (const struct worldfile_property *p = e->properties; p; p = p->next) {
            if (p->index < 0 && strcmp(p->key, key) == 0) {
                found = p; /* a later one replaces an earlier one */
            }
        }
        if (found) {
            return found;
        }
    }
    return NULL;
}

const char *worldfile_kind(const struct worldfile_entity *entity)
{
    while (entity->base) {
        entity = entity->base;
    }
    return entity->type;
}

const struct worldfile_entity *worldfile_definition(const struct world_file *file, const char *name)
{
    for (const struct worldfile_entity *e = file->definitions; e; e = e->next) {
        if (strcmp(e->defines, name) == 0) {
            return e;
        }
    }
    return NULL;
}

bool worldfile_path(const char *beside, const char *name, char *path, size_t size)
{
    const char *slash = strrchr(beside, '/');
    struct mu_text text = mu_text_in(path, size);
    if (slash && name[0] != '/') {
        mu_text_add_bytes(&text, beside, (size_t)(slash - beside) + 1);
    }
    mu_text_add(&text, name);
    return !text.cut;
}
