/* SPDX-License-Identifier: Apache-2.0 */
/* What people see while a run lives, and where it broke off. */
#include "ctl/run.h"

#include "core/clock.h"

#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static const uint64_t PROGRESS_NS = 200000000;

static bool progress_is_wanted(const struct run *r)
{
    return !r->options.quiet && isatty(STDERR_FILENO);
}

/* A line that is wider than the terminal could not be written over. */
static int progress_room(void)
{
    struct winsize size;
    bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    return known ? size.ws_col - 1 : 79;
}

void run_progress_show(struct run *r)
{
    uint64_t now_ns = mu_clock_ns();
    double time_s = (double)r->time_ns * 1e-9;
    double wall_s = (double)r->wall_ns * 1e-9;
    bool due = now_ns - r->progress_wall_ns >= PROGRESS_NS && progress_is_wanted(r);
    if (!due || r->state != muster_RUN_RUNNING || wall_s <= 0.0 || time_s <= 0.0) {
        return;
    }
    char line[128];
    double factor = time_s / wall_s;
    r->progress_wall_ns = now_ns;
    snprintf(line, sizeof line, "%.1f of %.0f s simulated, %.1f x real time, %.0f s to go", time_s,
             r->experiment->duration, factor, (r->experiment->duration - time_s) / factor);
    fprintf(stderr, "\r\033[K%.*s", progress_room(), line);
}

void run_progress_clear(const struct run *r)
{
    if (progress_is_wanted(r)) {
        fputs("\r\033[K", stderr);
    }
}

void run_broken_tell(const struct run *r)
{
    char recording[PATH_MAX + 16];
    snprintf(recording, sizeof recording, "%s/run.mcap", r->folder);
    if (r->begun && !r->options.quiet && access(recording, F_OK) == 0) {
        fprintf(stderr,
                "muster run: broke off at %.1f of %.0f s; a report as far as it goes: "
                "muster report %s\n",
                (double)r->time_ns * 1e-9, r->experiment->duration, r->folder);
    }
}
