/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The kernels, for vectors of FAN_WIDTH doubles.  Each fan_*.c includes this file once, and defines
 * FAN_WIDTH and all names.
 */
#include "sim/sensors/fan.h"

#include <string.h>
#if FAN_WIDTH > 2
#include <immintrin.h>
#endif

/* Number of solids that are prepared at a time. */
enum { FAN_BATCH = 256 };

/* Margins for the error of the arc tangent: they only widen the range of beams that is tested. */
#define FAN_MARGIN_RAD   1e-5
#define FAN_MARGIN_BEAMS 1e-3

#define FAN_TURN_RAD 6.28318530717958648

typedef double vector __attribute__((vector_size(8 * FAN_WIDTH)));
typedef int64_t mask __attribute__((vector_size(8 * FAN_WIDTH)));
typedef double vector_any __attribute__((vector_size(8 * FAN_WIDTH), aligned(8), may_alias));
typedef int64_t mask_any __attribute__((vector_size(8 * FAN_WIDTH), aligned(8), may_alias));

static inline vector load(const double *from)
{
    return *(const vector_any *)from;
}

static inline void store(double *to, vector v)
{
    *(vector_any *)to = v;
}

static inline mask load_mask(const int64_t *from)
{
    return *(const mask_any *)from;
}

static inline void store_mask(int64_t *to, mask m)
{
    *(mask_any *)to = m;
}

static inline vector all(double x)
{
    return x - (vector){0};
}

static inline vector vabs(vector v)
{
    return (vector)((mask)v & INT64_MAX);
}

/*
 * Instructions that the compiler does not find by itself.  Each gives the bits of its plain form,
 * also for zeros and NaNs.
 */
#if FAN_WIDTH == 8 && defined(__AVX512F__)
static inline vector choose(mask m, vector yes, vector no)
{
    return (vector)_mm512_ternarylogic_epi64((__m512i)m, (__m512i)yes, (__m512i)no, 0xca);
}
static inline vector least(vector a, vector b)
{
    return (vector)_mm512_min_pd((__m512d)a, (__m512d)b);
}
static inline vector most(vector a, vector b)
{
    return (vector)_mm512_max_pd((__m512d)a, (__m512d)b);
}
static inline vector root(vector v)
{
    return (vector)_mm512_sqrt_pd((__m512d)v);
}
static inline bool any_within(vector v, double limit)
{
    return _mm512_cmp_pd_mask((__m512d)v, _mm512_set1_pd(limit), _CMP_LE_OQ) != 0;
}
#elif FAN_WIDTH == 4 && defined(__AVX2__)
static inline vector choose(mask m, vector yes, vector no)
{
    return (vector)_mm256_blendv_pd((__m256d)no, (__m256d)yes, (__m256d)m);
}
static inline vector least(vector a, vector b)
{
    return (vector)_mm256_min_pd((__m256d)a, (__m256d)b);
}
static inline vector most(vector a, vector b)
{
    return (vector)_mm256_max_pd((__m256d)a, (__m256d)b);
}
static inline vector root(vector v)
{
    return (vector)_mm256_sqrt_pd((__m256d)v);
}
static inline bool any_within(vector v, double limit)
{
    __m256d is = _mm256_cmp_pd((__m256d)v, _mm256_set1_pd(limit), _CMP_LE_OQ);
    return _mm256_movemask_pd(is) != 0;
}
#else
static inline vector choose(mask m, vector yes, vector no)
{
    return (vector)(((mask)yes & m) | ((mask)no & ~m));
}
static inline vector least(vector a, vector b)
{
    return choose(a < b, a, b);
}
static inline vector most(vector a, vector b)
{
    return choose(a > b, a, b);
}
static inline vector root(vector v)
{
    for (int k = 0; k < FAN_WIDTH; k++) {
        v[k] = sqrt(v[k]);
    }
    return v;
}
static inline bool any_within(vector v, double limit)
{
    int64_t any = 0;
    for (int k = 0; k < FAN_WIDTH; k++) {
        any |= v[k] <= limit;
    }
    return any != 0;
}
#endif

/* @return -1 or 1 */
static inline vector sign_of(vector v)
{
    return choose(v < 0, all(-1), all(1));
}

