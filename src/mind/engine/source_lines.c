/* SPDX-License-Identifier: Apache-2.0 */
/* The file and line of each construct, for complaints. */
#include "mind/engine/engine.h"
#include "muster/memory.h"

#include <string.h>

enum { PLACE_FILES_MAX = 32, PLACES_MAX = 512 };

struct place {
    char name[MU_FIELD_MAX + 1];
    int file, line; /* file < 0: it was typed */
};

struct source_lines {
    struct place at[PLACES_MAX];
    size_t count;
    char files[PLACE_FILES_MAX][MU_FAULT_FILE_MAX + 1];
    int file_count;
};

void source_lines_reserve(struct mind *m)
{
    m->source_lines = mu_startup_alloc(sizeof *m->source_lines);
}

void source_lines_install(struct mind *m)
{
    m->source_lines->count = 0;
    m->source_lines->file_count = 0;
}

/* Takes the second word of a form, without its module.  @return false: it has none that fits */
static bool place_name(const char *form, char name[MU_FIELD_MAX + 1])
{
    const char *at = form + (*form == '(');
    struct syntax_field kind = syntax_read_field(&at);
    struct syntax_field word = syntax_read_field(&at);
    if (kind.kind != SYNTAX_FIELD_SYMBOL || kind.len < 4 || strncmp(kind.at, "def", 3) != 0 ||
        word.kind != SYNTAX_FIELD_SYMBOL || word.len > MU_FIELD_MAX) {
        return false;
    }
    memcpy(name, word.at, word.len);
    name[word.len] = '\0';
    const char *own = strstr(name, "::");
    if (own) {
        memmove(name, own + 2, strlen(own + 2) + 1);
    }
    return true;
}

static struct place *place_find(struct source_lines *p, const char *name)
{
    for (size_t i = 0; i < p->count; i++) {
        if (strcmp(p->at[i].name, name) == 0) {
            return &p->at[i];
        }
    }
    return NULL;
}

/* @return the number of a file; -1: there is no room */
static int place_file(struct source_lines *p, const char *path)
{
    for (int i = 0; i < p->file_count; i++) {
        if (strcmp(p->files[i], path) == 0) {
            return i;
        }
    }
    if (p->file_count == PLACE_FILES_MAX || strlen(path) > MU_FAULT_FILE_MAX) {
        return -1;
    }
    mu_text_copy(p->files[p->file_count], sizeof p->files[0], path);
    return p->file_count++;
}

void source_lines_note(struct mind *m, const char *form, const char *path, int line)
{
    struct source_lines *p = m->source_lines;
    char name[MU_FIELD_MAX + 1];
    if (!place_name(form, name)) {
        return;
    }
    struct place *place = place_find(p, name);
    if (!place && path && p->count < PLACES_MAX) {
        place = &p->at[p->count++];
        mu_text_copy(place->name, sizeof place->name, name);
    }
    if (place) {
        place->file = path ? place_file(p, path) : -1;
        place->line = line;
    }
}

void source_lines_add(const struct mind *m, const char *name, struct mu_text *out)
{
    const struct place *place = place_find(m->source_lines, name);
    if (place && place->file >= 0) {
        mu_text_format(out, " (%s:%d)", m->source_lines->files[place->file], place->line);
    }
}
