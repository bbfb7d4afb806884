/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/robot.h"
#include "core/clock.h"
#include "core/log.h"
#include "core/name.h"
#include "core/text_file.h"
#include "muster/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { CHECKPOINT_VERSION = 1 };

static const char SUFFIX[] = ".capsule";

static const char GONE[] = ".gone";

void checkpoint_reserve(struct group_process *g)
{
    struct checkpoints *k = &g->checkpoints;
    k->set = &g->set->checkpoints;
    if (k->set->folder || k->set->restore) {
        mu_text_init(&k->text, mu_startup_alloc(MIGRATION_SNAPSHOT_MAX), MIGRATION_SNAPSHOT_MAX);
        k->saved = mu_startup_array(g->count, sizeof *k->saved);
    }
}

/* --- writing ---------------------------------------------------------------------------------- */

/* In lock step, time is the run's. */
static uint64_t clock_ns(const struct robot *r)
{
    return mu_process_in_lockstep(r->group->process) ? r->time_ns : mu_clock_ns();
}

static void file_name(const struct checkpoints *k, char path[PATH_MAX], const char *prefix,
                      const char *name)
{
    snprintf(path, PATH_MAX, "%s/%s%s%s", k->set->folder, prefix, name, SUFFIX);
}

static void mark_name(const struct checkpoints *k, char path[PATH_MAX], const char *name)
{
    snprintf(path, PATH_MAX, "%s/%s%s", k->set->folder, name, GONE);
}

bool checkpoint_is_gone(const struct group_process *g, const char *name)
{
    char path[PATH_MAX];
    mark_name(&g->checkpoints, path, name);
    return g->checkpoints.set->folder && access(path, F_OK) == 0;
}

bool checkpoint_is_there(const struct group_process *g, const char *name)
{
    char path[PATH_MAX];
    file_name(&g->checkpoints, path, "", name);
    return g->checkpoints.set->folder && access(path, F_OK) == 0;
}

static bool bytes_write(int file, const char *at, size_t len)
{
    while (len > 0) {
        ssize_t written = write(file, at, len);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return false;
        }
        at += written;
        len -= (size_t)written;
    }
    return true;
}

static bool file_write(const struct checkpoints *k, const char *name)
{
    char path[PATH_MAX], beside[PATH_MAX];
    file_name(k, path, "", name);
    file_name(k, beside, ".", name);
    int file = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) {
        return false;
    }
    bool written = bytes_write(file, k->text.at, k->text.len);
    written = close(file) == 0 && written;
    return written && rename(beside, path) == 0;
}

/* One that has come back and has said nothing yet keeps its answer, for a life after this one. */
static void head_add(struct mu_text *out, const struct robot *r)
{
    bool keeps = r->state == ROBOT_RETURNED && r->group->process->up_state != UP_ANSWERING;
    mu_text_format(out, "checkpoint %d %" PRId64 "\n", CHECKPOINT_VERSION,
                   keeps ? r->saved_step : r->step);
    if (keeps) {
        answer_keep(out, &r->answer);
    } else {
        answer_add(out, r->agent);
    }
}

/* Writes an agent and its file.  @return NULL, or why that failed */
static const char *agent_save(struct robot *r, enum mu_state state, struct mu_fault *fault)
{
    struct checkpoints *k = &r->group->checkpoints;
    struct snapshot_header p = {.purpose = MIGRATION_MOVE,
                                .state = state,
                                .mails = r->mails,
                                .passage = mu_agent_passage(r->agent)};
    (void)mu_text_copy(p.name, sizeof p.name, r->name);
    mu_text_clear(&k->text);
    head_add(&k->text, r);
    struct mu_text rest = mu_text_in(k->text.at + k->text.len, k->text.size - k->text.len);
    const char *why = agent_write(r, &p, &rest, fault);
    k->text.len += rest.len;
    return why || file_write(k, r->name) ? why : strerror(errno);
}

/* Removes the mark of an agent that is here again. */
static void mark_remove(const struct checkpoints *k, const char *name)
{
    char path[PATH_MAX];
    mark_name(k, path, name);
    (void)unlink(path);
}

bool checkpoint_write(struct robot *r, enum mu_state state)
{
    struct saved *s = &r->group->checkpoints.saved[r - r->group->robots];
    struct mu_fault fault;
    s->written_ns = clock_ns(r);
    s->state = state;
    s->tried = true;
    const char *why = agent_save(r, state, &fault);
    if (why && !s->failing) {
        mu_log(MU_LOG_WARNING, "checkpoint-failed", "name=%s folder=%s %s", r->name,
               r->group->checkpoints.set->folder, why);
    }
    s->failing = why;
    if (!why && !s->name[0]) {
        mark_remove(&r->group->checkpoints, r->name);
    }
    if (!why) {
        (void)mu_text_copy(s->name, sizeof s->name, r->name);
    }
    return !why;
}

static void mark_write(const struct checkpoints *k, const char *name)
{
    char path[PATH_MAX];
    mark_name(k, path, name);
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || close(file) != 0) {
        mu_log(MU_LOG_WARNING, "checkpoint-failed", "name=%s %s", name, strerror(errno));
    }
}

