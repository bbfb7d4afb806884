/* SPDX-License-Identifier: Apache-2.0 */
/* Rule files: one form after the other, (extends "FILE"), and mistakes with file and line. */
#include "mind/load/load.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

enum { LOAD_TEXT_MAX = 2 * LOAD_FILE_MAX, LOAD_PATH_MAX = MU_FAULT_FILE_MAX + 1 };

/* CLIPS calls this with the line, within the form, of a mistake. */
static void load_note_error(void *env, const char *file, const char *warning, const char *error,
                            long line)
{
    (void)file;
    (void)warning;
    struct mind *m = environment_mind(env);
    if (error && loader_of(m)->error_line == 0) {
        loader_of(m)->error_line = line;
    }
}

void load_install(struct mind *m)
{
    EnvSetParserErrorCallback(m->env, load_note_error);
    source_lines_install(m);
}

void load_reserve(struct mind *m)
{
    loader_of(m)->text = mu_startup_alloc(LOAD_TEXT_MAX);
    source_lines_reserve(m);
    loader_of(m)->form = mu_startup_alloc(LOAD_FILE_MAX);
}

/* Reads a file into the free part of the stack of texts. */
static mu_result load_read(const struct mind *m, const char *path, struct mu_text *text,
                           struct mu_fault *fault)
{
    size_t used = loader_of(m)->text_used;
    mu_text_init(text, loader_of(m)->text + used, LOAD_TEXT_MAX - used);
    if (!m->options.read) {
        (void)mu_fault_at(fault, path, 0, 0, "cannot be opened: this mind has no files");
        return MU_ABSENT;
    }
    return m->options.read(path, text, fault);
}

/* Reads a file onto the stack of texts. */
static mu_result load_push(struct mind *m, const char *path, const char **at,
                           struct mu_fault *fault)
{
    struct mu_text text;
    if (load_read(m, path, &text, fault) != MU_OK) {
        return MU_FAULT_FILE;
    }
    if (text.cut || text.len > LOAD_FILE_MAX) {
        return mu_fault_at(fault, path, 0, 0, "is larger than a rule file may be (1 MiB)");
    }
    if (strlen(text.at) != text.len) {
        return mu_fault_at(fault, path, 0, 0, "is no text: it holds a zero byte");
    }
    loader_of(m)->text_used += text.len + 1;
    *at = text.at;
    return MU_OK;
}

/* Writes the message of CLIPS as one line, without the source that it repeats. */
static void load_said(struct mind *m, char *to, size_t size)
{
    syntax_as_written(m->said.at);
    char *repeat = strstr(m->said.at, "\nERROR:");
    if (repeat) {
        *repeat = '\0';
    }
    struct mu_text line = mu_text_in(to, size);
    for (const char *s = m->said.at; *s; s++) {
        bool blank = *s == '\n' || *s == ' ';
        bool again = line.len == 0 || line.at[line.len - 1] == ' ';
        if (!blank) {
            mu_text_add_bytes(&line, s, 1);
        } else if (!again) {
            mu_text_add(&line, " ");
        }
    }
}

mu_result load_construct(struct mind *m, const char *path, struct syntax_form f,
                         struct mu_fault *fault)
{
    struct mu_text form = mu_text_in(loader_of(m)->form, LOAD_FILE_MAX);
    syntax_rewrite(&form, f.at, f.len);
    if (form.cut) {
        return mu_fault_at(fault, path, f.line, 0, "this form is too long");
    }
    loader_of(m)->error_line = 0;
    environment_begin(m);
    budget_start(m, 0);
    OpenTextSource(m->env, "mu-load", form.at, 0, form.len);
    EnvSetParsingFileName(m->env, path);
    int loaded = LoadConstructsFromLogicalName(m->env, "mu-load");
    EnvSetParsingFileName(m->env, NULL);
    CloseStringSource(m->env, "mu-load");
    if (environment_end(m) || loaded != 1) {
        char said[MU_FAULT_TEXT_MAX + 1];
        load_said(m, said, sizeof said);
        int line = f.line + (loader_of(m)->error_line > 1 ? (int)loader_of(m)->error_line - 1 : 0);
        return mu_fault_at(fault, path, line, 0, "%s",
                           said[0] ? said : "CLIPS does not accept this form");
    }
    source_lines_note(m, f.at, path, f.line);
    return MU_OK;
}

/* @return whether the form begins with this word; *behind is the place behind the word */
static bool load_begins(struct syntax_form f, const char *begin, const char **behind)
{
    *behind = f.at + 1;
    struct syntax_field word = syntax_read_field(behind);
    return word.kind == SYNTAX_FIELD_SYMBOL && word.len == strlen(begin) &&
           strncmp(word.at, begin, word.len) == 0;
}