/* A minimax polynomial with an error of 2e-6, which FAN_MARGIN_RAD covers. */
static inline vector arc_tangent(vector y, vector x)
{
    vector ax = vabs(x);
    vector ay = vabs(y);
    vector z = least(ax, ay) / (most(ax, ay) + 1e-300);
    vector w = z * z;
    vector a =
        z * (0.99997726 +
             w * (-0.33262347 +
                  w * (0.19354346 + w * (-0.11643287 + w * (0.05265332 + w * -0.01172120)))));
    a = choose(ax < ay, 1.57079632679489662 - a, a);
    a = choose(x < 0, 3.14159265358979324 - a, a);
    return choose(y < 0, -a, a);
}

/* Solids in the scanner's frame, and the beams that can meet them. */
struct prepared {
    double x[FAN_BATCH],
        y[FAN_BATCH]; /* of a disc: its middle; of a box: the scanner in the box's frame */
    double c[FAN_BATCH], s[FAN_BATCH]; /* of a box: its heading */
    double first[FAN_BATCH], last[FAN_BATCH];
    int64_t seen[FAN_BATCH];
};

/* The directions of the right and left end of a solid, seen from the scanner. */
struct ends {
    vector right_x, right_y, left_x, left_y;
    mask around; /* the scanner is inside the solid */
};

/* Returns the two tangents of a disc with the middle (x, y).  Their lengths do not matter. */
static inline struct ends ends_of_disc(vector x, vector y, vector radius)
{
    vector free = x * x + y * y - radius * radius;
    vector along = root(most(free, all(0)));
    return (struct ends){.right_x = x * along + y * radius,
                         .right_y = y * along - x * radius,
                         .left_x = x * along - y * radius,
                         .left_y = y * along + x * radius,
                         .around = free <= 0};
}

/*
 * Returns the two corners of a box that bound its view from the scanner, which is at (x, y) in the
 * box's frame.  They are found in the quadrant with positive x and y, and mirrored.
 */
static inline struct ends ends_of_box(vector x, vector y, const vector half[2],
                                      const vector turn[2])
{
    mask beyond_x = vabs(x) > half[0];
    mask beyond_y = vabs(y) > half[1];
    vector mirror_x = sign_of(x);
    vector mirror_y = sign_of(y);
    vector ax = mirror_x * choose(beyond_x & ~beyond_y, half[0], -half[0]) - x;
    vector ay = mirror_y * half[1] - y;
    vector bx = mirror_x * half[0] - x;
    vector by = mirror_y * choose(beyond_y & ~beyond_x, half[1], -half[1]) - y;
    mask swap = mirror_x * mirror_y < 0;
    vector rx = choose(swap, bx, ax);
    vector ry = choose(swap, by, ay);
    vector lx = choose(swap, ax, bx);
    vector ly = choose(swap, ay, by);
    return (struct ends){.right_x = turn[0] * rx - turn[1] * ry,
                         .right_y = turn[1] * rx + turn[0] * ry,
                         .left_x = turn[0] * lx - turn[1] * ly,
                         .left_y = turn[1] * lx + turn[0] * ly,
                         .around = ~beyond_x & ~beyond_y};
}

static inline struct ends ends_choose(mask disc, const struct ends *a, const struct ends *b)
{
    return (struct ends){.right_x = choose(disc, a->right_x, b->right_x),
                         .right_y = choose(disc, a->right_y, b->right_y),
                         .left_x = choose(disc, a->left_x, b->left_x),
                         .left_y = choose(disc, a->left_y, b->left_y),
                         .around = (disc & a->around) | (~disc & b->around)};
}

static inline void prepare_one(const struct fan_table *table, const struct fan_eye *eye,
                               const struct gather_solids *solids, size_t at, struct prepared *to,
                               size_t k)
{
    vector gx = load(solids->x + at) - eye->x;
    vector gy = load(solids->y + at) - eye->y;
    vector c = load(solids->c + at);
    vector s = load(solids->s + at);
    vector half[2] = {load(solids->half_x + at), load(solids->half_y + at)};
    mask disc = load_mask(solids->disc + at);
    vector fx = eye->c * gx + eye->s * gy;
    vector fy = eye->c * gy - eye->s * gx;
    vector turn[2] = {c * eye->c + s * eye->s, s * eye->c - c * eye->s};
    vector lx = -(turn[0] * fx + turn[1] * fy);
    vector ly = -(turn[0] * fy - turn[1] * fx);
    struct ends of_disc = ends_of_disc(fx, fy, half[0]);
    struct ends of_box = ends_of_box(lx, ly, half, turn);
    struct ends ends = ends_choose(disc, &of_disc, &of_box);
    vector right = arc_tangent(ends.right_y, ends.right_x);
    vector left = arc_tangent(ends.left_y, ends.left_x);
    left = choose(left < right, left + FAN_TURN_RAD, left);
    double per_step = 1 / table->step_rad;
    double margin = FAN_MARGIN_RAD * per_step + FAN_MARGIN_BEAMS;
    vector first = (right - table->first_rad) * per_step - margin;
    vector last = (left - table->first_rad) * per_step + margin;
    vector beside_x = most(vabs(lx) - half[0], all(0));
    vector beside_y = most(vabs(ly) - half[1], all(0));
    mask near = beside_x * beside_x + beside_y * beside_y <= eye->range_m * eye->range_m;
    mask returns = (load_mask(solids->returns + at) & (int64_t)eye->returns) != 0;
    store(to->first + k, choose(ends.around, all(0), first));
    store(to->last + k, choose(ends.around, all(table->count), last));
    store(to->x + k, choose(disc, fx, lx));
    store(to->y + k, choose(disc, fy, ly));
    store(to->c + k, turn[0]);
    store(to->s + k, turn[1]);
    store_mask(to->seen + k, near & returns);
}

