/* SPDX-License-Identifier: Apache-2.0 */
/* Words that are known at the moment of completion only: what lives, and files of muster's own. */
#include "cli/help/completion.h"

#include "core/exits.h"
#include "core/paths.h"
#include "muster/directory.h"
#include "operator/operator.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void agents_print(const mu_process *p, bool hosts_only)
{
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(p, i)); i++) {
        bool fits = hosts_only ? m->kind == MU_KIND_HOST : !reader_is(m);
        if (fits && m->state != MU_GONE) {
            printf("%s\t%s, %s\n", m->name, mu_kind_text(m->kind), mu_state_text(m->state));
        }
    }
}

static void agent_words(const mu_process *p)
{
    agents_print(p, false);
}

static void target_words(const mu_process *p)
{
    puts("all\tevery agent\nrobots\tevery robot\nspecial\tbrokers, simulator and the like");
    agents_print(p, false);
    const char *group;
    for (size_t i = 0; (group = mu_process_group(p, i)); i++) {
        printf("group:%s\tits members\n", group);
    }
}

static void host_words(const mu_process *p)
{
    agents_print(p, true);
}

/* Of several agents with one broker, the first names it. */
static void broker_words(const mu_process *p)
{
    const struct mu_member *m, *before;
    for (size_t i = 0; (m = mu_process_member(p, i)); i++) {
        size_t first = 0;
        while ((before = mu_process_member(p, first)) && strcmp(before->broker, m->broker) != 0) {
            first++;
        }
        if (first == i && m->broker[0]) {
            printf("%s\tbroker\n", m->broker);
        }
    }
}

static void group_words(const mu_process *p)
{
    const char *group;
    for (size_t i = 0; (group = mu_process_group(p, i)); i++) {
        printf("%s\tgroup\n", group);
    }
}

static void service_words(const mu_process *p)
{
    const struct mu_service *s;
    for (size_t i = 0; (s = mu_process_find_service(p, "*", i)); i++) {
        printf("%s\tof %s\n", s->service, s->agent);
    }
}

static void run_words(void)
{
    char name[RUNS_NAME_MAX + 1];
    for (int domain = 0; runs_next(&domain, name); domain++) {
        printf("%d\t%s\n", domain, name);
    }
}

static const struct {
    const char *kind;
    void (*words)(const mu_process *p);
} lives[] = {
    {"agent", agent_words},   {"target", target_words}, {"host", host_words},
    {"broker", broker_words}, {"group", group_words},   {"service", service_words},
};

/* Files of muster's own.  Experiments are known by name, others by their path. */
static const struct {
    const char *kind, *folder, *ending, *known; /* known: a file that marks the folder */
} files[] = {
    {"experiment", "experiments", ".yaml", "follow.yaml"},
    {"rules", "rules", ".clp", "muster.clp"},
    {"world", "worlds", ".world", "arena.world"},
};

static int files_print(size_t which)
{
    char folder[PATH_MAX], whole[PATH_MAX];
    const struct dirent *found;
    bool by_name = which == 0;
    bool there = mu_path_own(folder, sizeof folder, files[which].folder, files[which].known) &&
                 realpath(folder, whole);
    DIR *listed = there ? opendir(whole) : NULL;
    while (listed && (found = readdir(listed))) {
        size_t ending = strlen(files[which].ending), len = strlen(found->d_name);
        if (len <= ending || strcmp(found->d_name + len - ending, files[which].ending) != 0) {
            continue;
        }
        if (by_name) {
            printf("%.*s\tof muster\n", (int)(len - ending), found->d_name);
        } else {
            printf("%s/%s\tof muster\n", whole, found->d_name);
        }
    }
    if (listed) {
        closedir(listed);
    }
    return MU_EXIT_DONE;
}

static int lives_print(size_t which, const struct completion_live *options)
{
    struct operator_options join = {.only_reads = true};
    struct operator op;
    join.network.domain = options->domain;
    join.network.wait_broker_s = options->wait_s;
    int code = operator_join(&op, &join, "completion");
    if (code == MU_EXIT_DONE) {
        lives[which].words(op.process);
        operator_leave(&op);
    }
    return code;
}

int completion_live(const char *kind, const struct completion_live *options)
{
    if (strcmp(kind, "run") == 0) {
        run_words();
        return MU_EXIT_DONE;
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        if (strcmp(kind, files[i].kind) == 0) {
            return files_print(i);
        }
    }
    for (size_t i = 0; i < sizeof lives / sizeof lives[0]; i++) {
        if (strcmp(kind, lives[i].kind) == 0) {
            return lives_print(i, options);
        }
    }
    return MU_EXIT_USAGE;
}
