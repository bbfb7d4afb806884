/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/devices/devices.h"

/* Positions of the light beams, as shares of a paddle's length from its root. */
#define GRIPPER_OUTER_AT 0.9
#define GRIPPER_INNER_AT 0.3
#define GRIPPER_BEAM_M   0.001

void gripper_init(struct gripper *gripper, const struct world_robot *robot)
{
    const struct world_gripper *make = &robot->gripper;
    *gripper = (struct gripper){.make = make->length_m > 0 ? make : NULL,
                                .closes = make->starts_closed,
                                .lifts = make->starts_lifted,
                                .closed = make->starts_closed ? 1 : 0,
                                .lifted = make->starts_lifted ? 1 : 0,
                                .holds = GRIPPER_NOTHING,
                                .c = cos(make->pose.heading_rad),
                                .s = sin(make->pose.heading_rad)};
}

bool gripper_is_up(const struct gripper *gripper)
{
    return gripper->lifted >= 1;
}

static double gripper_move(double now, bool wanted, double dt_s)
{
    double share = dt_s / GRIPPER_TIME_S;
    double next = wanted ? now + share : now - share;
    /* Sums of steps are not exact: the last step ends the motion. */
    return next > 1 - share / 2 ? 1 : next < share / 2 ? 0 : next;
}

double gripper_next_closed(const struct gripper *gripper, double dt_s)
{
    return gripper_move(gripper->closed, gripper->closes, dt_s);
}

double gripper_next_lifted(const struct gripper *gripper, double dt_s)
{
    return gripper_move(gripper->lifted, gripper->lifts, dt_s);
}

/* @return the distance from the middle to the inner side of a paddle */
static double gripper_half_gap(const struct gripper *gripper, double closed)
{
    const struct world_gripper *make = gripper->make;
    return fmax(0, make->width_m / 2 - make->paddle_width_m) * (1 - closed);
}

/* @return a box in the frame of the case, parallel to the case */
static struct solid gripper_box(const struct gripper *g, const struct frame *frame,
                                const double at[2], const double half[2])
{
    double x = g->make->pose.x_m + g->c * at[0] - g->s * at[1];
    double y = g->make->pose.y_m + g->s * at[0] + g->c * at[1];
    return (struct solid){.kind = WORLD_BOX,
                          .returns = SOLID_STOPS, /* too low for the sensors */
                          .owner = SOLID_NOBODY,
                          .x = frame->x + frame->c * x - frame->s * y,
                          .y = frame->y + frame->s * x + frame->c * y,
                          .c = frame->c * g->c - frame->s * g->s,
                          .s = frame->s * g->c + frame->c * g->s,
                          .half_x = half[0],
                          .half_y = half[1],
                          .reach = sqrt(half[0] * half[0] + half[1] * half[1])};
}

struct solid gripper_paddle(const struct gripper *gripper, const struct frame *frame, int paddle,
                            double closed)
{
    const struct world_gripper *make = gripper->make;
    double half[2] = {make->paddle_length_m / 2, make->paddle_width_m / 2};
    double aside = gripper_half_gap(gripper, closed) + half[1];
    double at[2] = {make->length_m / 2 + half[0], paddle == 0 ? aside : -aside};
    struct solid solid = gripper_box(gripper, frame, at, half);
    solid.away = gripper_is_up(gripper);
    return solid;
}

bool gripper_beam(const struct gripper *gripper, const struct frame *frame, bool outer,
                  struct solid *beam)
{
    const struct world_gripper *make = gripper->make;
    double share = outer ? GRIPPER_OUTER_AT : GRIPPER_INNER_AT;
    double at[2] = {make->length_m / 2 + share * make->paddle_length_m, 0};
    double half[2] = {GRIPPER_BEAM_M / 2, gripper_half_gap(gripper, gripper->closed)};
    *beam = gripper_box(gripper, frame, at, half);
    return half[1] > 0;
}

bool gripper_spans(const struct gripper *gripper, const struct frame *frame, const double point[2],
                   double closed)
{
    const struct world_gripper *make = gripper->make;
    double half[2] = {make->paddle_length_m / 2, gripper_half_gap(gripper, closed)};
    double at[2] = {make->length_m / 2 + half[0], 0};
    struct solid gap = gripper_box(gripper, frame, at, half);
    double x = point[0] - gap.x;
    double y = point[1] - gap.y;
    return fabs(gap.c * x + gap.s * y) <= gap.half_x && fabs(gap.c * y - gap.s * x) <= gap.half_y;
}