/* Removes the file of an agent that is not to come back here. */
static void file_forget(const struct checkpoints *k, const char *name)
{
    char path[PATH_MAX];
    file_name(k, path, "", name);
    (void)unlink(path);
}

/* An agent without a name from a broker may be the second copy of another one. */
static bool lives_here(const struct robot *r)
{
    return robot_state_lives(r->state) && !agent_is_away(r) &&
           mu_agent_passage(r->agent).broker != 0;
}

static bool is_due(const struct robot *r, const struct saved *s)
{
    uint64_t every_ns = (uint64_t)llround(r->group->checkpoints.set->every_s * 1e9);
    uint64_t now_ns = clock_ns(r);
    bool late = now_ns < s->written_ns || now_ns - s->written_ns >= every_ns;
    return !s->tried || late || mu_agent_state(r->agent) != s->state;
}

void checkpoint_round(struct group_process *g)
{
    const struct checkpoints *k = &g->checkpoints;
    for (uint32_t i = 0; i < g->count && k->set->every_s > 0; i++) {
        struct robot *r = &g->robots[i];
        struct saved *s = &k->saved[i];
        s->tried = s->tried && r->state != ROBOT_VACANT;
        if (lives_here(r) && is_due(r, s)) {
            (void)checkpoint_write(r, mu_agent_state(r->agent));
        }
    }
}

void checkpoint_leave(struct robot *r)
{
    const struct checkpoints *k = &r->group->checkpoints;
    if (!k->set->folder || r->state != ROBOT_VACANT) {
        return;
    }
    struct saved *s = &k->saved[r - r->group->robots];
    if (s->native) {
        mark_write(k, r->name);
        s->native = false;
    }
    if (s->name[0]) {
        file_forget(k, s->name);
        s->name[0] = '\0';
    }
}

void checkpoint_forget(struct group_process *g)
{
    for (uint32_t i = 0; i < g->count; i++) {
        checkpoint_leave(&g->robots[i]);
    }
}

void checkpoint_set_native(struct robot *r, bool native)
{
    if (r->group->checkpoints.saved) {
        r->group->checkpoints.saved[r - r->group->robots].native = native;
    }
}

void checkpoint_own(struct robot *r)
{
    struct saved *s = &r->group->checkpoints.saved[r - r->group->robots];
    (void)mu_text_copy(s->name, sizeof s->name, r->name);
}

/* --- coming back ------------------------------------------------------------------------------ */

static bool file_read(const char *path, struct mu_text *out)
{
    struct mu_fault fault;
    return mu_text_file_read(path, out, &fault) == MU_OK && !out->cut;
}

/*
 * Reads the part before the snapshot's header and moves behind it.  @return false: it is malformed
 */
static bool checkpoint_head_read(const char **text, struct checkpoint_head *out)
{
    int version = 0, len = 0;
    int read = sscanf(*text, "checkpoint %d %" SCNd64 "%n", &version, &out->step, &len);
    if (read != 2 || version != CHECKPOINT_VERSION || (*text)[len] != '\n') {
        return false;
    }
    *text += len + 1;
    return answer_read(text, &out->answer);
}

const char *checkpoint_read(struct group_process *g, const char *name, struct checkpoint_head *head,
                            struct snapshot_header *p)
{
    char path[PATH_MAX];
    struct checkpoints *k = &g->checkpoints;
    file_name(k, path, "", name);
    const char *rest = k->text.at;
    if (!file_read(path, &k->text)) {
        mu_log(MU_LOG_WARNING, "checkpoint-missing", "file=%s %s", path, strerror(errno));
        return NULL;
    }
    bool read = checkpoint_head_read(&rest, head) && snapshot_header_read(&rest, p) &&
                strcmp(p->name, name) == 0;
    if (!read) {
        mu_log(MU_LOG_WARNING, "checkpoint-refused", "file=%s damaged, or not of %s", path, name);
    }
    return read ? rest : NULL;
}

/* @return whether the file is an agent's; name is that agent's then */
static bool file_is_one(const char *file, char name[MU_NAME_MAX + 1])
{
    size_t len = strlen(file);
    size_t suffix = sizeof SUFFIX - 1;
    if (len <= suffix || len - suffix > MU_NAME_MAX || strcmp(file + len - suffix, SUFFIX) != 0) {
        return false;
    }
    memcpy(name, file, len - suffix);
    name[len - suffix] = '\0';
    return mu_name_valid(name);
}

uint32_t checkpoint_each(struct group_process *g,
                         bool (*take)(struct group_process *g, const char *name,
                                      const struct checkpoint_head *head, const char *text))
{
    struct checkpoints *k = &g->checkpoints;
    char name[MU_NAME_MAX + 1], path[PATH_MAX];
    uint32_t count = 0;
    DIR *folder = opendir(k->set->folder);
    struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        if (file_is_one(entry->d_name, name)) {
            file_name(k, path, "", name);
            const char *text = k->text.at;
            struct checkpoint_head head;
            bool read = file_read(path, &k->text) && checkpoint_head_read(&text, &head);
            count += take(g, name, &head, read ? text : "");
        }
    }
    if (folder) {
        closedir(folder);
    }
    return count;
}
