/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Agents on disk: a file for each, NAME.capsule, which is replaced as a whole.  It outlives the
 * process, and not a loss of power.
 */
#include "core/clock.h"
#include "core/log.h"
#include "host/host.h"
#include "muster/memory.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char SUFFIX[] = ".capsule";

void checkpoints_reserve(struct host *h)
{
    char *bytes = mu_startup_alloc(TRIP_CAPSULE_MAX);
    mu_text_init(&h->checkpoint, bytes, TRIP_CAPSULE_MAX);
    h->saved = mu_startup_array(h->crew.count, sizeof *h->saved);
}

static void file_name(const struct host *h, char path[PATH_MAX], const char *prefix,
                      const char *name)
{
    snprintf(path, PATH_MAX, "%s/%s%s%s", h->set->folder, prefix, name, SUFFIX);
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

static bool file_write(const struct host *h, const char *name, const struct mu_text *text)
{
    char path[PATH_MAX], beside[PATH_MAX];
    file_name(h, path, "", name);
    file_name(h, beside, ".", name);
    int file = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0) {
        return false;
    }
    bool written = bytes_write(file, text->at, text->len);
    written = close(file) == 0 && written;
    return written && rename(beside, path) == 0;
}

bool checkpoint_write(struct host *h, struct robot *r, enum mu_state state)
{
    struct saved *s = &h->saved[r - h->crew.robots];
    struct mu_fault fault;
    struct passport p = {.purpose = TRIP_MOVE,
                         .state = state,
                         .mails = r->mails,
                         .passage = mu_agent_passage(r->agent)};
    s->due_ns = mu_clock_ns() + (uint64_t)(h->set->checkpoint_s * 1e9);
    (void)mu_text_copy(p.name, sizeof p.name, r->name);
    const char *why = trip_write(r, &p, &h->checkpoint, &fault);
    if (!why && !file_write(h, r->name, &h->checkpoint)) {
        why = strerror(errno);
    }
    if (why) {
        mu_log(MU_LOG_WARNING, "checkpoint-failed", "name=%s %s", r->name, why);
        return false;
    }
    (void)mu_text_copy(s->name, sizeof s->name, r->name);
    return true;
}

/* It is not here any more, and is not to come back here. */
static void checkpoint_forget(struct host *h, struct saved *s)
{
    char path[PATH_MAX];
    file_name(h, path, "", s->name);
    (void)unlink(path);
    s->name[0] = '\0';
}

void checkpoints_round(struct host *h)
{
    if (h->set->checkpoint_s <= 0) {
        return;
    }
    uint64_t now_ns = mu_clock_ns();
    for (uint32_t i = 0; i < h->crew.count; i++) {
        struct robot *r = &h->crew.robots[i];
        struct saved *s = &h->saved[i];
        if (s->name[0] && r->out) {
            checkpoint_forget(h, s);
        } else if (!r->out && !r->arrives && !trip_holds(r) && now_ns >= s->due_ns) {
            (void)checkpoint_write(h, r, mu_agent_state(r->agent));
        }
    }
}

/* --- coming back ------------------------------------------------------------------------------ */

static bool file_read(const char *path, struct mu_text *out)
{
    FILE *f = fopen(path, "rb");
    if (!f) {
        return false;
    }
    out->len = fread(out->at, 1, out->size - 1, f);
    out->at[out->len] = '\0';
    bool good = !ferror(f) && feof(f);
    fclose(f);
    return good;
}

/* @return whether an agent was on its way back */
static bool agent_restore(struct host *h, const char *file)
{
    char path[PATH_MAX], why[MU_FAULT_TEXT_MAX + 1] = "cannot be read";
    struct arrival *a = &h->arrivals[0];
    struct arrival back = {.text = a->text};
    int len = snprintf(path, sizeof path, "%s/%s", h->set->folder, file);
    bool read = len > 0 && (size_t)len < sizeof path && file_read(path, &back.text);
    bool taken = read && host_take_in(h, &back, why);
    if (!taken) {
        fprintf(stderr, "muster host: %s: %s\n", path, why);
    }
    return taken;
}

uint32_t checkpoints_restore(struct host *h)
{
    uint32_t count = 0;
    DIR *folder = opendir(h->set->folder);
    struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        size_t len = strlen(entry->d_name);
        size_t suffix = sizeof SUFFIX - 1;
        bool is_one = entry->d_name[0] != '.' && len > suffix &&
                      strcmp(entry->d_name + len - suffix, SUFFIX) == 0;
        count += is_one && agent_restore(h, entry->d_name);
    }
    if (folder) {
        closedir(folder);
    }
    return count;
}
