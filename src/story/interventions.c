/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include "core/sensors.h"

#include <string.h>

static const double push_shows_s = 1; /* as long as a body may roll on */

void interventions_add(struct interventions *h, uint32_t step, const muster_RunCommand *order)
{
    if (order->order != muster_RUN_PLACE && order->order != muster_RUN_PUSH &&
        order->order != muster_RUN_RESET && order->order != muster_RUN_SENSOR) {
        return;
    }
    struct intervention *one = &h->at[h->count++ % INTERVENTIONS_MAX];
    *one = (struct intervention){.step = step,
                                 .order = order->order,
                                 .x_m = order->x_m,
                                 .y_m = order->y_m,
                                 .force_x_n = order->force_x_n,
                                 .force_y_n = order->force_y_n,
                                 .torque_nm = order->torque_nm,
                                 .time_s = order->time_s,
                                 .senses = order->senses,
                                 .on = order->on};
    mu_text_copy(one->robot, sizeof one->robot, order->name);
    mu_text_copy(one->source, sizeof one->source, order->source);
}

static void intervention_add(const struct intervention *h, uint32_t senses, struct mu_text *out)
{
    if (h->order == muster_RUN_PLACE) {
        mu_text_format(out, "placed at (%.2f, %.2f) m", h->x_m, h->y_m);
    } else if (h->order == muster_RUN_RESET) {
        mu_text_add(out, "put back to where it began");
    } else if (h->order == muster_RUN_SENSOR) {
        mu_sensor_add(out, senses);
        mu_text_add(out, " switched off");
    } else if (h->time_s > 0) {
        mu_text_format(out, "pushed with (%g, %g) N and %g N m for %g s", h->force_x_n,
                       h->force_y_n, h->torque_nm, h->time_s);
    } else {
        mu_text_format(out, "pushed with an impulse of (%g, %g) N s and %g N m s", h->force_x_n,
                       h->force_y_n, h->torque_nm);
    }
    mu_text_add(out, " by ");
    mu_text_add_plain(out, h->source, strlen(h->source));
}

/* What an older order switched that a later one switched again does not count: decided has it. */
static uint32_t senses_off(const struct intervention *h, uint32_t *decided)
{
    uint32_t senses = h->senses & ~*decided;
    *decided |= senses;
    return h->on ? 0 : senses;
}

static bool intervention_shows(const struct intervention *h, const struct interventions_asked *on)
{
    double ago_s = (on->step - h->step) * on->step_s;
    return h->step >= on->since ||
           (h->order == muster_RUN_PUSH && ago_s <= h->time_s + push_shows_s);
}

size_t interventions_tell(const struct interventions *h, const struct interventions_asked *on,
                          const char *before, struct mu_text *out)
{
    uint32_t decided = 0;
    size_t lines = 0, first = h->count > INTERVENTIONS_MAX ? h->count - INTERVENTIONS_MAX : 0;
    for (size_t i = h->count; i-- > first;) {
        const struct intervention *one = &h->at[i % INTERVENTIONS_MAX];
        if (one->step >= on->step || (one->robot[0] && strcmp(one->robot, on->robot) != 0)) {
            continue;
        }
        bool sensor = one->order == muster_RUN_SENSOR;
        uint32_t off = sensor ? senses_off(one, &decided) : 0;
        if (sensor ? on->sensed && off : intervention_shows(one, on)) {
            mu_text_add(out, before);
            intervention_add(one, off, out);
            mu_text_format(out, ", at %.1f s\n", (one->step + 1) * on->step_s);
            lines++;
        }
    }
    return lines;
}