/*
 * @return whether the form is (extends ...).  well_formed: it is (extends "FILE"), and the name is
 * copied
 */
static bool load_is_extends(struct syntax_form f, char *name, size_t size, bool *well_formed)
{
    const char *at;
    if (!load_begins(f, "extends", &at)) {
        return false;
    }
    struct syntax_field file = syntax_read_field(&at);
    struct syntax_field close = syntax_read_field(&at);
    *well_formed = file.kind == SYNTAX_FIELD_STRING && file.len < size &&
                   close.kind == SYNTAX_FIELD_BAD && *at == ')';
    if (*well_formed) {
        syntax_unescape(name, file.at, file.len);
    }
    return true;
}

static bool load_exists(const struct mind *m, const char *path)
{
    struct mu_text text;
    struct mu_fault fault;
    return load_read(m, path, &text, &fault) != MU_ABSENT;
}

/* Joins a name to the folder of a file.  @return whether there is such a file */
static bool load_beside(const struct mind *m, const char *file, const char *name, char *path,
                        size_t size)
{
    const char *slash = strrchr(file, '/');
    int folder = slash ? (int)(slash - file) + 1 : 0;
    int len = snprintf(path, size, "%.*s%s", folder, file, name);
    return len > 0 && (size_t)len < size && load_exists(m, path);
}

/* @return whether a file beside the robot's rule file replaces one of the library */
static bool load_replaces(const struct mind *m, const char *from, const char *name, char *path,
                          size_t size)
{
    const char *own = m->options.rules_file;
    const char *library = m->options.rules_folder;
    size_t len = library ? strlen(library) : 0;
    bool of_library = len > 0 && strncmp(from, library, len) == 0 && from[len] == '/' &&
                      !strchr(from + len + 1, '/');
    return own && of_library && load_beside(m, own, name, path, size) && strcmp(path, own) != 0;
}

/* Finds an extended file: beside the one that names it, else in the library. */
static bool load_find(const struct mind *m, const char *from, const char *name, char *path,
                      size_t size)
{
    if (load_replaces(m, from, name, path, size) || load_beside(m, from, name, path, size)) {
        return true;
    }
    if (!m->options.rules_folder) {
        return false;
    }
    int len = snprintf(path, size, "%s/%s", m->options.rules_folder, name);
    return len > 0 && (size_t)len < size && load_exists(m, path);
}

/* @return whether two paths name the same file; links are not followed */
static bool load_is_same(const char *a, const char *b)
{
    while (*a && *a == *b) {
        a++;
        b++;
        while (strncmp(a, "./", 2) == 0 && a[-1] == '/') {
            a += 2;
        }
        while (strncmp(b, "./", 2) == 0 && b[-1] == '/') {
            b += 2;
        }
    }
    return *a == *b;
}

/* @return whether a file is being loaded already */
static bool load_is_open(const struct mind *m, const char *path)
{
    const struct mind_loader *l = loader_of(m);
    size_t i = 0;
    while (i < l->files_deep && !load_is_same(path, l->files[i])) {
        i++;
    }
    return i < l->files_deep;
}

static mu_result load_extends(struct mind *m, const char *from, int line, const char *name,
                              struct mu_fault *fault)
{
    char path[LOAD_PATH_MAX];
    if (name[0] == '/' || strstr(name, "..")) {
        return mu_fault_at(fault, from, line, 0,
                           "extends reaches only files of this folder and of the library");
    }
    if (!load_find(m, from, name, path, sizeof path)) {
        return mu_fault_at(fault, from, line, 0,
                           "extends \"%s\": no such file beside this one or in the library", name);
    }
    if (load_is_open(m, path)) {
        return mu_fault_at(fault, from, line, 0, "extends \"%s\": the files extend each other",
                           name);
    }
    if (loader_of(m)->files_deep == LOAD_DEEP_MAX) {
        return mu_fault_at(fault, from, line, 0, "extends \"%s\": more than %d files deep", name,
                           LOAD_DEEP_MAX);
    }
    return load_file(m, path, fault);
}

