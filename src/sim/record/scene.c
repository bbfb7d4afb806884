/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "muster/memory.h"
#include "world/model/world.h"

#include <stdio.h>
#include <string.h>

enum { COLOR_TEXT = 8 };

/* A sample is only read, so this cast is safe. */
static char *scene_text(const char *text)
{
    return (char *)(uintptr_t)text;
}

/* @param corners_m  room for OUTLINE_NUMBERS_MAX numbers */
static muster_Outline outline_of(const struct world_shape *shape, const struct world_pose *pose,
                                 float *corners_m)
{
    bool disc = shape->kind == WORLD_DISC;
    muster_Outline o = {.rgb = shape->look.rgb,
                        .flat = outline_is_flat(shape),
                        .radius_m = disc ? shape->radius_m : 0};
    o.corners_m._buffer = corners_m;
    o.corners_m._length = o.corners_m._maximum = (uint32_t)outline_write(shape, pose, corners_m);
    return o;
}

static void scene_walls(muster_Scene *scene, const struct world *world)
{
    float *corners_m = mu_startup_array(world->shape_count, OUTLINE_NUMBERS_MAX * sizeof(float));
    scene->walls._buffer = mu_startup_array(world->shape_count, sizeof(muster_Outline));
    scene->walls._length = scene->walls._maximum = (uint32_t)world->shape_count;
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_shape *shape = &world->shapes[i];
        scene->walls._buffer[i] =
            outline_of(shape, &shape->pose, corners_m + i * OUTLINE_NUMBERS_MAX);
    }
}

static muster_Mount mount_of(const struct world_pose *pose, double fov_rad, double range_m,
                             uint32_t beams)
{
    return (muster_Mount){.x_m = pose->x_m,
                          .y_m = pose->y_m,
                          .heading_rad = pose->heading_rad,
                          .fov_rad = fov_rad,
                          .range_m = range_m,
                          .beams = beams};
}

static dds_sequence_muster_Mount mount_list(muster_Mount *mounts, uint32_t count)
{
    return (dds_sequence_muster_Mount){._buffer = mounts, ._length = count, ._maximum = count};
}

static void figure_sensors(muster_Figure *figure, const struct world_robot *robot)
{
    enum { OTHERS = 3 }; /* laser, camera, fiducial finder */
    muster_Mount *mounts = mu_startup_array(robot->sonar_count + OTHERS, sizeof *mounts);
    for (size_t i = 0; i < robot->sonar_count; i++) {
        const struct world_sonar *s = &robot->sonars[i];
        mounts[i] = mount_of(&s->pose, s->fov_rad, s->range_max_m, 1);
    }
    figure->sonars = mount_list(mounts, (uint32_t)robot->sonar_count);
    mounts += robot->sonar_count;
    const struct world_laser *l = &robot->laser;
    mounts[0] = mount_of(&l->pose, l->fov_rad, l->range_max_m, l->samples);
    figure->lasers = mount_list(&mounts[0], l->samples > 0);
    const struct world_camera *c = &robot->camera;
    mounts[1] = mount_of(&c->pose, c->fov_rad, c->range_m, c->columns);
    figure->cameras = mount_list(&mounts[1], c->columns > 0);
    const struct world_fiducial_finder *f = &robot->finder;
    mounts[2] = mount_of(&f->pose, f->fov_rad, f->range_max_m, 1);
    figure->fiducial_finders = mount_list(&mounts[2], f->range_max_m > 0);
}

static muster_Figure figure_of_robot(const struct world_robot *robot)
{
    const struct world_pose middle = {robot->origin_x_m, robot->origin_y_m, 0};
    const struct world_shape box = {.kind = WORLD_BOX,
                                    .half_x_m = robot->length_m / 2,
                                    .half_y_m = robot->width_m / 2,
                                    .look = robot->look};
    float *corners_m = mu_startup_array(OUTLINE_NUMBERS_MAX, sizeof *corners_m);
    muster_Figure figure = {.name = scene_text(robot->name),
                            .color = scene_text(robot->color),
                            .shape = outline_of(&box, &middle, corners_m),
                            .x_m = robot->pose.x_m,
                            .y_m = robot->pose.y_m,
                            .heading_rad = robot->pose.heading_rad,
                            .controlled = true};
    figure_sensors(&figure, robot);
    return figure;
}

static muster_Figure figure_of_object(const struct world_object *object)
{
    const struct world_pose middle = {0};
    const struct world_shape *shape = &object->shape;
    float *corners_m = mu_startup_array(OUTLINE_NUMBERS_MAX, sizeof *corners_m);
    char *color = mu_startup_alloc(COLOR_TEXT);
    snprintf(color, COLOR_TEXT, "#%06x", (unsigned)(shape->look.rgb & 0xffffff));
    return (muster_Figure){.name = scene_text(object->name),
                           .color = color,
                           .shape = outline_of(shape, &middle, corners_m),
                           .x_m = shape->pose.x_m,
                           .y_m = shape->pose.y_m,
                           .heading_rad = shape->pose.heading_rad};
}

static void scene_figures(muster_Scene *scene, const struct world *world)
{
    scene->robots._buffer = mu_startup_array(world->robot_count, sizeof(muster_Figure));
    scene->robots._length = scene->robots._maximum = (uint32_t)world->robot_count;
    for (size_t i = 0; i < world->robot_count; i++) {
        scene->robots._buffer[i] = figure_of_robot(&world->robots[i]);
    }
    scene->objects._buffer = mu_startup_array(world->object_count, sizeof(muster_Figure));
    scene->objects._length = scene->objects._maximum = (uint32_t)world->object_count;
    for (size_t i = 0; i < world->object_count; i++) {
        scene->objects._buffer[i] = figure_of_object(&world->objects[i]);
    }
}

muster_Scene *scene_make(const struct world *world)
{
    muster_Scene *scene = mu_startup_alloc(sizeof *scene);
    const char *slash = strrchr(world->file, '/');
    *scene = (muster_Scene){.world = scene_text(slash ? slash + 1 : world->file),
                            .min_x_m = world->min_x_m,
                            .min_y_m = world->min_y_m,
                            .max_x_m = world->max_x_m,
                            .max_y_m = world->max_y_m};
    scene_walls(scene, world);
    scene_figures(scene, world);
    return scene;
}
