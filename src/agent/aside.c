/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/aside.h"

#include "agent/robot.h"
#include "core/hash.h"
#include "core/log.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* @return whether it may have a file */
static bool aside_path(const struct robot *r, char path[PATH_MAX])
{
    const char *folder = r->group->set->checkpoints.folder;
    return folder && snprintf(path, PATH_MAX, "%s/%s.lines", folder, r->name) < PATH_MAX;
}

/* --- the file: NUMBER HASH LIVES AT-HAND TEXT, a line each ------------------------------------ */

static void file_write(const struct robot *r)
{
    char path[PATH_MAX], bytes[ASIDE_LINES * (MU_ATTRIBUTES_MAX + 80)];
    if (!aside_path(r, path)) {
        return;
    }
    struct mu_text t = mu_text_in(bytes, sizeof bytes);
    for (size_t i = 0; i < ASIDE_LINES; i++) {
        const struct aside_line *l = &r->asides.lines[i];
        if (l->number > 0) {
            mu_text_format(&t, "%" PRIu64 " %016" PRIx64 " %u %d %s\n", l->number, l->hash,
                           l->lives, l->at_hand, l->text);
        }
    }
    if (t.len == 0) {
        (void)unlink(path);
        return;
    }
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    bool written = file >= 0 && write(file, t.at, t.len) == (ssize_t)t.len;
    if (!written) {
        mu_log(MU_LOG_WARNING, "line-not-noted", "name=%s %s", r->name, strerror(errno));
    }
    if (file >= 0) {
        close(file);
    }
}

static bool line_read(struct aside_line *l, FILE *file)
{
    char bytes[MU_ATTRIBUTES_MAX + 80];
    int at_hand, at = 0;
    if (!fgets(bytes, sizeof bytes, file) ||
        sscanf(bytes, "%" SCNu64 " %" SCNx64 " %u %d %n", &l->number, &l->hash, &l->lives, &at_hand,
               &at) != 4 ||
        at == 0) {
        return false;
    }
    bytes[strcspn(bytes, "\n")] = '\0';
    (void)mu_text_copy(l->text, sizeof l->text, bytes + at);
    l->lives += at_hand != 0;
    l->at_hand = false;
    return true;
}

void aside_open(struct robot *r, bool returns)
{
    char path[PATH_MAX];
    if (!aside_path(r, path)) {
        return;
    }
    FILE *file = returns ? fopen(path, "re") : NULL;
    if (!file) {
        (void)unlink(path);
        return;
    }
    for (size_t i = 0; i < ASIDE_LINES && line_read(&r->asides.lines[i], file); i++) {
    }
    fclose(file);
    file_write(r);
}

/* --- the lines -------------------------------------------------------------------------------- */

static struct aside_line *line_find(struct robot *r, uint64_t number, uint64_t hash)
{
    for (size_t i = 0; i < ASIDE_LINES; i++) {
        if (r->asides.lines[i].number == number && r->asides.lines[i].hash == hash) {
            return &r->asides.lines[i];
        }
    }
    return NULL;
}

/* A place for another one: a free one, or the oldest. */
static struct aside_line *line_place(struct asides *a)
{
    struct aside_line *last = &a->lines[ASIDE_LINES - 1];
    for (size_t i = 0; i < ASIDE_LINES; i++) {
        if (a->lines[i].number == 0) {
            return &a->lines[i];
        }
    }
    memmove(a->lines, a->lines + 1, (ASIDE_LINES - 1) * sizeof a->lines[0]);
    return last;
}

static void line_remove(struct asides *a, struct aside_line *l)
{
    struct aside_line *end = a->lines + ASIDE_LINES - 1;
    memmove(l, l + 1, (size_t)((char *)end - (char *)l));
    *end = (struct aside_line){.number = 0};
}

bool aside_begin(struct robot *r, const struct mu_mail *mail)
{
    uint64_t hash = mu_hash_bytes(MU_HASH_EMPTY, mail->content, strlen(mail->content));
    struct aside_line *l = line_find(r, mail->number, hash);
    if (l && l->lives >= ASIDE_LIVES) {
        mu_log(MU_LOG_WARNING, "line-set-aside", "name=%s from=%s lives=%u line=%s", r->name,
               mail->src, l->lives, l->text);
        return false;
    }
    if (!r->group->set->checkpoints.folder) {
        return true;
    }
    if (!l) {
        l = line_place(&r->asides);
        *l = (struct aside_line){.number = mail->number, .hash = hash};
        snprintf(l->text, sizeof l->text, "%s", mail->content);
        for (char *c = l->text; *c; c++) {
            *c = *c == '\n' || *c == '\r' ? ' ' : *c;
        }
    }
    l->at_hand = true;
    file_write(r);
    return true;
}

void aside_end(struct robot *r)
{
    for (size_t i = 0; i < ASIDE_LINES; i++) {
        if (r->asides.lines[i].at_hand) {
            line_remove(&r->asides, &r->asides.lines[i]);
            file_write(r);
            return;
        }
    }
}

static struct aside_line *entry_find(struct asides *a, size_t index)
{
    for (size_t i = 0; i < ASIDE_LINES; i++) {
        if (a->lines[i].lives >= ASIDE_LIVES && index-- == 0) {
            return &a->lines[i];
        }
    }
    return NULL;
}

const char *aside_entry(struct robot *r, size_t index)
{
    const struct aside_line *l = entry_find(&r->asides, index);
    return l ? l->text : NULL;
}

bool aside_drop(struct robot *r, size_t index)
{
    struct aside_line *l = entry_find(&r->asides, index);
    if (l) {
        line_remove(&r->asides, l);
        file_write(r);
    }
    return l != NULL;
}
