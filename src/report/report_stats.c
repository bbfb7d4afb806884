/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/memory.h"
#include "muster/stats.h"
#include "report/report_data.h"
#include "stats/stats.h"
#include "world/model/world.h"

#include <math.h>
#include <string.h>

/* One robot while the rows go by. */
struct stats_robot {
    bool seen, stalled;
    bool lifted; /* it was put elsewhere since the last sample */
    double x_m, y_m, time_s;
    double first_s;
    double stall_s; /* of the stall that goes on */
};

struct stats {
    struct report_data *data;
    struct explored *explored;
    struct report_expect *expect;
    struct stats_robot *robots;
    double step_s;
    size_t step; /* number of the step, from 0 */
};

static void stats_take_stall(struct stats_robot *robot, struct report_robot_result *result,
                             bool stalled, double spent_s)
{
    if (!stalled) {
        robot->stalled = false;
        return;
    }
    if (!robot->stalled) {
        result->stalls++;
        robot->stall_s = 0;
    }
    robot->stalled = true;
    robot->stall_s += spent_s;
    result->stalled_s += spent_s;
    result->longest_stall_s = fmax(result->longest_stall_s, robot->stall_s);
}

static void stats_add_sample(struct report_data *data, const struct report_row *row, bool lifted)
{
    if (data->samples_count == REPORT_SAMPLES_MAX) {
        return;
    }
    struct report_track *track = &data->tracks[row->robot];
    int32_t index = (int32_t)data->samples_count++;
    data->samples[index] =
        (struct report_sample){(float)row->time_s,      (float)row->x_m, (float)row->y_m,
                               (float)row->heading_rad, lifted,          REPORT_NO_SAMPLE};
    if (track->last == REPORT_NO_SAMPLE) {
        track->first = index;
    } else {
        data->samples[track->last].next = index;
    }
    track->last = index;
}

static void stats_take_row(struct stats *s, const struct report_row *row)
{
    struct report_data *data = s->data;
    struct stats_robot *robot = &s->robots[row->robot];
    struct report_robot_result *result = &data->result->robots[row->robot];
    if (data->rows_count == 0) {
        data->start_s = row->time_s;
    } else if (row->time_s > data->end_s) {
        s->step++;
    }
    data->rows_count++;
    data->end_s = row->time_s;

    double spent_s = s->step_s;
    if (robot->seen) {
        spent_s = row->time_s - robot->time_s;
    } else {
        robot->first_s = row->time_s;
    }
    bool drove = robot->seen && !row->placed;
    double from_x_m = drove ? robot->x_m : row->x_m, from_y_m = drove ? robot->y_m : row->y_m;
    result->distance_m += hypot(row->x_m - from_x_m, row->y_m - from_y_m);
    explored_cross(s->explored, row->robot, from_x_m, from_y_m, row->x_m, row->y_m);
    robot->lifted = robot->lifted || row->placed;
    stats_take_stall(robot, result, row->stalled, spent_s);
    robot->seen = true;
    robot->time_s = row->time_s;
    robot->x_m = result->final_x_m = row->x_m;
    robot->y_m = result->final_y_m = row->y_m;
    result->final_heading_rad = row->heading_rad;
    if (s->step % data->stride == 0) {
        stats_add_sample(data, row, robot->lifted);
        robot->lifted = false;
    }
    report_expect_row(s->expect, row);
}

static void stats_finish(struct stats *s)
{
    const struct report_input *input = s->data->input;
    struct report_result *result = s->data->result;
    double best_m_s = 0;
    for (size_t i = 0; i < input->robots_count; i++) {
        struct report_robot_result *robot = &result->robots[i];
        double time_s = s->robots[i].time_s - s->robots[i].first_s;
        robot->mean_speed_m_s = time_s > 0 ? robot->distance_m / time_s : 0;
        double efficiency_m_s =
            mu_stats_efficiency(robot->distance_m, time_s, robot->stalled_s, s->step_s);
        if (efficiency_m_s > best_m_s) {
            best_m_s = efficiency_m_s;
            result->most_efficient = input->robots[i].name;
            result->efficiency_m_s = best_m_s;
        }
    }
    result->explored_fraction = fmax(explored_share(s->explored), 0);
    report_expect_close(s->expect, s->data);
}

/* The same outlines as observers are told, so that they find the same floor. */
static struct explored *floor_open(const struct world *world, size_t robots)
{
    float *corners_m = mu_startup_array(world->shape_count, OUTLINE_NUMBERS_MAX * sizeof(float));
    struct mu_outline *walls = mu_startup_array(world->shape_count, sizeof *walls);
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_shape *shape = &world->shapes[i];
        float *corners = corners_m + i * OUTLINE_NUMBERS_MAX;
        size_t numbers = outline_write(shape, &shape->pose, corners);
        walls[i] = (struct mu_outline){.flat = outline_is_flat(shape),
                                       .radius_m = shape->kind == WORLD_DISC ? shape->radius_m : 0,
                                       .corner_count = numbers / 2,
                                       .corners_m = corners};
    }
    const struct mu_scene scene = {.min_x_m = world->min_x_m,
                                   .min_y_m = world->min_y_m,
                                   .max_x_m = world->max_x_m,
                                   .max_y_m = world->max_y_m,
                                   .robot_count = robots,
                                   .wall_count = world->shape_count,
                                   .walls = walls};
    struct explored *e = explored_reserve(robots);
    (void)explored_begin(e, &scene); /* of a world without a size nothing is explored */
    return e;
}

static void stats_init(struct stats *s, size_t rows_max)
{
    struct report_data *data = s->data;
    const struct report_input *input = data->input;
    size_t samples = rows_max < REPORT_SAMPLES_MAX ? rows_max : REPORT_SAMPLES_MAX;
    data->samples = mu_startup_array(samples, sizeof *data->samples);
    data->stride = rows_max / REPORT_SAMPLES_MAX + 1;
    data->tracks = mu_startup_array(input->robots_count, sizeof *data->tracks);
    for (size_t i = 0; i < input->robots_count; i++) {
        data->tracks[i] = (struct report_track){REPORT_NO_SAMPLE, REPORT_NO_SAMPLE};
    }
    s->robots = mu_startup_array(input->robots_count, sizeof *s->robots);
    s->step_s = input->experiment->step_ms / 1e3;
    s->explored = floor_open(input->world, input->robots_count);
    s->expect = report_expect_open(input);
}

mu_result report_stats(struct report_data *data, const char *folder, struct mu_fault *fault)
{
    struct report_reader reader;
    struct report_row row;
    struct stats s = {.data = data};
    size_t rows_max;
    memset(data->result, 0, sizeof *data->result);
    mu_result result = report_reader_open(&reader, folder, data->input, &rows_max, fault);
    if (result != MU_OK) {
        return result;
    }
    stats_init(&s, rows_max);
    while ((result = report_reader_next(&reader, &row, fault)) == MU_OK) {
        stats_take_row(&s, &row);
    }
    report_reader_close(&reader);
    if (result != MU_DONE) {
        return result;
    }
    MU_TRY(report_events_read(data, folder, fault));
    stats_finish(&s);
    return MU_OK;
}
