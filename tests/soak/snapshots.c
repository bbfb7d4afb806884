/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Rule files, each cut at another firing: a mind that is made of the snapshot has the same
 * snapshot, and fires, prints and ends as the one that it was made of. snapshots FILE... Names the
 * files of which that is not so, and counts as tests do.
 */
#include "core/text_file.h"
#include "mind/mind.h"

#include <stdio.h>
#include <string.h>

enum { SNAPSHOT_MAX = 1 << 20, LOG_MAX = 1 << 20, HEAD = 96, CUT_MOST = 40, STEPS = 4 };

/* A mind, and what it has printed and fired since the cut. */
struct side {
    struct mind *mind;
    struct mu_text log, snapshot;
    char log_bytes[LOG_MAX], snapshot_bytes[SNAPSHOT_MAX];
};

static struct side stays, goes;

static void print(void *self, const char *text)
{
    struct side *s = self;
    mu_text_add(&s->log, text);
}

static bool begin(struct side *s)
{
    struct mu_fault fault;
    struct mind_options options = {
        .read = mu_text_file_read, .name = "red", .seed = 1, .ports = {.self = s, .print = print}};
    s->mind = s->mind ? s->mind : mind_reserve();
    mind_close(s->mind);
    mu_text_init(&s->log, s->log_bytes, sizeof s->log_bytes);
    mu_text_init(&s->snapshot, s->snapshot_bytes, sizeof s->snapshot_bytes);
    return mind_begin(s->mind, &options, &fault) == MU_OK;
}

static bool cut(const char *path, uint32_t firings)
{
    struct mu_fault fault = {.text = ""};
    struct mind_act act;
    bool good = begin(&stays) && begin(&goes) && mind_load(stays.mind, path, &fault) == MU_OK;
    if (good) {
        mind_fire_some(stays.mind, firings, &act);
        mu_text_clear(&stays.log);
    }
    good = good && mind_save(stays.mind, &stays.snapshot, &fault) == MU_OK &&
           mind_restore(goes.mind, stays.snapshot.at, stays.snapshot.len, &fault) == MU_OK &&
           mind_save(goes.mind, &goes.snapshot, &fault) == MU_OK;
    if (!good) {
        printf("%s: %s\n", path, fault.text);
    }
    return good;
}

static void go_on(struct side *s)
{
    struct mind_act act;
    for (int i = 0; i < STEPS; i++) {
        mind_fire(s->mind, &act);
        mu_text_format(&s->log, "step: %s\n", act.rules);
    }
}

static bool is_same(const char *path, uint32_t firings)
{
    if (!cut(path, firings)) {
        return false;
    }
    go_on(&stays);
    go_on(&goes);
    bool snapshots = strcmp(stays.snapshot.at + HEAD, goes.snapshot.at + HEAD) == 0;
    bool runs = strcmp(stays.log.at, goes.log.at) == 0;
    if (!snapshots || !runs) {
        printf("%s, cut after %u: another %s\n", path, firings, snapshots ? "run" : "snapshot");
    }
    return snapshots && runs;
}

int main(int argc, char **argv)
{
    int same = 0;
    for (int i = 1; i < argc; i++) {
        same += is_same(argv[i], (uint32_t)i * 7 % CUT_MOST);
    }
    printf("%d passed, %d failed\n", same, argc - 1 - same);
    return argc < 2 || same < argc - 1;
}
