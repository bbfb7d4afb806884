/* SPDX-License-Identifier: Apache-2.0 */
/*
 * (gohome) from random places: a mind with the shared library drives a body of the simulator's
 * engine, without processes and network.
 *   gohome RUNS WORLD [X Y]
 * prints how that went; without a place (metres) each run goes to a random one, which may be in a
 * wall.  Ends with 1 when fewer than 95 % of the runs to which a way leads come within 0.3 m of its
 * end, when a robot without a way does not say so and stand, when a rule errs, or when the body was
 * ever in something that stands.
 */
#include "core/random.h"
#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/memory.h"
#include "planner/planner.h"
#include "sim/engine/engine.h"
#include "world/world_load.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS_MAX = 600, STEPS_A_SECOND = 10, FREE_TRIES = 100000, SIDE_POINTS = 9 };

static const double near_m = 0.3, share_wanted = 0.95;
static const double start_room_m = 0.45; /* round a place to start from */
static const double beside_m = 0.06;     /* as src/agent/robot.c has it */
static const double dent_m = 0.03;       /* bodies may press into each other by so much */

struct trial {
    struct world world;
    struct distance_map map;
    struct engine *engine;
    struct mind *mind;
    double home_m[2], end_m[2]; /* what it is told; how near to that there is room */
    bool random, leads;         /* to random places; a way leads there */
    uint32_t *wanted;
    double way_m, stalled_s, seconds;
    unsigned arrived, inside, led, refused, errors;
    bool said; /* that there is no way */
};

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

static void complain(void *self, const char *text)
{
    struct trial *t = self;
    bool no_way = strncmp(text, "there is no way to ", 19) == 0;
    t->said |= no_way;
    t->errors += strstr(text, "[") != NULL;
    fputs(text, stderr);
}

static void fail(const struct mu_fault *fault)
{
    mu_fault_print(fault);
    exit(EXIT_FAILURE);
}

static void trial_open(struct trial *t, const char *path)
{
    struct mu_fault fault;
    if (world_load(&t->world, path, true, &fault) != MU_OK) {
        fail(&fault);
    }
    struct engine_options options = {.seed = 1, .step_ns = MU_STEP_NS};
    t->engine = engine_open(&t->world, &options);
    t->wanted = mu_startup_array(t->world.robot_count, sizeof *t->wanted);
    t->wanted[0] = MU_SENSE_SONAR;
    distance_map_make(&t->map, &t->world);
    struct mind_options mind = {.read = mu_text_file_read,
                                .name = "red",
                                .seed = 1,
                                .rules_folder = "rules",
                                .planner = planner_make(&t->map),
                                .half_m = t->world.robots[0].width_m / 2 + beside_m,
                                .ports = {.self = t, .send = post, .print = complain}};
    if (mind_open(&t->mind, &mind, &fault) != MU_OK ||
        mind_load(t->mind, "rules/follower.clp", &fault) != MU_OK) {
        fail(&fault);
    }
}

static bool is_in(const struct world_shape *shape, double x_m, double y_m)
{
    struct world_shape core = *shape;
    core.half_x_m -= dent_m;
    core.half_y_m -= dent_m;
    core.radius_m -= dent_m;
    bool thin = shape->kind == WORLD_BOX && (core.half_x_m <= 0 || core.half_y_m <= 0);
    return !thin && (core.look.stops || core.look.echoes) &&
           distance_to_shape(&core, x_m, y_m) <= 0;
}

/* @return whether a point of the outline is in something that stands */
static bool is_inside(const struct trial *t, struct world_pose at)
{
    const struct world_robot *r = &t->world.robots[0];
    int cell = distance_map_cell(&t->map, at.x_m, at.y_m);
    if (cell >= 0 && t->map.room_m[cell] > 0.5F) {
        return false;
    }
    for (int k = 0; k < SIDE_POINTS * SIDE_POINTS; k++) {
        double along =
            r->origin_x_m + r->length_m * ((k % SIDE_POINTS) / (SIDE_POINTS - 1.0) - 0.5);
        double across =
            r->origin_y_m + r->width_m * ((k / SIDE_POINTS) / (SIDE_POINTS - 1.0) - 0.5);
        double x_m = at.x_m + along * cos(at.heading_rad) - across * sin(at.heading_rad);
        double y_m = at.y_m + along * sin(at.heading_rad) + across * cos(at.heading_rad);
        for (size_t i = 0; i < t->world.shape_count; i++) {
            if (is_in(&t->world.shapes[i], x_m, y_m)) {
                return true;
            }
        }
    }
    return false;
}

/* Anywhere, the walls and what is in them as well. */
static void trial_goal(struct trial *t, struct mu_random *random)
{
    for (int i = 0; i < 2; i++) {
        double size_m = (i == 0 ? t->map.nx : t->map.ny) * t->map.cell_m;
        double share = (double)mu_random_between(random, 0, 1000000) / 1e6;
        t->home_m[i] = round(((i == 0 ? t->map.x0_m : t->map.y0_m) + share * size_m) * 1000) / 1000;
    }
}

/* Puts the robot at a random place from which there is a way home, or anywhere when none leads to
 * it. */