/*
 * The depth buffer of all beams, and the blocks of beams that one solid can change.  Passed by
 * value: otherwise a store to the buffer might change it.
 */
struct picture {
    const double *along_x, *along_y;
    double *range_m;
    int64_t *hit; /* may be NULL */
    size_t first, last;
    int64_t id;
};

static inline void put(struct picture p, size_t k, mask nearer, vector range)
{
    store(p.range_m + k, choose(nearer, range, load(p.range_m + k)));
    if (p.hit) {
        store_mask(p.hit + k, (nearer & p.id) | (~nearer & load_mask(p.hit + k)));
    }
}

static inline void paint_around(struct picture p)
{
    for (size_t k = p.first; k <= p.last; k += FAN_WIDTH) {
        put(p, k, load(p.range_m + k) > 0, all(0));
    }
}

static inline void paint_disc(struct picture p, double x, double y, double radius)
{
    if (x * x + y * y <= radius * radius) {
        paint_around(p);
        return;
    }
    double square = radius * radius;
    for (size_t k = p.first; k <= p.last; k += FAN_WIDTH) {
        vector dx = load(p.along_x + k);
        vector dy = load(p.along_y + k);
        vector ahead = x * dx + y * dy;
        vector beside = x * dy - y * dx;
        vector depth = square - beside * beside;
        vector range = ahead - root(most(depth, all(0)));
        range = most(range, all(0));
        mask nearer = (depth >= 0) & (ahead > 0) & (range < load(p.range_m + k));
        put(p, k, nearer, range);
    }
}

/*
 * Tests a box.  Only sides that face the scanner can be met, and they are the same for all beams:
 * one division is enough. (x, y) is the scanner in the box's frame, which is mirrored so that beams
 * that approach have positive components.
 */
static inline void paint_box(struct picture p, double x, double y, const double half[2],
                             const double turn[2])
{
    double side_x = x < 0 ? 1 : -1;
    double side_y = y < 0 ? 1 : -1;
    double way_x =
        -x * side_x - half[0]; /* distance to the line of the side that faces the scanner */
    double way_y = -y * side_y - half[1];
    if (way_x <= 0 && way_y <= 0) {
        paint_around(p);
        return;
    }
    mask faces_x = (mask){0} - (int64_t)(way_x > 0);
    mask faces_y = (mask){0} - (int64_t)(way_y > 0);
    double at_x = x * side_x;
    double at_y = y * side_y;
    double cx = turn[0] * side_x;
    double sx = turn[1] * side_x;
    double cy = turn[0] * side_y;
    double sy = turn[1] * side_y;
    double wide_x = half[0] * (1 + 1e-12); /* the corner belongs to both sides */
    double wide_y = half[1] * (1 + 1e-12);
    for (size_t k = p.first; k <= p.last; k += FAN_WIDTH) {
        vector dx = load(p.along_x + k);
        vector dy = load(p.along_y + k);
        vector ex = cx * dx + sx * dy;
        vector ey = cy * dy - sy * dx;
        mask on_x = (ex > 0) & (vabs(at_y * ex + way_x * ey) <= wide_y * ex) & faces_x;
        mask on_y = (ey > 0) & (vabs(at_x * ey + way_y * ex) <= wide_x * ey) & faces_y;
        vector way = choose(on_x, all(way_x), all(way_y));
        vector per = choose(on_x, ex, choose(on_y, ey, all(1)));
        vector range = way / per;
        mask nearer = (on_x | on_y) & (range < load(p.range_m + k));
        put(p, k, nearer, range);
    }
}

