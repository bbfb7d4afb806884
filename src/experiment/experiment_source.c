/* SPDX-License-Identifier: Apache-2.0 */
/* What the steps of loading share: places, faults and files. */
#include "experiment/experiment_source.h"

#include "core/paths.h"
#include "muster/memory.h"
#include "world/condition/condition.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

mu_result experiment_fault(struct experiment_source *source, const void *field, int node,
                           const char *format, ...)
{
    char text[MU_FAULT_TEXT_MAX + 1];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = source->overrides_count; i > 0; i--) {
        if (source->overrides[i - 1].field == field) {
            char place[MU_FAULT_FILE_MAX + 1];
            snprintf(place, sizeof place, "--set %s", source->overrides[i - 1].text);
            mu_fault_at(source->fault, place, 0, 0, "%s", text);
            return MU_FAULT_USAGE;
        }
    }
    return yaml_tree_fault(source->tree, node, source->fault, "%s", text);
}

struct experiment_mark experiment_mark(const struct experiment_source *s, int node)
{
    struct mu_fault here;
    (void)yaml_tree_fault(s->tree, node, &here, "%s", "");
    return (struct experiment_mark){here.line, here.column};
}

int experiment_section(struct experiment_source *s, const char *key)
{
    return yaml_tree_child(s->tree, yaml_tree_root(s->tree), key);
}

int experiment_item(struct experiment_source *s, const char *key, size_t index)
{
    return yaml_tree_item(s->tree, experiment_section(s, key), index);
}

int experiment_member(struct experiment_source *s, size_t index)
{
    size_t robots = yaml_tree_count(s->tree, experiment_section(s, "robots"));
    return index < robots ? experiment_item(s, "robots", index)
                          : experiment_item(s, "agents", index - robots);
}

bool experiment_overridden(const struct experiment_source *s, const void *field)
{
    for (size_t i = 0; i < s->overrides_count; i++) {
        if (s->overrides[i].field == field) {
            return true;
        }
    }
    return false;
}

static const char *files_root = "";

void experiment_root(const char *folder)
{
    files_root = folder;
}

bool experiment_is_recorded(void)
{
    return files_root[0] != '\0';
}

/* Writes the path of a file from the root on, with the links that are in it: a recording has the
 * file by the name that the experiment has for it.  @return whether it can be read there */
static bool path_from_root(const struct experiment *e, const char *path, char whole[PATH_MAX])
{
    char folder[PATH_MAX];
    const char *from = path[0] == '/' ? files_root : realpath(e->folder, folder);
    if (!from || snprintf(whole, PATH_MAX, "%s/%s", from, path) >= PATH_MAX) {
        return false;
    }
    mu_path_plain(whole);
    return access(whole, R_OK) == 0;
}

mu_result experiment_check_file(struct experiment_source *s, char **path, int node,
                                const char *what)
{
    char joined[PATH_MAX], absolute[PATH_MAX];
    bool relative = (*path)[0] != '/';
    int len = snprintf(joined, sizeof joined, "%s%s%s",
                       relative ? s->experiment->folder : files_root, relative ? "/" : "", *path);
    if (len < 0 || (size_t)len >= sizeof joined) {
        return experiment_fault(s, path, node, "expected a shorter path");
    }
    if (!path_from_root(s->experiment, *path, absolute) &&
        (!realpath(joined, absolute) || access(absolute, R_OK) != 0)) {
        return experiment_fault(s, path, node, "cannot read the %s '%s': %s", what, joined,
                                strerror(errno));
    }
    struct stat is;
    if (stat(absolute, &is) == 0 && S_ISDIR(is.st_mode)) {
        return experiment_fault(s, path, node, "expected a file as the %s, not the folder '%s'",
                                what, joined);
    }
    *path = mu_startup_string(absolute);
    return MU_OK;
}

mu_result experiment_check_program(struct experiment_source *s, char **path, int node)
{
    struct stat is;
    MU_TRY(experiment_check_file(s, path, node, "program"));
    return stat(*path, &is) == 0 && S_ISREG(is.st_mode) && access(*path, X_OK) == 0
               ? MU_OK
               : experiment_fault(s, path, node, "expected a program that may be started, not '%s'",
                                  *path);
}

mu_result experiment_check_condition(struct experiment_source *s, const char *text, int node)
{
    char why[CONDITION_WHY_MAX];
    struct condition c;
    const struct condition_names names = {.find = experiment_body_find,
                                          .self = s->experiment,
                                          .robots = (int)s->experiment->robots_count,
                                          .find_agent = experiment_agent_find,
                                          .agents = s->experiment};
    if (strlen(text) >= CONDITION_TEXT_MAX) {
        return experiment_fault(s, NULL, node, "expected a condition of at most %d bytes",
                                CONDITION_TEXT_MAX - 1);
    }
    return condition_read(&c, text, &names, why) == MU_OK
               ? MU_OK
               : experiment_fault(s, NULL, node, "%s", why);
}
