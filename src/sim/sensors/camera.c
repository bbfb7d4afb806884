/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/models.h"

void camera_init(struct camera *camera, const struct world_camera *from)
{
    *camera = (struct camera){
        .place = frame_of(from->pose), .range_m = from->range_m, .color_count = from->color_count};
    for (size_t k = 0; k < from->color_count; k++) {
        camera->colors[k] = from->colors[k];
    }
    double fov = from->fov_rad < 2 * M_PI ? from->fov_rad : 2 * M_PI;
    if (from->columns > 0 && fov > 0) {
        double step = fov / from->columns;
        fan_table_init(&camera->table, -fov / 2 + step / 2, step, from->columns);
    }
}

double camera_reach(const struct camera *camera)
{
    return camera->table.count ? camera->range_m + hypot(camera->place.x, camera->place.y) : 0;
}

static bool camera_looks_for(const struct camera *camera, uint32_t rgb)
{
    bool found = camera->color_count == 0;
    for (size_t k = 0; k < camera->color_count; k++) {
        found = found || camera->colors[k] == rgb;
    }
    return found;
}

/* @return the first column after a run of columns that see the same colour of the same owner */
static uint32_t camera_run(const struct camera *camera, const struct sensing *at, uint32_t first)
{
    const struct solid *seen = gather_solid(at->gather, at->hit[first]);
    uint32_t k = first + 1;
    while (k < camera->table.count && at->hit[k] != FAN_NOTHING) {
        const struct solid *next = gather_solid(at->gather, at->hit[k]);
        if (next->owner != seen->owner || next->look.rgb != seen->look.rgb) {
            break;
        }
        k++;
    }
    return k;
}

/* Inserts a blob by its range.  In a full list the farthest blob is dropped. */
static size_t camera_rank(struct mu_blob blobs[], size_t count, const struct mu_blob *blob)
{
    if (count == MU_BLOBS_MAX && !(blob->range_m < blobs[count - 1].range_m)) {
        return count;
    }
    size_t at = count < MU_BLOBS_MAX ? count++ : count - 1;
    while (at > 0 && blob->range_m < blobs[at - 1].range_m) {
        blobs[at] = blobs[at - 1];
        at--;
    }
    blobs[at] = *blob;
    return count;
}

size_t camera_read(const struct camera *camera, const struct sensing *at, struct mu_blob blobs[])
{
    struct frame from = frame_join(&at->robot, &camera->place);
    struct fan_eye eye = {from.x, from.y, from.c, from.s, camera->range_m, SOLID_SHOWS};
    const struct fan_table *table = &camera->table;
    fan_kernel()->sweep(table, &eye, &at->near.solids, at->range_m, at->hit);
    size_t count = 0;
    for (uint32_t first = 0, next; first < table->count; first = next) {
        next = first + 1;
        if (at->hit[first] == FAN_NOTHING) {
            continue;
        }
        next = camera_run(camera, at, first);
        uint32_t rgb = gather_solid(at->gather, at->hit[first])->look.rgb;
        double middle = table->first_rad + table->step_rad * (first + next - 1) / 2;
        struct mu_blob blob = {.rgb = rgb,
                               .bearing_rad = middle,
                               .width_rad = table->step_rad * (next - first),
                               .range_m = at->range_m[(first + next - 1) / 2]};
        if (camera_looks_for(camera, rgb)) {
            count = camera_rank(blobs, count, &blob);
        }
    }
    return count;
}
