/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/models.h"

void fiducials_init(struct fiducials *finder, const struct world_fiducial_finder *from)
{
    *finder = (struct fiducials){.place = frame_of(from->pose),
                                 .range_min_m = from->range_min_m,
                                 .range_max_m = from->range_max_m,
                                 .range_id_m = from->range_id_m,
                                 .half_fov_rad = from->fov_rad / 2};
}

double fiducials_reach(const struct fiducials *finder)
{
    return finder->range_max_m > 0 ? finder->range_max_m + hypot(finder->place.x, finder->place.y)
                                   : 0;
}

/* A mark on the floor exists for finders alone: it stops no ray and hides nothing. */
static bool fiducials_is_mark(const struct solid *bearer)
{
    return bearer->returns == 0 && !bearer->away;
}

/* @return whether nothing hides the bearer */
static bool fiducials_free(const struct sensing *at, const struct frame *eye,
                           const struct solid *bearer, double range)
{
    const double from[2] = {eye->x, eye->y};
    const double along[2] = {(bearer->x - eye->x) / range, (bearer->y - eye->y) / range};
    const struct solid *hit;
    struct grid_eye sees = {at->self, SOLID_ALL};
    (void)grid_find(at->grid, sees, from, along, range, &hit);
    return hit ? hit == bearer || (hit->owner != SOLID_NOBODY && hit->owner == bearer->owner)
               : fiducials_is_mark(bearer);
}

/* Measures a bearer.  @return whether the finder sees it */
static bool fiducials_look(const struct fiducials *finder, const struct sensing *at,
                           const struct frame *eye, const struct solid *bearer,
                           struct mu_fiducial *out)
{
    double gx = bearer->x - eye->x;
    double gy = bearer->y - eye->y;
    double range = sqrt(gx * gx + gy * gy);
    if (range > finder->range_max_m || range < finder->range_min_m || range <= 0) {
        return false;
    }
    double bearing = atan2(eye->c * gy - eye->s * gx, eye->c * gx + eye->s * gy);
    if (fabs(bearing) > finder->half_fov_rad || !fiducials_free(at, eye, bearer, range)) {
        return false;
    }
    double c = eye->c * bearer->c + eye->s * bearer->s;
    double s = eye->c * bearer->s - eye->s * bearer->c;
    *out = (struct mu_fiducial){.number = range <= finder->range_id_m ? bearer->look.fiducial : 0,
                                .bearing_rad = bearing,
                                .range_m = range,
                                .heading_rad = atan2(s, c)};
    return true;
}

/* Inserts a fiducial by its range.  In a full list the farthest one is dropped. */
static size_t fiducials_rank(struct mu_fiducial found[], size_t count,
                             const struct mu_fiducial *one)
{
    if (count == MU_FIDUCIALS_MAX && !(one->range_m < found[count - 1].range_m)) {
        return count;
    }
    size_t at = count < MU_FIDUCIALS_MAX ? count++ : count - 1;
    while (at > 0 && one->range_m < found[at - 1].range_m) {
        found[at] = found[at - 1];
        at--;
    }
    found[at] = *one;
    return count;
}

size_t fiducials_read(const struct fiducials *finder, const struct sensing *at,
                      struct mu_fiducial found[])
{
    struct frame eye = frame_join(&at->robot, &finder->place);
    size_t count = 0;
    for (size_t k = 0; k < at->near.solids.count; k++) {
        const struct solid *bearer = gather_solid(at->gather, at->near.solids.id[k]);
        struct mu_fiducial one;
        if (bearer->look.fiducial != 0 && fiducials_look(finder, at, &eye, bearer, &one)) {
            count = fiducials_rank(found, count, &one);
        }
    }
    return count;
}