static inline void paint(struct picture p, const struct gather_solids *solids, size_t at,
                         const struct prepared *from, size_t k)
{
    p.id = solids->id[at];
    if (solids->disc[at]) {
        paint_disc(p, from->x[k], from->y[k], solids->half_x[at]);
    } else {
        double half[2] = {solids->half_x[at], solids->half_y[at]};
        double turn[2] = {from->c[k], from->s[k]};
        paint_box(p, from->x[k], from->y[k], half, turn);
    }
}

/* Tests a solid that crosses the line behind the scanner: both ends of the fan can meet it. */
static inline void paint_wrapped(struct picture p, const struct fan_table *table,
                                 const struct gather_solids *solids, size_t at,
                                 const struct prepared *from, size_t k)
{
    double turn = FAN_TURN_RAD / table->step_rad;
    double end = table->count - 1;
    for (int round = -1; round <= 1; round++) {
        double first = from->first[k] + round * turn;
        double last = from->last[k] + round * turn;
        if (last >= 0 && first <= end) {
            p.first = first > 0 ? (size_t)first & ~(size_t)(FAN_WIDTH - 1) : 0;
            p.last = (size_t)(last < end ? last : end);
            paint(p, solids, at, from, k);
        }
    }
}

static inline void paint_straight(struct picture p, const struct fan_table *table,
                                  const struct gather_solids *solids, size_t at,
                                  const struct prepared *from, size_t k)
{
    double first = from->first[k];
    double last = from->last[k];
    double end = (int32_t)table->count - 1;
    first = first > 0 ? first : 0;
    last = last < end ? last : end;
    p.first = (size_t)(int64_t)first & ~(size_t)(FAN_WIDTH - 1);
    p.last = (size_t)(int64_t)last;
    paint(p, solids, at, from, k);
}

/* The solids of a batch that beams can meet.  Those behind the scanner have a list of their own. */
struct chosen {
    uint16_t straight[FAN_BATCH], wrapped[FAN_BATCH];
    size_t straight_count, wrapped_count;
};

static inline void pick(struct chosen *some, const struct fan_table *table,
                        const struct prepared *ready, size_t count)
{
    double turn = FAN_TURN_RAD / table->step_rad;
    double end = (int32_t)table->count - 1;
    size_t straight = 0;
    size_t wrapped = 0;
    for (size_t k = 0; k < count; k++) {
        int seen = ready->seen[k] != 0;
        int ahead = (ready->last[k] >= 0) & (ready->first[k] <= end);
        int wraps = (ready->last[k] >= turn) | (ready->first[k] + turn <= end);
        some->straight[straight] = (uint16_t)k;
        some->wrapped[wrapped] = (uint16_t)k;
        straight += (size_t)(seen & ahead & ~wraps);
        wrapped += (size_t)(seen & wraps);
    }
    some->straight_count = straight;
    some->wrapped_count = wrapped;
}

static inline void sweep(const struct fan_table *table, const struct fan_eye *eye,
                         const struct gather_solids *solids, struct picture p)
{
    struct prepared ready;
    struct chosen some;
    for (size_t begin = 0; begin < solids->count; begin += FAN_BATCH) {
        size_t count = solids->count - begin < FAN_BATCH ? solids->count - begin : FAN_BATCH;
        for (size_t k = 0; k < count; k += FAN_WIDTH) {
            prepare_one(table, eye, solids, begin + k, &ready, k);
        }
        pick(&some, table, &ready, count);
        for (size_t n = 0; n < some.straight_count; n++) {
            size_t k = some.straight[n];
            paint_straight(p, table, solids, begin + k, &ready, k);
        }
        for (size_t n = 0; n < some.wrapped_count; n++) {
            size_t k = some.wrapped[n];
            paint_wrapped(p, table, solids, begin + k, &ready, k);
        }
    }
}

static void FAN_SWEEP(const struct fan_table *table, const struct fan_eye *eye,
                      const struct gather_solids *solids, double *range_m, int64_t *hit)
{
    for (size_t k = 0; k < table->count; k += FAN_WIDTH) {
        store(range_m + k, all(eye->range_m));
    }
    struct picture p = {.along_x = table->along_x, .along_y = table->along_y, .range_m = range_m};
    if (!hit) {
        sweep(table, eye, solids, p);
        return;
    }
    for (size_t k = 0; k < table->count; k += FAN_WIDTH) {
        store_mask(hit + k, (mask){0} + FAN_NOTHING);
    }
    p.hit = hit;
    sweep(table, eye, solids, p);
}

