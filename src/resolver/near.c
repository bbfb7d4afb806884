/* SPDX-License-Identifier: Apache-2.0 */
#include "core/log.h"
#include "core/name.h"
#include "core/text.h"
#include "resolver/scheme.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The world as the last control step found it. */
static struct {
    char name[MU_NAME_MAX + 1];
    double x_m, y_m;
} near_bodies[MU_ROBOTS_MAX];
static size_t near_count;

static void near_see(const struct mu_percept *bodies, size_t count)
{
    near_count = 0;
    for (size_t i = 0; i < count && near_count < MU_ROBOTS_MAX; i++) {
        if (mu_name_valid(bodies[i].robot)) {
            mu_text_copy(near_bodies[near_count].name, sizeof near_bodies[0].name, bodies[i].robot);
            near_bodies[near_count].x_m = bodies[i].x_m;
            near_bodies[near_count++].y_m = bodies[i].y_m;
        }
    }
}

/* @return whether the text is a distance and nothing else */
static bool near_distance(const char *text, double *distance_m)
{
    char *end;
    *distance_m = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*distance_m) && *distance_m >= 0.0;
}

static size_t near_find(const char *name)
{
    size_t i = 0;
    while (i < near_count && strcmp(near_bodies[i].name, name) != 0) {
        i++;
    }
    return i;
}

static bool near_resolve(void *self, mu_agent *a, const char *rest, const char *sender,
                         mu_resolution *r)
{
    (void)self;
    (void)a;
    double most_m;
    size_t me = near_find(sender);
    if (me == near_count || !near_distance(rest, &most_m)) {
        return false; /* an agent without a body is near none */
    }
    for (size_t i = 0; i < near_count; i++) {
        double x_m = near_bodies[i].x_m - near_bodies[me].x_m;
        double y_m = near_bodies[i].y_m - near_bodies[me].y_m;
        if (i == me || x_m * x_m + y_m * y_m > most_m * most_m) {
            continue;
        }
        if (mu_resolution_add(r, near_bodies[i].name) == MU_FULL) {
            mu_log(MU_LOG_WARNING, "too-many", "near=%s from=%s", rest, sender);
            break;
        }
    }
    return true;
}

const struct scheme near_scheme = {.name = MU_SCHEME_NEAR,
                                   .means = "robots at most REST metres from the sender",
                                   .resolve = near_resolve,
                                   .see = near_see};
