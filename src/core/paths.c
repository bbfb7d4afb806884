/* SPDX-License-Identifier: Apache-2.0 */
#include "core/paths.h"

#include "core/text.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool program_folder(char *folder, size_t size)
{
    ssize_t len = readlink("/proc/self/exe", folder, size - 1);
    if (len <= 0) {
        return false;
    }
    folder[len] = '\0';
    char *slash = strrchr(folder, '/');
    if (!slash) {
        return false;
    }
    *slash = '\0';
    return true;
}

bool mu_path_join(char *path, size_t size, const char *folder, const char *file)
{
    struct mu_text t;
    mu_text_init(&t, path, size);
    if (file[0] != '/' && folder[0] != '\0') {
        mu_text_format(&t, "%s/", folder);
    }
    mu_text_add(&t, file);
    return !t.cut;
}

void mu_path_plain(char *path)
{
    char *end = path; /* of what is kept */
    for (const char *at = path; *path == '/' && *at;) {
        size_t len = 1 + strcspn(at + 1, "/"); /* with the slash before it */
        if (len == 3 && strncmp(at, "/..", 3) == 0) {
            while (end > path && *--end != '/') {
            }
        } else if (len > 1 && !(len == 2 && at[1] == '.')) {
            memmove(end, at, len);
            end += len;
        }
        at += len;
    }
    if (*path == '/') {
        end += end == path; /* the root itself */
        *end = '\0';
    }
}

bool mu_path_program(char *path, size_t size, const char *program)
{
    char folder[PATH_MAX];
    return program_folder(folder, sizeof folder) && mu_path_join(path, size, folder, program);
}

static bool has_library(const char *folder)
{
    char file[PATH_MAX];
    return mu_path_join(file, sizeof file, folder, "muster.clp") && access(file, R_OK) == 0;
}

/* The tree is known by two of its files: three folders above an installed program is a stranger's.
 */
static bool is_source_tree(const char *folder)
{
    char file[PATH_MAX];
    return mu_path_join(file, sizeof file, folder, "../../../idl/wire.idl") &&
           access(file, R_OK) == 0;
}

bool mu_path_rules(char *path, size_t size)
{
    const char *chosen = getenv("MUSTER_RULES");
    if (chosen && chosen[0]) {
        return mu_text_copy(path, size, chosen) && has_library(path);
    }
    char folder[PATH_MAX];
    if (!program_folder(folder, sizeof folder)) {
        return false;
    }
    /* bin below the prefix; build/VARIANT/bin in the source tree. */
    if (mu_path_join(path, size, folder, "../share/muster/rules") && has_library(path)) {
        return true;
    }
    return is_source_tree(folder) && mu_path_join(path, size, folder, "../../../rules") &&
           has_library(path);
}
