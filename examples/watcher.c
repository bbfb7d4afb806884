/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A transparent monitor: reads a run's topics, and says who stalls, who came near whom, and what it
 * amounts to in the end: watcher [DOMAIN]
 *
 * It sends nothing.  With it and without it a run has the same hash.
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

static const double CLOSE_M = 0.6;

static struct {
    mu_stats *stats;
    uint32_t stalls[MU_ROBOTS_MAX];
} seen;

static void on_scene(void *self, const struct mu_scene *scene)
{
    (void)self;
    printf("%s: %zu robots, seed %llu\n", scene->world, scene->robot_count,
           (unsigned long long)scene->seed);
    mu_stats_begin(seen.stats, scene);
}

static void on_step(void *self, const struct mu_frame *frame)
{
    (void)self;
    mu_stats_take(seen.stats, frame);
    for (size_t i = 0; i < frame->robot_count; i++) {
        const struct mu_robot_view *robot = &frame->robots[i];
        if (robot->stalls > seen.stalls[i]) {
            printf("%.1f s: %s is stalled\n", (double)frame->time_ns / 1e9, robot->name);
        }
        seen.stalls[i] = robot->stalls;
    }
}

static void on_end(void *self, const struct mu_run_result *result)
{
    struct mu_stats_team team = mu_stats_team(seen.stats);
    struct mu_stats_pair pair;
    for (size_t i = 0; mu_stats_pair(seen.stats, i, &pair); i++) {
        if (pair.near_m < CLOSE_M) {
            printf("%s and %s came as near as %.2f m\n", mu_stats_robot(seen.stats, pair.one)->name,
                   mu_stats_robot(seen.stats, pair.other)->name, pair.near_m);
        }
    }
    printf("%.2f m in %.1f s, %.1f %% of the floor, most efficient: %s\n", team.distance_m,
           team.time_s, team.explored * 100, team.most_efficient ? team.most_efficient : "nobody");
    printf("hash %s, %llu steps missed %s\n", result->hash, (unsigned long long)team.missed,
           result->reason);
    mu_watch_stop(*(mu_watch **)self);
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    mu_watch *watch = NULL;
    struct mu_watch_options options = {
        .domain = domain ? (int)strtol(domain, NULL, 10) : 0,
        .handlers = {.self = &watch, .on_scene = on_scene, .on_step = on_step, .on_end = on_end}};
    seen.stats = mu_stats_open();
    if (mu_watch_open(&watch, NULL, &options) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_result ran = mu_watch_run(watch);
    mu_watch_close(watch);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
