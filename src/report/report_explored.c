/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The explored fraction.  The world is divided into 0.5 m cells, each of them into finer ones that
 * are solid where a shape touches them.  A flood from wherever a robot has been finds the floor
 * that robots can reach, so that what lies outside the walls does not count; a cell is floor when
 * at least half of it is reached, or when a robot was there.
 */
#include "muster/memory.h"
#include "report/report_data.h"

#include <math.h>

#define EXPLORED_CELL_M 0.5

enum { EXPLORED_FINE = 10, EXPLORED_FINE_MAX = 1 << 24 };

enum explored_state { EXPLORED_FREE, EXPLORED_SOLID, EXPLORED_REACHED };

struct report_explored {
    double min_x_m, min_y_m, fine_m;
    int width, height; /* in fine cells; both multiples of the division */
    int division;      /* fine cells along a cell */
    unsigned char *state;
    unsigned char *crossed; /* of each 0.5 m cell */
    int *stack;             /* of the flood */
    int stack_count;
};

static int explored_clamp(double value, int max)
{
    return value < 0 ? 0 : value > max ? max : (int)value;
}

/* Whether a shape covers a point, or comes as near as a fine cell's half. */
static bool explored_covers(const struct world_shape *shape, double x_m, double y_m, double near_m)
{
    double dx = x_m - shape->pose.x_m, dy = y_m - shape->pose.y_m;
    if (shape->kind == WORLD_DISC) {
        return hypot(dx, dy) <= shape->radius_m + near_m;
    }
    double c = cos(shape->pose.heading_rad), s = sin(shape->pose.heading_rad);
    return fabs(c * dx + s * dy) <= shape->half_x_m + near_m &&
           fabs(c * dy - s * dx) <= shape->half_y_m + near_m;
}

static void explored_add_shape(struct report_explored *e, const struct world_shape *shape)
{
    double reach_m =
        shape->kind == WORLD_DISC ? shape->radius_m : hypot(shape->half_x_m, shape->half_y_m);
    double x = (shape->pose.x_m - e->min_x_m) / e->fine_m;
    double y = (shape->pose.y_m - e->min_y_m) / e->fine_m;
    double reach = reach_m / e->fine_m + 1;
    int x1 = explored_clamp(x + reach, e->width - 1), y1 = explored_clamp(y + reach, e->height - 1);
    for (int iy = explored_clamp(y - reach, e->height - 1); iy <= y1; iy++) {
        for (int ix = explored_clamp(x - reach, e->width - 1); ix <= x1; ix++) {
            double centre_x_m = e->min_x_m + (ix + 0.5) * e->fine_m;
            double centre_y_m = e->min_y_m + (iy + 0.5) * e->fine_m;
            if (explored_covers(shape, centre_x_m, centre_y_m, e->fine_m / 2)) {
                e->state[iy * e->width + ix] = EXPLORED_SOLID;
            }
        }
    }
}

struct report_explored *report_explored_open(const struct world *world)
{
    double cells_x = ceil((world->max_x_m - world->min_x_m) / EXPLORED_CELL_M);
    double cells_y = ceil((world->max_y_m - world->min_y_m) / EXPLORED_CELL_M);
    if (!(cells_x >= 1 && cells_y >= 1 && cells_x * cells_y <= EXPLORED_FINE_MAX)) {
        return NULL;
    }
    int division = EXPLORED_FINE;
    while (division > 1 && cells_x * cells_y * division * division > EXPLORED_FINE_MAX) {
        division--;
    }
    struct report_explored *e = mu_startup_alloc(sizeof *e);
    e->min_x_m = world->min_x_m;
    e->min_y_m = world->min_y_m;
    e->division = division;
    e->fine_m = EXPLORED_CELL_M / division;
    e->width = (int)cells_x * division;
    e->height = (int)cells_y * division;
    size_t fine = (size_t)e->width * (size_t)e->height;
    e->state = mu_startup_array(fine, sizeof *e->state);
    e->stack = mu_startup_array(fine, sizeof *e->stack);
    e->crossed = mu_startup_array((size_t)cells_x * (size_t)cells_y, sizeof *e->crossed);
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_look *look = &world->shapes[i].look;
        if (look->stops || look->echoes) { /* a mark on the floor can be driven over */
            explored_add_shape(e, &world->shapes[i]);
        }
    }
    return e;
}

static void explored_reach(struct report_explored *e, int x, int y)
{
    int at = y * e->width + x;
    if (e->state[at] == EXPLORED_FREE) {
        e->state[at] = EXPLORED_REACHED;
        e->stack[e->stack_count++] = at;
    }
}

static void explored_visit(struct report_explored *e, double x_m, double y_m)
{
    double x = floor((x_m - e->min_x_m) / e->fine_m), y = floor((y_m - e->min_y_m) / e->fine_m);
    if (!(x >= 0 && y >= 0 && x < e->width && y < e->height)) {
        return;
    }
    int ix = (int)x, iy = (int)y;
    e->crossed[iy / e->division * (e->width / e->division) + ix / e->division] = 1;
    explored_reach(e, ix, iy);
}

void report_explored_cross(struct report_explored *e, double x0_m, double y0_m, double x1_m,
                           double y1_m)
{
    if (!e) {
        return;
    }
    double length_m = hypot(x1_m - x0_m, y1_m - y0_m);
    int parts = 1 + explored_clamp(length_m / (EXPLORED_CELL_M / 4), 1000);
    for (int i = 1; i <= parts; i++) {
        double t = (double)i / parts;
        explored_visit(e, x0_m + t * (x1_m - x0_m), y0_m + t * (y1_m - y0_m));
    }
}

static void explored_flood(struct report_explored *e)
{
    while (e->stack_count > 0) {
        int at = e->stack[--e->stack_count];
        int x = at % e->width, y = at / e->width;
        if (x > 0) {
            explored_reach(e, x - 1, y);
        }
        if (x + 1 < e->width) {
            explored_reach(e, x + 1, y);
        }
        if (y > 0) {
            explored_reach(e, x, y - 1);
        }
        if (y + 1 < e->height) {
            explored_reach(e, x, y + 1);
        }
    }
}

static int explored_count_reached(const struct report_explored *e, int cell_x, int cell_y)
{
    int reached = 0;
    for (int y = 0; y < e->division; y++) {
        for (int x = 0; x < e->division; x++) {
            int row = cell_y * e->division + y, column = cell_x * e->division + x;
            reached += e->state[row * e->width + column] == EXPLORED_REACHED;
        }
    }
    return reached;
}

double report_explored_fraction(struct report_explored *e)
{
    if (!e) {
        return 0;
    }
    explored_flood(e);
    int columns = e->width / e->division, rows = e->height / e->division;
    int half = (e->division * e->division + 1) / 2;
    long floor_count = 0, crossed_count = 0;
    for (int y = 0; y < rows; y++) {
        for (int x = 0; x < columns; x++) {
            bool crossed = e->crossed[y * columns + x];
            crossed_count += crossed;
            floor_count += crossed || explored_count_reached(e, x, y) >= half;
        }
    }
    return floor_count ? (double)crossed_count / (double)floor_count : 0;
}