static size_t FAN_NEAR(const struct gather_solids *solids, size_t begin, size_t end,
                       const struct gather_circle *circle, uint32_t *found)
{
    size_t count = 0;
    for (size_t at = begin; at < end; at += FAN_WIDTH) {
        vector gx = load(solids->x + at) - circle->x;
        vector gy = load(solids->y + at) - circle->y;
        vector c = load(solids->c + at);
        vector s = load(solids->s + at);
        vector bx = most(vabs(c * gx + s * gy) - load(solids->half_x + at), all(0));
        vector by = most(vabs(c * gy - s * gx) - load(solids->half_y + at), all(0));
        mask near = bx * bx + by * by <= circle->reach_m * circle->reach_m;
        size_t lanes = end - at < FAN_WIDTH ? end - at : FAN_WIDTH;
        for (size_t k = 0; k < lanes; k++) {
            found[count] = (uint32_t)(at + k);
            count += near[k] & 1;
        }
    }
    return count;
}

/* As many rays as a vector holds. */
struct rays {
    vector from_x, from_y, along_x, along_y, best;
};

/* The same steps as solid_ray_disc. */
static inline vector cast_disc(const struct rays *r, vector fx, vector fy, double radius)
{
    vector b = fx * r->along_x + fy * r->along_y;
    vector beside = fx * r->along_y - fy * r->along_x;
    vector c = fx * fx + fy * fy - radius * radius;
    vector d = radius * radius - beside * beside;
    mask misses = ((c > 0) & (b > 0)) | (d < 0);
    vector t = -b - root(most(d, all(0)));
    t = choose(t < 0, all(0), t);
    return choose(~misses & (t < r->best), t, r->best);
}

/* The same steps as solid_ray_box. */
static inline vector cast_box(const struct rays *r, vector fx, vector fy, const double turn[2],
                              const double half[2])
{
    vector lx = turn[0] * fx + turn[1] * fy;
    vector ly = turn[0] * fy - turn[1] * fx;
    vector per_x = 1.0 / (turn[0] * r->along_x + turn[1] * r->along_y);
    vector per_y = 1.0 / (turn[0] * r->along_y - turn[1] * r->along_x);
    vector x0 = (-half[0] - lx) * per_x;
    vector x1 = (half[0] - lx) * per_x;
    vector y0 = (-half[1] - ly) * per_y;
    vector y1 = (half[1] - ly) * per_y;
    vector t_in = most(least(x0, x1), least(y0, y1));
    vector t_out = least(most(x0, x1), most(y0, y1));
    t_in = choose(t_in < 0, all(0), t_in);
    return choose(t_in <= least(t_out, r->best), t_in, r->best);
}

/* @return whether a ray passes through the circle around a solid before it meets another solid */
static inline bool some_may_meet(const struct rays *r, vector fx, vector fy, double reach)
{
    vector back = fx * r->along_x + fy * r->along_y;
    vector beside = fx * r->along_y - fy * r->along_x;
    return any_within(most(most(vabs(beside), back), -back - r->best), reach);
}

static void FAN_CAST(const struct fan_rays *rays, const struct gather_solids *solids,
                     const uint32_t *some, size_t count)
{
    for (size_t n = 0; n < count; n++) {
        size_t at = some[n];
        if (!(solids->returns[at] & rays->returns)) {
            continue;
        }
        double half[2] = {solids->half_x[at], solids->half_y[at]};
        double turn[2] = {solids->c[at], solids->s[at]};
        double reach = solids->reach[at] * (1 + 1e-9) + 1e-9; /* rounding must leave no gap */
        for (size_t k = 0; k < rays->count; k += FAN_WIDTH) {
            struct rays r = {load(rays->from_x + k), load(rays->from_y + k),
                             load(rays->along_x + k), load(rays->along_y + k),
                             load(rays->range_m + k)};
            vector fx = r.from_x - solids->x[at];
            vector fy = r.from_y - solids->y[at];
            if (some_may_meet(&r, fx, fy, reach)) {
                store(rays->range_m + k, solids->disc[at] ? cast_disc(&r, fx, fy, half[0])
                                                          : cast_box(&r, fx, fy, turn, half));
            }
        }
    }
}

const struct fan_kernel FAN_KERNEL = {
    .name = FAN_NAME,
    .crowd = 64 + 48 * FAN_WIDTH, /* measured: break-even at about 180, 400 and 450 */
    .near = FAN_NEAR,
    .sweep = FAN_SWEEP,
    .cast = FAN_CAST};