/* (on-layer 4 trade) outside of rules, below the deffunction. */
static mu_result load_layer(struct mind *m, const char *path, int line, const char *at,
                            struct mu_fault *fault)
{
    char name[MU_FIELD_MAX + 1] = "";
    struct syntax_field layer = syntax_read_field(&at);
    struct syntax_field function = syntax_read_field(&at);
    struct syntax_field close = syntax_read_field(&at);
    bool well_formed = layer.kind == SYNTAX_FIELD_INTEGER && layer.integer >= 1 &&
                       layer.integer <= UINT32_MAX && function.kind == SYNTAX_FIELD_SYMBOL &&
                       function.len < sizeof name && close.kind == SYNTAX_FIELD_BAD && *at == ')';
    if (!well_formed) {
        return mu_fault_at(fault, path, line, 0,
                           "expected (on-layer LAYER FUNCTION): a number from 1 on, a deffunction");
    }
    memcpy(name, function.at, function.len);
    mu_result r = layers_add(m, (uint32_t)layer.integer, name);
    if (r == MU_FULL) {
        return mu_fault_at(fault, path, line, 0, "on-layer: more than %d handlers",
                           LAYERS_HANDLERS_MAX);
    }
    return r == MU_OK ? MU_OK
                      : mu_fault_at(fault, path, line, 0,
                                    "on-layer: no deffunction %s that takes four arguments: id, "
                                    "from, performative, content",
                                    name);
}

/* (on-resolve SCHEME FUNCTION) outside of rules, below the deffunction. */
static mu_result load_resolver(struct mind *m, const char *path, int line, const char *at,
                               struct mu_fault *fault)
{
    char words[2][MU_FIELD_MAX + 1] = {"", ""};
    bool well_formed = true;
    for (size_t i = 0; i < 2 && well_formed; i++) {
        struct syntax_field f = syntax_read_field(&at);
        well_formed = f.kind == SYNTAX_FIELD_SYMBOL && f.len < sizeof words[0];
        memcpy(words[i], f.at, well_formed ? f.len : 0);
    }
    if (!well_formed || syntax_read_field(&at).kind != SYNTAX_FIELD_BAD || *at != ')') {
        return mu_fault_at(fault, path, line, 0,
                           "expected (on-resolve SCHEME FUNCTION): a name, a deffunction");
    }
    mu_result r = layers_resolve(m, words[0], words[1]);
    if (r == MU_MALFORMED) {
        return mu_fault_at(fault, path, line, 0, "on-resolve: %s cannot be the name of a scheme",
                           words[0]);
    }
    return r == MU_ABSENT
               ? mu_fault_at(fault, path, line, 0,
                             "on-resolve: no deffunction %s that takes two arguments: rest, sender",
                             words[1])
               : MU_OK;
}

static mu_result load_form(struct mind *m, const char *path, struct syntax_form f,
                           struct mu_fault *fault)
{
    char name[LOAD_PATH_MAX];
    const char *at;
    bool well_formed = false;
    if (f.kind == SYNTAX_FORM_BAD) {
        return mu_fault_at(fault, path, f.line, 0, "%s", f.what);
    }
    if (f.kind == SYNTAX_FORM_ATOM) {
        return mu_fault_at(fault, path, f.line, 0, "expected a construct, found %.*s",
                           (int)(f.len < 40 ? f.len : 40), f.at);
    }
    if (load_begins(f, "on-layer", &at)) {
        return load_layer(m, path, f.line, at, fault);
    }
    if (load_begins(f, "on-resolve", &at)) {
        return load_resolver(m, path, f.line, at, fault);
    }
    if (!load_is_extends(f, name, sizeof name, &well_formed)) {
        return load_construct(m, path, f, fault);
    }
    if (!well_formed) {
        return mu_fault_at(fault, path, f.line, 0, "expected (extends \"FILE\")");
    }
    return load_extends(m, path, f.line, name, fault);
}

mu_result load_text(struct mind *m, const char *path, const char *at, struct mu_fault *fault)
{
    int line = 1;
    mu_result r = MU_OK;
    loader_of(m)->files[loader_of(m)->files_deep++] = path;
    while (r == MU_OK) {
        struct syntax_form f = syntax_read_form(&at, &line);
        if (f.kind == SYNTAX_FORM_END) {
            break;
        }
        r = load_form(m, path, f, fault);
    }
    loader_of(m)->files_deep--;
    return r;
}

mu_result load_file(struct mind *m, const char *path, struct mu_fault *fault)
{
    const char *at = NULL;
    size_t used = loader_of(m)->text_used;
    mu_result r = load_push(m, path, &at, fault);
    r = r == MU_OK ? load_text(m, path, at, fault) : r;
    loader_of(m)->text_used = used;
    return r;
}

mu_result load_begin(struct mind *m, const char *path, struct mu_fault *fault)
{
    environment_begin(m);
    budget_start(m, 0);
    m->shown_count = 0;
    EnvReset(m->env);
    if (environment_end(m)) {
        char said[MU_FAULT_TEXT_MAX + 1];
        load_said(m, said, sizeof said);
        return mu_fault_at(fault, path, 0, 0, "%s", said[0] ? said : "(reset) was stopped");
    }
    return MU_OK;
}
