/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prints the sensors of each robot of a run, by the library alone, as soon as it sees the Scene:
 *   mounts_printer DOMAIN
 *   ROBOT SENSOR X_M Y_M HEADING_RAD FOV_RAD RANGE_M BEAMS
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

static mu_watch *watch;

static void mounts_print(const char *robot, const char *sensor, const struct mu_mount *mounts,
                         size_t count)
{
    for (size_t i = 0; mounts && i < count; i++) {
        const struct mu_mount *m = &mounts[i];
        printf("%s %s %.9g %.9g %.9g %.9g %.9g %u\n", robot, sensor, m->x_m, m->y_m, m->heading_rad,
               m->fov_rad, m->range_m, m->beams);
    }
}

static void on_scene(void *self, const struct mu_scene *scene)
{
    (void)self;
    for (size_t i = 0; i < scene->robot_count; i++) {
        const struct mu_figure *f = &scene->robots[i];
        mounts_print(f->name, "sonar", f->sonars, f->sonar_count);
        mounts_print(f->name, "laser", f->laser, 1);
        mounts_print(f->name, "camera", f->camera, 1);
        mounts_print(f->name, "fiducials", f->fiducial_finder, 1);
    }
    mu_watch_stop(watch);
}

int main(int argc, char **argv)
{
    struct mu_watch_options options = {.domain = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 0,
                                       .handlers = {.on_scene = on_scene}};
    mu_result done = mu_watch_open(&watch, NULL, &options);
    if (done == MU_OK) {
        done = mu_watch_run(watch);
    }
    mu_watch_close(watch);
    return done == MU_OK ? 0 : 1;
}
