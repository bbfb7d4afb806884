/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/geometry/geometry.h"

/*
 * An axis replaces an earlier one only if it is better by this much, so that ties do not flicker.
 */
#define NARROW_TIE_M 1e-9

struct narrow_axis {
    double x, y;  /* unit vector from b to a */
    double depth; /* overlap along the axis */
    bool of_b;    /* it is a side of b, not of a */
    bool second;  /* the normal of the side is the box's y axis */
};

static double narrow_reach(const struct solid *box, double ux, double uy)
{
    return box->half_x * fabs(box->c * ux + box->s * uy) +
           box->half_y * fabs(box->c * uy - box->s * ux);
}

/* The separating axis theorem for two boxes.  @return false if an axis separates them */
static bool narrow_find_axis(const struct solid *a, const struct solid *b, struct narrow_axis *best)
{
    const struct solid *boxes[2] = {a, b};
    double dx = a->x - b->x;
    double dy = a->y - b->y;
    *best = (struct narrow_axis){.depth = INFINITY};
    for (int i = 0; i < 4; i++) {
        const struct solid *box = boxes[i / 2];
        double ux = i % 2 ? -box->s : box->c;
        double uy = i % 2 ? box->c : box->s;
        double apart = dx * ux + dy * uy;
        double depth = narrow_reach(a, ux, uy) + narrow_reach(b, ux, uy) - fabs(apart);
        if (depth < 0) {
            return false;
        }
        if (depth < best->depth - NARROW_TIE_M) {
            double sign = apart < 0 ? -1 : 1;
            *best = (struct narrow_axis){sign * ux, sign * uy, depth, i >= 2, i % 2 == 1};
        }
    }
    return true;
}

/* Writes both ends, in the world, of the side of a box that faces against a direction. */
static void narrow_facing_side(const struct solid *box, double rx, double ry, double x[2],
                               double y[2])
{
    double lx = box->c * rx + box->s * ry;
    double ly = box->c * ry - box->s * rx;
    bool end_on = fabs(lx) > fabs(ly);
    for (int k = 0; k < 2; k++) {
        double end = k ? 1 : -1;
        double ex = box->half_x * (end_on ? (lx > 0 ? -1 : 1) : end);
        double ey = box->half_y * (end_on ? end : (ly > 0 ? -1 : 1));
        x[k] = box->x + box->c * ex - box->s * ey;
        y[k] = box->y + box->s * ex + box->c * ey;
    }
}

/* Clips the incident side of one box against the reference side of the other box. */
static void narrow_boxes(const struct solid *a, const struct solid *b,
                         struct narrow_contact *contact)
{
    struct narrow_axis axis;
    if (!narrow_find_axis(a, b, &axis)) {
        return;
    }
    contact->normal_x = axis.x;
    contact->normal_y = axis.y;
    const struct solid *reference = axis.of_b ? b : a;
    double rx = axis.of_b ? axis.x : -axis.x; /* points out of the reference side */
    double ry = axis.of_b ? axis.y : -axis.y;
    double half_side = axis.second ? reference->half_x : reference->half_y;
    double half_deep = axis.second ? reference->half_y : reference->half_x;
    double x[2];
    double y[2];
    narrow_facing_side(axis.of_b ? a : b, rx, ry, x, y);
    double t[2];
    for (int k = 0; k < 2; k++) {
        t[k] = (y[k] - reference->y) * rx - (x[k] - reference->x) * ry;
    }
    for (int k = 0; k < 2; k++) {
        double inside = t[k] < -half_side ? -half_side : t[k] > half_side ? half_side : t[k];
        double along = 0;
        if (inside != t[k]) {
            double side = t[1 - k] - t[k];
            along = side != 0 ? (inside - t[k]) / side : 0;
            if (along < 0 || along > 1) {
                continue;
            }
        }
        double px = x[k] + along * (x[1 - k] - x[k]);
        double py = y[k] + along * (y[1 - k] - y[k]);
        double depth = half_deep - ((px - reference->x) * rx + (py - reference->y) * ry);
        if (depth >= 0) {
            contact->points[contact->count].x = px;
            contact->points[contact->count].y = py;
            contact->points[contact->count++].depth = depth;
        }
    }
}

static double narrow_clip(double value, double half)
{
    return value < -half ? -half : value > half ? half : value;
}

/* Box a, disc b: finds the point of the box nearest to the middle of the disc. */
static void narrow_box_disc(const struct solid *a, const struct solid *b,
                            struct narrow_contact *contact)
{
    double dx = b->x - a->x;
    double dy = b->y - a->y;
    double lx = a->c * dx + a->s * dy;
    double ly = a->c * dy - a->s * dx;
    double qx = narrow_clip(lx, a->half_x);
    double qy = narrow_clip(ly, a->half_y);
    double nx = lx - qx;
    double ny = ly - qy;
    double apart = sqrt(nx * nx + ny * ny);
    double depth = b->half_x - apart;
    if (depth < 0) {
        return;
    }
    if (apart > 1e-9) {
        nx /= apart;
        ny /= apart;
    } else { /* the middle lies inside the box: leave through the nearest side */
        double px = a->half_x - fabs(lx);
        double py = a->half_y - fabs(ly);
        bool by_x = px < py;
        nx = by_x ? (lx < 0 ? -1 : 1) : 0;
        ny = by_x ? 0 : (ly < 0 ? -1 : 1);
        qx = by_x ? nx * a->half_x : qx;
        qy = by_x ? qy : ny * a->half_y;
        depth = b->half_x + (by_x ? px : py);
    }
    contact->normal_x = -(a->c * nx - a->s * ny);
    contact->normal_y = -(a->s * nx + a->c * ny);
    contact->points[0].x = a->x + a->c * qx - a->s * qy;
    contact->points[0].y = a->y + a->s * qx + a->c * qy;
    contact->points[0].depth = depth;
    contact->count = 1;
}

static void narrow_discs(const struct solid *a, const struct solid *b,
                         struct narrow_contact *contact)
{
    double dx = a->x - b->x;
    double dy = a->y - b->y;
    double apart = sqrt(dx * dx + dy * dy);
    double depth = a->half_x + b->half_x - apart;
    if (depth < 0) {
        return;
    }
    contact->normal_x = apart > 1e-9 ? dx / apart : 1;
    contact->normal_y = apart > 1e-9 ? dy / apart : 0;
    contact->points[0].x = b->x + contact->normal_x * (b->half_x - depth / 2);
    contact->points[0].y = b->y + contact->normal_y * (b->half_x - depth / 2);
    contact->points[0].depth = depth;
    contact->count = 1;
}

void narrow_collide(const struct solid *a, const struct solid *b, struct narrow_contact *contact)
{
    double dx = a->x - b->x;
    double dy = a->y - b->y;
    double reach = a->reach + b->reach;
    contact->count = 0;
    if (dx * dx + dy * dy > reach * reach) {
        return;
    }
    if (a->kind == WORLD_BOX && b->kind == WORLD_BOX) {
        narrow_boxes(a, b, contact);
    } else if (a->kind == WORLD_BOX) {
        narrow_box_disc(a, b, contact);
    } else if (b->kind == WORLD_BOX) {
        narrow_box_disc(b, a, contact);
        contact->normal_x = -contact->normal_x;
        contact->normal_y = -contact->normal_y;
    } else {
        narrow_discs(a, b, contact);
    }
}
