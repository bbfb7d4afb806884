/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/csv.h"
#include "muster/memory.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { TRACKS_BUFFER = 256 * 1024 };

struct tracks {
    FILE *file, *placements; /* NULL: no robot was placed yet */
    char path[512], placements_path[512];
    char buffer[TRACKS_BUFFER];
};

static mu_result tracks_fault(const char *path, const char *what)
{
    fprintf(stderr, "cannot %s %s: %s\n", what, path, strerror(errno));
    return MU_FAULT_OS;
}

mu_result tracks_open(struct tracks **out, const char *path)
{
    struct tracks *r = mu_startup_alloc(sizeof *r);
    const char *slash = strrchr(path, '/');
    snprintf(r->path, sizeof r->path, "%s", path);
    snprintf(r->placements_path, sizeof r->placements_path, "%.*splacements.csv",
             slash ? (int)(slash + 1 - path) : 0, path);
    unlink(r->placements_path); /* an earlier run may have left it */
    r->file = fopen(path, "w");
    if (!r->file) {
        return tracks_fault(path, "create");
    }
    setvbuf(r->file, r->buffer, _IOFBF, sizeof r->buffer);
    mu_csv_head(r->file);
    *out = r;
    return MU_OK;
}

/* Creates placements.csv when the first robot is placed.  A full disk also shows in the tracks. */
static void placement_add(struct tracks *r, uint64_t time_ns, const char *robot)
{
    if (!r->placements && (r->placements = fopen(r->placements_path, "w"))) {
        fputs(MU_CSV_PLACEMENTS_HEAD, r->placements);
    }
    if (r->placements) {
        mu_csv_placement(r->placements, time_ns, robot);
        fflush(r->placements);
    }
}

void tracks_add(struct tracks *r, uint64_t time_ns, const char *robot,
                const struct engine_sample *sample)
{
    struct mu_percept body = engine_truth(sample);
    mu_csv_row(r->file, time_ns, robot, &body);
    if (sample->placed) {
        placement_add(r, time_ns, robot);
    }
}

mu_result tracks_close(struct tracks *r)
{
    bool whole = !ferror(r->file);
    if (r->placements) {
        fclose(r->placements);
    }
    whole = fclose(r->file) == 0 && whole;
    return whole ? MU_OK : tracks_fault(r->path, "write");
}
