/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The files that a run is made of, for its recording: the experiment, the world and what it takes
 * in, rule files and what they extend, the shared rules, the policy.
 *
 * Rules are not parsed for that.  A text in quotes behind the word that takes a file in names one,
 * if there is one: at worst the recording has a file too many.
 */
#include "core/hash.h"
#include "core/paths.h"
#include "core/sort.h"
#include "core/text_file.h"
#include "muster/memory.h"
#include "run/run.h"
#include "world/parse/parser.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_MAX = 1 << 20 };

struct files {
    struct run_file *list;
    size_t count, searched;
    char *text; /* TEXT_MAX, of the one that is searched */
};

static const char *name_make(const char *role, const char *path)
{
    char bytes[PATH_MAX + 32];
    const char *slash = strrchr(path, '/');
    struct mu_text name = mu_text_in(bytes, sizeof bytes);
    mu_text_add(&name, role);
    if (strcmp(role, "library") == 0 && slash) {
        mu_text_add(&name, slash);
    } else {
        mu_path_portable(&name, path);
    }
    return mu_startup_string(name.at);
}

/* One file may be named in several ways. */
static bool is_listed(const struct files *f, const char *spelled)
{
    char path[PATH_MAX], other[PATH_MAX];
    bool listed = false;
    mu_text_copy(path, sizeof path, spelled);
    mu_path_plain(path);
    for (size_t i = 0; i < f->count && !listed; i++) {
        mu_text_copy(other, sizeof other, f->list[i].path);
        mu_path_plain(other);
        listed = strcmp(other, path) == 0;
    }
    return listed;
}

uint64_t run_file_hash(const char *path)
{
    char bytes[4096];
    uint64_t hash = MU_HASH_EMPTY;
    FILE *file = fopen(path, "re");
    for (size_t count; file && (count = fread(bytes, 1, sizeof bytes, file)) > 0;) {
        hash = mu_hash_bytes(hash, bytes, count);
    }
    if (file) {
        fclose(file);
    }
    return hash;
}

static void file_add(struct files *f, const char *role, const char *path)
{
    if (is_listed(f, path)) {
        return;
    }
    if (f->count == RUN_FILES_MAX) {
        fprintf(stderr, "muster run: %s is not in the recording: it has %d files\n", path,
                RUN_FILES_MAX);
    } else if (access(path, R_OK) == 0) {
        struct run_file *file = &f->list[f->count++];
        file->role = role;
        file->path = mu_startup_string(path);
        file->name = name_make(role, path);
        file->hash = run_file_hash(path);
    }
}

/* Adds a file that another one names: it stands beside that. */
static void file_add_beside(struct files *f, const struct run_file *of, const char *name,
                            size_t len)
{
    char folder[PATH_MAX], file[PATH_MAX], path[PATH_MAX];
    const char *slash = strrchr(of->path, '/');
    int folder_len = slash ? (int)(slash - of->path) : 0;
    if (len == 0 || len >= sizeof file) {
        return;
    }
    snprintf(folder, sizeof folder, "%.*s", folder_len, of->path);
    snprintf(file, sizeof file, "%.*s", (int)len, name);
    if (mu_path_join(path, sizeof path, folder, file)) {
        file_add(f, of->role, path);
    }
}

/* What stands in quotes behind a word, wherever that is. */
static void word_search(struct files *f, const struct run_file *of, const char *word)
{
    for (const char *at = strstr(f->text, word); at; at = strstr(at, word)) {
        at += strlen(word);
        const char *name = at + strspn(at, " \t\r\n");
        if (*name == '"') {
            name++;
            file_add_beside(f, of, name, strcspn(name, "\"\n"));
        }
    }
}

static void file_search(struct files *f, const struct run_file *of)
{
    struct mu_fault fault;
    struct mu_text text = mu_text_in(f->text, TEXT_MAX);
    if (strcmp(of->role, "rules") == 0 && mu_text_file_read(of->path, &text, &fault) == MU_OK) {
        word_search(f, of, "extends");
    }
}

static int path_compare(const void *one, const void *other, const void *context)
{
    (void)context;
    return strcmp(((const struct run_file *)one)->path, ((const struct run_file *)other)->path);
}

/* The rules that every robot has. */
static void library_add(struct files *f)
{
    char folder[PATH_MAX], path[PATH_MAX];
    size_t before = f->count;
    if (!mu_path_rules(folder, sizeof folder)) {
        return;
    }
    DIR *all = opendir(folder);
    for (struct dirent *entry; all && (entry = readdir(all));) {
        size_t len = strlen(entry->d_name);
        bool is_rules = len > 4 && strcmp(entry->d_name + len - 4, ".clp") == 0;
        if (is_rules && mu_path_join(path, sizeof path, folder, entry->d_name)) {
            file_add(f, "library", path);
        }
    }
    if (all) {
        closedir(all);
    }
    mu_sort(f->list + before, f->count - before, sizeof *f->list, path_compare, NULL);
}

void run_files_find(struct run *r)
{
    const struct experiment *e = r->experiment;
    struct files f = {.list = mu_startup_array(RUN_FILES_MAX, sizeof *f.list),
                      .text = mu_startup_alloc(TEXT_MAX)};
    char experiment[PATH_MAX];
    file_add(&f, "experiment",
             realpath(r->options.file, experiment) ? experiment : r->options.file);
    for (size_t i = 0; i < r->world->source->files_count; i++) {
        file_add(&f, "world", r->world->source->files[i]);
    }
    for (unsigned i = 0; i < experiment_members(e); i++) {
        const struct experiment_robot *robot = &e->robots[i];
        file_add(&f, robot->rules ? "rules" : RUN_CONTROLLER,
                 robot->rules ? robot->rules : robot->controller.program);
    }
    for (unsigned i = 0; i < e->observer_count; i++) {
        if (e->observer[i].rules) {
            file_add(&f, "rules", e->observer[i].rules);
        }
    }
    for (unsigned i = 0; i < e->monitors_count; i++) {
        if (e->monitors[i].rules) {
            file_add(&f, "rules", e->monitors[i].rules);
        }
    }
    if (e->policy) {
        file_add(&f, "policy", e->policy);
    }
    for (; f.searched < f.count; f.searched++) {
        file_search(&f, &f.list[f.searched]);
    }
    library_add(&f);
    r->files = f.list;
    r->files_count = f.count;
}