static void trial_place(struct trial *t, struct planner *planner, struct mu_random *random)
{
    static struct path path;
    engine_reset_all(t->engine); /* with a full battery */
    for (int i = 0; i < FREE_TRIES; i++) {
        int cell = (int)mu_random_between(random, 0, (int64_t)t->map.nx * t->map.ny - 1);
        double at_m[2];
        const char *reason;
        distance_map_middle(&t->map, cell, at_m);
        struct world_pose pose = {at_m[0], at_m[1],
                                  (double)mu_random_between(random, 0, 359) * M_PI / 180};
        if ((double)t->map.room_m[cell] >= start_room_m &&
            ((t->leads =
                  planner_search(planner, at_m, t->home_m,
                                 t->world.robots[0].width_m / 2 + beside_m, &path) == MU_OK) ||
             t->random) &&
            engine_place(t->engine, 0, pose, &reason) == MU_OK) {
            memcpy(t->end_m, t->leads ? path.points_m[path.count - 1] : t->home_m, sizeof t->end_m);
            return;
        }
    }
    fprintf(stderr, "gohome: %s: no free place\n", t->world.file);
    exit(EXIT_FAILURE);
}

/* What it feels, and where it truly is. */
static struct mu_percept percept_of(const struct engine_sample *sample, uint64_t time_ns)
{
    struct mu_percept p = engine_truth(sample);
    p.time_ns = time_ns;
    p.sonar_m = sample->percept.sonar_m;
    p.sonar_count = sample->percept.sonar_count;
    return p;
}

static double trial_far(const struct trial *t)
{
    struct world_pose at = engine_pose(t->engine, 0);
    return hypot(at.x_m - t->end_m[0], at.y_m - t->end_m[1]);
}

/* One control step.  @return whether it wants to stand still */
static bool trial_step(struct trial *t, uint64_t time_ns)
{
    const struct engine_sample *p = engine_sense_all(t->engine, t->wanted);
    struct mu_percept percept = percept_of(&p[0], time_ns);
    struct mind_act act;
    mind_percept(t->mind, &percept);
    mind_fire(t->mind, &act);
    double forward_m_s = act.drives ? act.forward_m_s : 0;
    double turn_rad_s = act.drives ? act.turn_rad_s : 0;
    bool stays = act.drives && forward_m_s == 0 && turn_rad_s == 0;
    MU_ASSERT(engine_command(t->engine, 0, &forward_m_s, &turn_rad_s) == MU_OK);
    struct world_pose before = engine_pose(t->engine, 0);
    engine_step(t->engine);
    struct world_pose after = engine_pose(t->engine, 0);
    t->way_m += hypot(after.x_m - before.x_m, after.y_m - before.y_m);
    t->stalled_s += p[0].percept.stalled ? 1.0 / STEPS_A_SECOND : 0;
    t->seconds += 1.0 / STEPS_A_SECOND;
    t->inside += is_inside(t, after);
    return stays;
}

static void trial_run(struct trial *t, uint64_t *time_ns)
{
    char line[128];
    char answer[256];
    struct mu_text out;
    mu_text_init(&out, answer, sizeof answer);
    snprintf(line, sizeof line, "(gohome %.0f %.0f)", 1000 * t->home_m[0], 1000 * t->home_m[1]);
    MU_ASSERT(mind_line(t->mind, line, &out) == MU_OK);
    struct world_pose start = engine_pose(t->engine, 0);
    bool stays = false;
    t->said = false;
    for (int i = 0; i < SECONDS_MAX * STEPS_A_SECOND &&
                    !(stays && (t->leads ? trial_far(t) < near_m : t->said));
         i++) {
        stays = trial_step(t, *time_ns += MU_STEP_NS);
    }
    bool arrived = t->leads && trial_far(t) < near_m && stays;
    t->arrived += arrived;
    t->led += t->leads;
    t->refused += !t->leads && t->said && stays;
    if (t->leads && !arrived) {
        struct world_pose at = engine_pose(t->engine, 0);
        printf("  from %.2f %.2f to %.2f %.2f it came to %.2f %.2f\n", start.x_m, start.y_m,
               t->home_m[0], t->home_m[1], at.x_m, at.y_m);
    }
}

/* @return whether the world's runs are as good as they must be */
static bool trial_all(struct trial *t, const char *path, unsigned runs)
{
    struct mu_random random;
    uint64_t time_ns = 0;
    mu_random_seed(&random, 7, path);
    trial_open(t, path);
    struct planner *planner = planner_make(&t->map);
    for (unsigned i = 0; i < runs; i++) {
        if (t->random) {
            trial_goal(t, &random);
        }
        trial_place(t, planner, &random);
        trial_run(t, &time_ns);
    }
    printf("%-28s %3u of %3u arrive, %6.1f m and %6.1f s each, stalled %4.1f %%, %u steps inside "
           "of something; %u of %u say that there is no way; %u errors\n",
           path, t->arrived, t->led, t->way_m / runs, t->seconds / runs,
           100 * t->stalled_s / t->seconds, t->inside, t->refused, runs - t->led, t->errors);
    return t->arrived >= share_wanted * t->led && t->refused == runs - t->led && t->errors == 0 &&
           t->inside == 0;
}

int main(int argc, char **argv)
{
    unsigned runs = argc == 5 || argc == 3 ? (unsigned)strtoul(argv[1], NULL, 10) : 0;
    if (runs < 1) {
        fprintf(stderr, "usage: gohome RUNS WORLD [X Y]\n");
        return 2;
    }
    static struct trial trial;
    trial.random = argc == 3;
    trial.home_m[0] = trial.random ? 0 : strtod(argv[3], NULL);
    trial.home_m[1] = trial.random ? 0 : strtod(argv[4], NULL);
    return !trial_all(&trial, argv[2], runs);
}
