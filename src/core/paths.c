/* SPDX-License-Identifier: Apache-2.0 */
#include "core/paths.h"

#include "core/text.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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
    struct mu_text t = mu_text_in(path, size);
    if (file[0] != '/' && folder[0] != '\0') {
        mu_text_format(&t, "%s/", folder);
    }
    mu_text_add(&t, file);
    return !t.cut;
}

void mu_path_plain(char *path)
{
    char *end = path; /* of the part that is kept */
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

static bool folder_has(const char *folder, const char *file)
{
    char path[PATH_MAX];
    return mu_path_join(path, sizeof path, folder, file) && access(path, R_OK) == 0;
}

/* bin below the prefix; build/VARIANT/bin in the source tree, which is known by two of its files:
 * three folders above an installed program is a stranger's. */
bool mu_path_own(char *path, size_t size, const char *folder, const char *file)
{
    char programs[PATH_MAX], sub[PATH_MAX];
    snprintf(sub, sizeof sub, "../share/muster/%s", folder);
    if (!program_folder(programs, sizeof programs)) {
        return false;
    }
    if (mu_path_join(path, size, programs, sub) && folder_has(path, file)) {
        return true;
    }
    snprintf(sub, sizeof sub, "../../../%s", folder);
    return folder_has(programs, "../../../idl/wire.idl") &&
           mu_path_join(path, size, programs, sub) && folder_has(path, file);
}

bool mu_path_rules(char *path, size_t size)
{
    const char *chosen = getenv("MUSTER_RULES");
    if (chosen && chosen[0]) {
        return mu_text_copy(path, size, chosen) && folder_has(path, "muster.clp");
    }
    return mu_path_own(path, size, "rules", "muster.clp");
}

mu_result mu_path_rules_need(char *path, size_t size, const char *program)
{
    if (mu_path_rules(path, size)) {
        return MU_OK;
    }
    fprintf(stderr,
            "%s: the shared rules are not found; set MUSTER_RULES to the folder that has "
            "muster.clp\n",
            program);
    return MU_FAULT_FILE;
}

bool mu_path_experiment(char *path, size_t size, const char *name)
{
    char folder[PATH_MAX], file[PATH_MAX];
    if (strchr(name, '/') || access(name, F_OK) == 0) {
        return false;
    }
    const char *ending = strchr(name, '.') ? "" : ".yaml";
    int len = snprintf(file, sizeof file, "%s%s", name, ending);
    return len > 0 && (size_t)len < sizeof file &&
           mu_path_own(folder, sizeof folder, "experiments", file) &&
           mu_path_join(path, size, folder, file);
}

void mu_path_portable(struct mu_text *name, const char *spelled)
{
    char here[PATH_MAX], path[PATH_MAX];
    mu_text_copy(path, sizeof path, spelled);
    mu_path_plain(path);
    size_t len = getcwd(here, sizeof here) ? strlen(here) : 0;
    bool below = len > 1 && strncmp(path, here, len) == 0 && path[len] == '/';
    mu_text_add(name, below ? path + len : path[0] == '/' ? "/_" : "/");
    mu_text_add(name, below ? "" : path);
}

bool mu_path_make_folders(char *path, mode_t mode)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(path, mode) != 0 && errno != EEXIST) {
            return false;
        }
        *slash = '/';
    }
    return true;
}
